// The loader: the first part of the image, which runs from flash. It starts the clocks, copies code
// and data to SRAM, checks the whole image and enters it.
//
// The loader must not use anything that is not yet in SRAM: only functions and constants in the
// sections .loader*, and no memcpy that the compiler recognises in a loop (the build switches that
// off).
//
// An image with a wrong CRC is never entered: the chip becomes a USB drive for the next one, with
// every pin in its reset state, an input pulled down.
#include <array>

#include "firmware/boards/rp2040/base/rom.hpp"
#include "firmware/boards/rp2040/base/second_core.hpp"
#include "firmware/boards/rp2040/boot/clocks.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "firmware/boards/rp2040/registers/watchdog.hpp"
#include "shared/wire/crc32.hpp"

#define LAMPLOCK_LOADER [[gnu::section(".loader.text"), gnu::used]]

// From the linker script. The CRC is the last word of the image; toolchain/image writes it.
extern "C" {
extern const std::uint32_t loader_begin[];
extern const std::uint32_t image_in_flash[];
extern std::uint32_t image_begin[];
extern std::uint32_t image_crc[];
extern std::uint32_t stack_top[];

[[noreturn]] void start_image();
[[noreturn]] void load_image();
[[noreturn]] void loader_fault();
}

namespace lamplock::rp2040 {
namespace {

[[gnu::section(".loader.data")]] constexpr std::array<std::uint32_t, 16> crc_nibbles =
    wire::crc32_nibbles;

LAMPLOCK_LOADER std::uint32_t crc_words(const std::uint32_t* begin, const std::uint32_t* end,
                                        std::uint32_t crc) {
  for (const std::uint32_t* word = begin; word != end; ++word) {
    crc ^= *word;  // four bytes at once, lowest first
    for (int nibble = 0; nibble < 8; ++nibble) crc = (crc >> 4) ^ crc_nibbles[crc & 0xf];
  }
  return crc;
}

}  // namespace
}  // namespace lamplock::rp2040

LAMPLOCK_LOADER void load_image() {
  using namespace lamplock::rp2040;
  // A watchdog that still runs must not interrupt the loader; the image starts its own.
  clear_bits(watchdog_registers().ctrl, watchdog_field::enable);
  // Puts the blocks of the last program back into reset: its pins become inputs, pulled down.
  set_bits(resets().reset,
           reset_bit::all & ~(reset_bit::io_qspi | reset_bit::pads_qspi | reset_bit::pll_sys |
                              reset_bit::pll_usb | reset_bit::syscfg));
  // If only core 0 was restarted, core 1 may still run code that is about to be overwritten.
  hold_second_core();
  start_clocks();

  const std::uint32_t* from = image_in_flash;
  for (std::uint32_t* to = image_begin; to <= image_crc; ++to) *to = *from++;
  release_second_core();
  const std::uint32_t flash_crc = crc_words(loader_begin, image_in_flash, ~0u);
  if (~crc_words(image_begin, image_crc, flash_crc) != *image_crc)
    for (;;) reset_to_usb_boot();

  // By register: a branch from flash does not reach SRAM.
  void (*volatile const start)() = start_image;
  start();
  __builtin_unreachable();
}

/// Before the image has its handler there is no record to save or report.
LAMPLOCK_LOADER void loader_fault() {
  for (;;) lamplock::rp2040::reset_to_usb_boot();
}

/// The first four words of a vector table; interrupts stay masked until the image has its own.
struct LoaderVectors {
  void* stack;
  void (*reset)();
  void (*nmi)();
  void (*hard_fault)();
};
extern "C" [[gnu::section(".loader.vectors"), gnu::used]] constexpr LoaderVectors loader_vectors{
    stack_top, load_image, loader_fault, loader_fault};
