// The board of an image, from its binary info: at any place of the header, with unusual or broken
// lists.
#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "host/flash/image_board.hpp"
#include "shared/wire/binary_info.hpp"
#include "tests/flash/images.hpp"

namespace lamplock::flash::test {
namespace {

namespace info = wire::binary_info;

/// Bytes of an image whose words and texts can be set by their address.
struct Bytes {
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(8192, 0xa5);
  void put(std::uint32_t address, std::uint32_t word) {
    for (std::uint32_t i = 0; i < 4; ++i)
      bytes.at(address - flash_base + i) = static_cast<std::uint8_t>(word >> (8 * i));
  }
  void put(std::uint32_t address, std::string_view text) {
    for (const char c : text) bytes.at(address++ - flash_base) = static_cast<std::uint8_t>(c);
    bytes.at(address - flash_base) = 0;
  }
  void put_entry(std::uint32_t address, std::uint32_t id, std::uint32_t text) {
    put(address, info::id_and_text | std::uint32_t{info::tag_raspberry_pi} << 16);
    put(address + 4, id);
    put(address + 8, text);
  }
  std::string board() {
    std::vector<std::uint8_t> stamped = bytes;
    stamp(stamped);
    return board_of_image(make_flash_image({{flash_base, std::move(stamped)}}, "test"));
  }
};

Bytes image_of(std::uint32_t header, const char* program, const char* board) {
  Bytes image;
  constexpr std::uint32_t list = flash_base + 0x1000;
  image.put(header, info::begin_mark);
  image.put(header + 4, list);
  image.put(header + 8, list + 12);
  image.put(header + 12, list + 0x10);
  image.put(header + 16, info::end_mark);
  image.put(list, list + 0x100);
  image.put(list + 4, list + 0x200);
  image.put(list + 8, list + 0x300);
  image.put_entry(list + 0x100, 0x11a9bc3a, list + 0x400);  // a version, before the others
  image.put_entry(list + 0x200, info::board_name, list + 0x500);
  image.put_entry(list + 0x300, info::program_name, list + 0x600);
  image.put(list + 0x400, "9.9");
  image.put(list + 0x500, board);
  image.put(list + 0x600, program);
  return image;
}

TEST(ImageBoard, IsThatOfTheBinaryInfo) {
  for (const std::uint32_t offset : {0x100u, 0x110u, 0x4fcu})
    EXPECT_EQ(image_of(flash_base + offset, "lamplock", "mrbeam").board(), "mrbeam") << offset;
  EXPECT_EQ(image_of(flash_base + 0x500, "lamplock", "mrbeam").board(), "") << "after its place";
  EXPECT_EQ(image_of(flash_base + 0x110, "blink", "pico").board(), "") << "another program";
  EXPECT_EQ(Bytes().board(), "");
}

TEST(ImageBoard, ABrokenListIsReadWithinTheImage) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    Bytes image = image_of(flash_base + 0x110, "lamplock", "pico");
    // The words of the header between the marks, the list, the entries, the ends of the texts.
    const std::uint32_t at = i % 3 == 0 ? 0x114 + 4 * static_cast<std::uint32_t>(random() % 2)
                                        : 0x1000 + 4 * static_cast<std::uint32_t>(random() % 0x1a0);
    const auto word = static_cast<std::uint32_t>(random());
    image.put(flash_base + at, i % 2 == 0 ? word : flash_base + word % 0x3000);
    const std::string board = image.board();
    EXPECT_TRUE(board.size() < 64) << i;
  }
  Bytes endless = image_of(flash_base + 0x110, "lamplock", "pico");
  endless.put(flash_base + 0x118, 0xfffffffcu);
  EXPECT_EQ(endless.board(), "");
}

}  // namespace
}  // namespace lamplock::flash::test
