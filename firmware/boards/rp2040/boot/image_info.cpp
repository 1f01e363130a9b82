// What tools can read from an image without running it: its name and its board, as binary info of
// the Raspberry Pi Pico SDK (`picotool info`).
//
// In:  the row of the board. Out: a header between two marks within the first 256 words after the
//      second-stage boot code, the addresses of the entries, the entries, their texts; all in the
//      loader's part of the flash. Who: `lamplock flash`, which refuses an image for another board
//      than the one that runs; picotool.
//
// Format and identifiers: Pico SDK, pico_binary_info, binary_info/defs.h and structure.h.
#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/boards/this_board.hpp"
#include "shared/wire/binary_info.hpp"

namespace lamplock::rp2040 {
namespace {

namespace info = wire::binary_info;

template <std::size_t size>
consteval std::array<char, size + 1> terminated(std::string_view text) {
  std::array<char, size + 1> out{};
  for (std::size_t i = 0; i < size; ++i) out[i] = text[i];
  return out;
}

struct Entry {
  std::uint16_t type, tag;
  std::uint32_t id;
  const char* text;
};
/// Ends the list of the address ranges that a loader copies: the entries are read in place.
struct CopiedRange {
  std::uint32_t from, begin, end;
};
struct Header {
  std::uint32_t mark;
  const Entry* const* begin;
  const Entry* const* end;
  const CopiedRange* copied;
  std::uint32_t end_mark;
};

constexpr std::string_view product = "lamplock";
[[gnu::section(".loader.data")]] constexpr auto program_text = terminated<product.size()>(product);
[[gnu::section(".loader.data")]] constexpr auto board_text =
    terminated<boards::this_board.name.size()>(boards::this_board.name);

[[gnu::section(".loader.data")]] constexpr Entry program{info::id_and_text, info::tag_raspberry_pi,
                                                         info::program_name, program_text.data()};
[[gnu::section(".loader.data")]] constexpr Entry board{info::id_and_text, info::tag_raspberry_pi,
                                                       info::board_name, board_text.data()};
[[gnu::section(".loader.data")]] constexpr std::array<const Entry*, 2> entries{&program, &board};
[[gnu::section(".loader.data")]] constexpr CopiedRange no_range{};

}  // namespace

extern "C" [[gnu::section(".loader.info"), gnu::used]] constexpr Header image_info{
    info::begin_mark, entries.data(), entries.data() + entries.size(), &no_range, info::end_mark};

}  // namespace lamplock::rp2040
