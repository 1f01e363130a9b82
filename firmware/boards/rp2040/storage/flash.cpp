#include "firmware/boards/rp2040/storage/flash.hpp"

#include <algorithm>

#include "firmware/boards/rp2040/base/rom.hpp"
#include "firmware/boards/rp2040/base/xip.hpp"
#include "firmware/boards/rp2040/registers/io_qspi.hpp"
#include "firmware/boards/rp2040/registers/xip.hpp"

namespace lamplock::rp2040 {
namespace {

/// Keeps the flash in its command state for the life of the object; it cannot be read meanwhile.
class CommandState {
 public:
  CommandState() {
    rom_function<void()>(rom_code('I', 'F'))();
    rom_function<void()>(rom_code('E', 'X'))();
  }
  ~CommandState() {
    rom_function<void()>(rom_code('F', 'C'))();
    start_xip();
  }
  CommandState(const CommandState&) = delete;
  CommandState& operator=(const CommandState&) = delete;
};

void chip_select(std::uint32_t level) {
  Register& ctrl = io_qspi().gpio[io_qspi_field::chip_select].ctrl;
  ctrl = (ctrl & ~io_qspi_field::output_override) | level;
}

/// Sends and receives as many bytes, at most the size of the FIFO; the SSI is in 8-bit mode, as the
/// ROM leaves it.
void exchange(std::span<std::uint8_t> bytes) {
  constexpr std::uint32_t received = 1u << 3;  // SR.RFNE
  chip_select(io_qspi_field::output_low);
  for (const std::uint8_t byte : bytes) ssi().dr0 = byte;
  for (std::uint8_t& byte : bytes) {
    while ((ssi().sr & received) == 0) {
    }
    byte = static_cast<std::uint8_t>(ssi().dr0);
  }
  chip_select(io_qspi_field::output_high);
}

}  // namespace

void FlashArea::read(std::uint32_t at, std::span<std::uint8_t> out) const {
  // Bypasses the cache: programmed data is visible at once.
  const volatile std::uint8_t* from = xip_nocache() + offset_ + at;
  for (std::uint8_t& byte : out) byte = *from++;
}

void FlashArea::erase(std::uint32_t at) {
  using RangeErase =
      void(std::uint32_t at, std::uint32_t size, std::uint32_t block, std::uint8_t block_command);
  // No larger block command: an erase is exactly one sector.
  constexpr std::uint32_t block = 1u << 16;
  constexpr std::uint8_t block_erase = 0xd8;
  const CommandState state;
  rom_function<RangeErase>(rom_code('R', 'E'))(offset_ + at, settings::flash_sector, block,
                                               block_erase);
}

void FlashArea::program(std::uint32_t at,
                        std::span<const std::uint8_t, settings::flash_page> page) {
  using RangeProgram = void(std::uint32_t at, const std::uint8_t* data, std::uint32_t size);
  const CommandState state;
  rom_function<RangeProgram>(rom_code('R', 'P'))(offset_ + at, page.data(), page.size());
}

std::array<char, 16> flash_unique_number() {
  constexpr std::size_t dummy = 4;
  std::array<std::uint8_t, 1 + dummy + 8> bytes{0x4b};
  {
    const CommandState state;
    exchange(bytes);
  }
  std::array<char, 16> text{};
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned nibble = bytes[1 + dummy + i / 2] >> (i % 2 == 0 ? 4 : 0) & 0xfu;
    text[i] = "0123456789ABCDEF"[nibble];
  }
  return text;
}

}  // namespace lamplock::rp2040
