// Identifiers of the binary info of the Raspberry Pi Pico SDK (pico_binary_info,
// binary_info/defs.h and structure.h), which tools find in the flash of an RP2040.
//
// A header, five words: mark, begin and end of a list of addresses of entries, address of a list of
// copied ranges, mark. It is within the first 256 words after the second-stage boot code. An entry
// with a text: type and tag, 16 bits each; identifier; address of the text, which ends with a zero.
//
// Who: the image, which has such an entry for its name and its board; `lamplock flash`.
#pragma once

#include <cstdint>

namespace lamplock::wire::binary_info {

inline constexpr std::uint32_t begin_mark = 0x7188ebf2, end_mark = 0xe71aa390;
inline constexpr std::uint32_t max_header_offset = 256 * 4;  ///< bytes after the boot code
inline constexpr std::uint16_t id_and_text = 6;
inline constexpr std::uint16_t tag_raspberry_pi = 'R' | 'P' << 8;
inline constexpr std::uint32_t program_name = 0x02031c86, board_name = 0xb63cffbb;

}  // namespace lamplock::wire::binary_info
