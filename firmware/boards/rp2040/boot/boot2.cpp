// Second-stage boot: makes flash readable as memory and starts the loader.
//
// The ROM copies the first 256 bytes of the flash to the top of SRAM, checks the CRC-32 in the last
// four (datasheet, 2.8.1.3.1; toolchain/image writes it) and jumps to the first. The code runs at
// an address it was not linked for: it may only branch relative to the program counter, and calls
// nothing.
#include "firmware/boards/rp2040/base/xip.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "shared/boards/pico_flash.hpp"

// From the linker script: stack pointer and entry of the loader are its first words.
extern "C" const std::uint32_t loader_begin[];

extern "C" [[gnu::section(".boot2"), gnu::used, noreturn]] void boot2() {
  using namespace lamplock::rp2040;
  start_xip();
  scb().vtor = reinterpret_cast<std::uintptr_t>(loader_begin);
  asm volatile(
      "msr msp, %0\n"
      "bx %1\n" ::"r"(loader_begin[0]),
      "r"(loader_begin[1]));
  __builtin_unreachable();
}

/// By this mark `lamplock flash` recognises an image and its CRC.
extern "C" [[gnu::section(".boot2.mark"), gnu::used]] constexpr auto boot2_mark =
    lamplock::boards::image_mark;
