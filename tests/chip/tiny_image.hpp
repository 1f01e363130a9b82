// Programs small enough to be their own second-stage boot: 256 bytes at the start of the flash,
// which the ROM copies to SRAM and runs there, on the ring oscillator at 6.5 MHz (RP2040 datasheet,
// 2.8.1.3.1, 2.17).
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shared/boards/boot2_crc32.hpp"

namespace lamplock::test {

/// A register and its initial value.
using Store = std::pair<std::uint32_t, std::uint32_t>;

/// Address at which the ROM runs the image.
inline constexpr std::uint32_t tiny_base = 0x2004'1f00;

/// An image with the code from offset 0 on and its checksum.
inline std::vector<std::uint8_t> boot_image(const std::vector<std::uint16_t>& code) {
  std::vector<std::uint8_t> image(256, 0);
  std::memcpy(image.data(), code.data(), 2 * code.size());
  const std::uint32_t crc = boards::boot2_crc32(std::span(image).first(252));
  std::memcpy(&image[252], &crc, sizeof crc);
  return image;
}

/// Makes the stores, then runs `then`: an even number of halfwords, which begin at offset 12.
inline std::vector<std::uint8_t> tiny_image(const std::vector<std::uint16_t>& then,
                                            const std::vector<Store>& stores) {
  const auto table = 12 + 2 * then.size();
  std::vector<std::uint16_t> code{
      static_cast<std::uint16_t>(0xa400 | (table - 4) / 4),  // adr r4, table
      0xcc03,                                                // next: ldmia r4!, {r0, r1}
      0x2800,                                                // cmp r0, #0
      0xd001,                                                // beq then
      0x6001,                                                // str r1, [r0]
      0xe7fa,                                                // b next
  };
  code.insert(code.end(), then.begin(), then.end());
  for (const auto& [address, value] : stores)
    for (const std::uint32_t word : {address, value}) {
      code.push_back(static_cast<std::uint16_t>(word));
      code.push_back(static_cast<std::uint16_t>(word >> 16));
    }
  return boot_image(code);
}

/// Out of reset (2.14.3): IO_BANK0, PADS_BANK0, PWM, UART0, UART1.
inline constexpr Store leave_reset{0x4000'f000, 1u << 5 | 1u << 8 | 1u << 14 | 1u << 22 | 1u << 23};

/// gpio9 follows gpio8, polled every 5 cycles (LDR and STR to SIO 1 each, LSLS 1, B 2); gpio25 is
/// PWM with a period of 65 cycles, 10 us, high for 32 of them (4.5.2).
inline std::vector<std::uint8_t> pin_image() {
  return tiny_image(
      {
          0x200d,  // movs r0, #13
          0x0700,  // lsls r0, r0, #28: SIO
          0x6841,  // look: ldr r1, [r0, #4], GPIO_IN
          0x0049,  // lsls r1, r1, #1
          0x6101,  // str r1, [r0, #16], GPIO_OUT
          0xe7fb,  // b look
      },
      {leave_reset,
       {0x4001'4044, 5},        // gpio8: SIO
       {0x4001'404c, 5},        // gpio9: SIO
       {0x4001'40cc, 4},        // gpio25: PWM
       {0xd000'0024, 1u << 9},  // GPIO_OE_SET
       {0x4005'0060, 64},       // CH4_TOP
       {0x4005'005c, 32u << 16},
       {0x4005'0050, 1}});
}

/// UART0 or UART1 echoes its input, 10 bits of 3 x 16 cycles per byte (4.2.3.1.1).
inline std::vector<std::uint8_t> uart_image(bool second = false) {
  const std::uint16_t base_high = 0x4003, base_low = second ? 0x8000 : 0x4000;
  const std::uint32_t uart = std::uint32_t{base_high} << 16 | base_low;
  return tiny_image(
      {
          0x4803,  // ldr r0, =UART
          0x2210,  // movs r2, #16: RXFE
          0x6981,  // look: ldr r1, [r0, #24], UARTFR
          0x4211,  // tst r1, r2
          0xd1fc,  // bne look
          0x6801,  // ldr r1, [r0], UARTDR
          0x6001,  // str r1, [r0]
          0xe7f9,  // b look
          base_low,
          base_high,
      },
      {leave_reset,
       {0x4000'8048, 1u << 11},  // CLK_PERI from clk_sys
       {uart + 0x24, 3},         // IBRD
       {uart + 0x2c, 0x70},      // LCR_H: 8 bits, FIFOs
       {uart + 0x30, 0x301}});   // CR
}

/// The image as a UF2 file of one block (UF2 file format specification).
inline std::string uf2_file(const std::vector<std::uint8_t>& image) {
  std::array<std::uint32_t, 128> block{};
  block = {0x0a32'4655, 0x9e5d'5157, 0x2000, 0x1000'0000, 256, 0, 1, 0xe48b'ff56};
  block[127] = 0x0ab1'6f30;
  std::memcpy(&block[8], image.data(), image.size());
  return {reinterpret_cast<const char*>(block.data()), sizeof block};
}

/// A function of a tiny image.
struct TinySymbol {
  std::string name;
  std::uint32_t offset = 0, size = 0;
};

/// The image as an ELF file with symbols (ELF specification, figures 1-3 ff.).
inline std::string elf_file(const std::vector<std::uint8_t>& image,
                            const std::vector<TinySymbol>& symbols) {
  constexpr std::uint32_t flash = 0x1000'0000, image_at = 84;
  const auto image_size = static_cast<std::uint32_t>(image.size());
  std::string names(1, '\0');
  std::vector<std::uint32_t> table(4);
  for (const TinySymbol& symbol : symbols) {
    const std::uint32_t function_of_section_1 = 2 | 1u << 16;
    table.insert(table.end(),
                 {static_cast<std::uint32_t>(names.size()), (tiny_base + symbol.offset) | 1,
                  symbol.size, function_of_section_1});
    names += symbol.name + '\0';
  }
  names.resize((names.size() + 3) & ~std::size_t{3});
  const std::uint32_t table_at = image_at + image_size;
  const auto table_size = static_cast<std::uint32_t>(4 * table.size());
  const std::uint32_t names_at = table_at + table_size;
  const auto names_size = static_cast<std::uint32_t>(names.size());
  std::vector<std::uint32_t> head{
      0x464c'457f,    0x0001'0101,   0, 0, 2 | 40u << 16, 1, flash, 52, names_at + names_size, 0,
      52 | 32u << 16, 1 | 40u << 16, 3};
  head.insert(head.end(), {1, image_at, flash, flash, image_size, image_size, 5, 4});
  std::vector<std::uint32_t> sections(10);
  sections.insert(sections.end(), {0, 2, 0, 0, table_at, table_size, 2, 0, 4, 16});
  sections.insert(sections.end(), {0, 3, 0, 0, names_at, names_size, 0, 0, 1, 0});
  std::string file;
  const auto append = [&file](const std::vector<std::uint32_t>& words) {
    file.append(reinterpret_cast<const char*>(words.data()), 4 * words.size());
  };
  append(head);
  file.append(image.begin(), image.end());
  append(table);
  file += names;
  append(sections);
  return file;
}

}  // namespace lamplock::test
