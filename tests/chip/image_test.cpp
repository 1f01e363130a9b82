// Images: ELF, UF2 and plain binaries, whole and damaged.
#include "sim/chip/image/image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/chip/chip.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::image_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& file, std::size_t at, std::uint32_t value, int bytes = 4) {
  if (file.size() < at + static_cast<std::size_t>(bytes))
    file.resize(at + static_cast<std::size_t>(bytes));
  for (int i = 0; i < bytes; ++i)
    file[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> 8 * i);
}

/// An ELF file with two parts to load and three symbols, written field by field.
Bytes elf_file() {
  Bytes file(52, 0);
  put(file, 0, 0x464c'457f);
  put(file, 4, 0x0001'0101);
  put(file, 16, 2, 2);   // executable
  put(file, 18, 40, 2);  // Arm
  put(file, 20, 1);
  put(file, 24, 0x1000'0101);  // entry
  put(file, 28, 52);           // program headers
  put(file, 32, 400);          // section headers
  put(file, 40, 52, 2);
  put(file, 42, 32, 2);
  put(file, 44, 3, 2);
  put(file, 46, 40, 2);
  put(file, 48, 3, 2);
  struct Header {
    std::uint32_t type, offset, address, physical, size;
  };
  const std::vector<Header> headers = {{1, 160, 0x1000'0000, 0x1000'0000, 16},
                                       {1, 176, 0x2000'0000, 0x1000'0100, 8},
                                       {1, 0, 0x2000'1000, 0x2000'1000, 0}};
  for (std::size_t i = 0; i < headers.size(); ++i) {
    const std::size_t at = 52 + 32 * i;
    put(file, at, headers[i].type);
    put(file, at + 4, headers[i].offset);
    put(file, at + 8, headers[i].address);
    put(file, at + 12, headers[i].physical);
    put(file, at + 16, headers[i].size);
    put(file, at + 20, headers[i].size);
  }
  for (std::uint32_t i = 0; i < 24; ++i) put(file, 160 + i, i + 1, 1);
  const std::string names("\0_Z4mainv\0$t\0table\0i\0\0", 22);
  file.resize(200);
  file.insert(file.end(), names.begin(), names.end());
  const auto symbol = [&](std::size_t at, std::uint32_t name, std::uint32_t value,
                          std::uint32_t size, std::uint32_t info) {
    put(file, at, name);
    put(file, at + 4, value);
    put(file, at + 8, size);
    put(file, at + 12, info, 1);
    put(file, at + 14, 1, 2);
  };
  file.resize(400);
  symbol(240 + 16, 1, 0x2000'0001, 6, 0x12);
  symbol(240 + 32, 10, 0x2000'0000, 0, 0x00);
  symbol(240 + 48, 13, 0x2000'0100, 64, 0x11);
  symbol(240 + 64, 19, 0x2000'0009, 2, 0x02);
  const auto section = [&](std::size_t index, std::uint32_t type, std::uint32_t offset,
                           std::uint32_t size, std::uint32_t link) {
    const std::size_t at = 400 + 40 * index;
    put(file, at + 4, type);
    put(file, at + 16, offset);
    put(file, at + 20, size);
    put(file, at + 24, link);
    put(file, at + 36, 0);
  };
  section(0, 0, 0, 0, 0);
  section(1, 2, 240, 80, 2);
  section(2, 3, 200, 22, 0);
  return file;
}

Bytes uf2_file(std::uint32_t blocks, std::uint32_t family = 0xe48b'ff56,
               std::uint32_t base = 0x1000'0000) {
  Bytes file(std::size_t{512} * blocks, 0);
  for (std::uint32_t i = 0; i < blocks; ++i) {
    const std::size_t at = std::size_t{512} * i;
    put(file, at, 0x0a32'4655);
    put(file, at + 4, 0x9e5d'5157);
    put(file, at + 8, 0x2000);
    put(file, at + 12, base + 256 * i);
    put(file, at + 16, 256);
    put(file, at + 20, i);
    put(file, at + 24, blocks);
    put(file, at + 28, family);
    for (std::uint32_t k = 0; k < 256; ++k) put(file, at + 32 + k, i + k, 1);
    put(file, at + 508, 0x0ab1'6f30);
  }
  return file;
}

std::string failure(const std::function<void()>& what) {
  try {
    what();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Elf, IsLoadedByPhysicalAddressWithItsSymbols) {
  const Image image = parse_elf(elf_file(), "a.elf");
  ASSERT_EQ(image.parts.size(), 2u);
  EXPECT_EQ(image.parts[0].address, 0x1000'0000u);
  EXPECT_EQ(image.parts[0].bytes.size(), 16u);
  EXPECT_EQ(image.parts[1].address, 0x1000'0100u);
  EXPECT_EQ(image.parts[1].bytes, (Bytes{17, 18, 19, 20, 21, 22, 23, 24}));
  EXPECT_EQ(image.size(), 24u);
  ASSERT_EQ(image.symbols.size(), 3u) << "without the mapping symbol";
  const ImageSymbol* const function = image.find("main()");
  ASSERT_NE(function, nullptr);
  EXPECT_EQ(function->address, 0x2000'0000u);
  EXPECT_EQ(function->size, 6u);
  EXPECT_TRUE(function->function);
  ASSERT_NE(image.find("table"), nullptr);
  EXPECT_FALSE(image.find("table")->function);
  ASSERT_NE(image.find("i"), nullptr) << "a C name is not demangled";
  EXPECT_EQ(image.find("nothing"), nullptr);
}

TEST(Elf, ReportsErrors) {
  const auto with = [](std::size_t at, std::uint32_t value, int bytes = 4) {
    Bytes file = elf_file();
    put(file, at, value, bytes);
    return failure([&] { parse_elf(file, "a.elf"); });
  };
  EXPECT_NE(with(18, 62, 2).find("not a 32-bit little-endian Arm program"), std::string::npos);
  EXPECT_NE(with(28, 0xffff'fff0).find("program headers"), std::string::npos);
  EXPECT_NE(with(52 + 4, 0xffff'ffff).find("outside the file"), std::string::npos);
  EXPECT_NE(with(52 + 12, 0x0800'0000).find("neither in flash nor in SRAM"), std::string::npos);
  EXPECT_NE(with(52 + 12, 0x1000'00f8).find("overlap"), std::string::npos);
  EXPECT_NE(with(32, 0xffff'fff0).find("section headers"), std::string::npos);
  EXPECT_NE(with(440 + 24, 9).find("symbol table"), std::string::npos);
  EXPECT_NE(with(480 + 20, 0x7fff'ffff).find("names"), std::string::npos);
  const std::string text = with(44, 0, 2);
  EXPECT_EQ(text, "a.elf: contains nothing to load; give an ELF file built for the RP2040");
}

TEST(Uf2, IsReadInAnyOrder) {
  Bytes file = uf2_file(5);
  std::swap_ranges(file.begin(), file.begin() + 512, file.begin() + 1024);
  const Image image = parse_uf2(file, "a.uf2");
  ASSERT_EQ(image.parts.size(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(image.parts[i].address, 0x1000'0000u + 256 * i);
    EXPECT_EQ(image.parts[i].bytes[3], i + 3);
  }
  // Blocks for another chip are ignored, as in the ROM.
  Bytes both = uf2_file(1, 0xe48b'ff57);
  const Bytes ours = uf2_file(2);
  both.insert(both.end(), ours.begin(), ours.end());
  EXPECT_EQ(parse_uf2(both, "a.uf2").parts.size(), 2u);
}

TEST(Uf2, ReportsErrors) {
  const auto with = [](std::size_t at, std::uint32_t value) {
    Bytes file = uf2_file(4);
    put(file, at, value);
    return failure([&] { parse_uf2(file, "a.uf2"); });
  };
  EXPECT_NE(with(512 + 508, 0).find("a.uf2: block 1: has no UF2 magic"), std::string::npos);
  EXPECT_NE(with(512 + 16, 300).find("does not hold 256 bytes"), std::string::npos);
  EXPECT_NE(with(512 + 12, 0x1000'0080).find("does not hold 256 bytes"), std::string::npos);
  EXPECT_NE(with(512 + 12, 0x3000'0000).find("does not hold 256 bytes"), std::string::npos);
  EXPECT_NE(with(512 + 12, 0x1000'0000).find("overlap"), std::string::npos);
  EXPECT_NE(with(512 + 20, 0).find("sequence"), std::string::npos);
  EXPECT_NE(with(512 + 24, 7).find("sequence"), std::string::npos);
  EXPECT_NE(with(24, 0xffff'ffff).find("announced"), std::string::npos);
  EXPECT_NE(with(512 + 28, 1).find("1 blocks are missing"), std::string::npos);
  EXPECT_NE(failure([] { parse_uf2(uf2_file(2, 0x1234), "a"); }).find("for the RP2040"),
            std::string::npos);
  Bytes cut = uf2_file(2);
  cut.pop_back();
  EXPECT_NE(failure([&] { parse_uf2(cut, "a"); }).find("whole number"), std::string::npos);
  cut.resize(512);
  EXPECT_NE(failure([&] { parse_uf2(cut, "a"); }).find("announced"), std::string::npos);
}

TEST(Images, DamageNeverCrashes) {
  std::mt19937_64 random(21);
  const Bytes elf = elf_file(), uf2 = uf2_file(6);
  int refused = 0;
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const bool is_elf = random() % 2 == 0;
    Bytes file = is_elf ? elf : uf2;
    const std::uint64_t flips = 1 + random() % 8;
    for (std::uint64_t k = 0; k < flips; ++k) {
      // Half of the changes hit the headers.
      const std::size_t at = random() % (random() % 2 == 0 ? std::size_t{160} : file.size());
      if (random() % 4 == 0)
        file[at] = static_cast<std::uint8_t>(random());
      else
        file[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
    }
    if (random() % 8 == 0) file.resize(random() % (file.size() + 1));
    try {
      const Image image = is_elf ? parse_elf(file, "x") : parse_uf2(file, "x");
      for (const ImagePart& part : image.parts) ASSERT_FALSE(part.bytes.empty());
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      ASSERT_NE(text.find("x: "), std::string::npos);
      ASSERT_NE(text.find("; "), std::string::npos) << text;
      ++refused;
    }
  }
  EXPECT_GT(refused, test::scaled(20'000) / 10);
}

TEST(Images, AreDetectedAndPlaced) {
  const std::string folder = testing::TempDir();
  const auto file = [&](const std::string& name, const Bytes& bytes) {
    std::ofstream stream(folder + name, std::ios::binary);
    for (const std::uint8_t byte : bytes) stream.put(static_cast<char>(byte));
    return folder + name;
  };
  Chip chip;
  const std::span<std::uint8_t> flash = chip.flash().storage();
  chip.load(load_image(file("image_test.1", elf_file())), "x");
  EXPECT_EQ(flash[0x107], 24);
  chip.load(load_image(file("image_test.2", uf2_file(3, 0xe48b'ff56, 0x2000'1000))), "x");
  EXPECT_EQ(chip.bus().sram()[0x1000 + 513], 3);
  chip.load(load_image(file("image_test.bin", {9, 8, 7})), "x");
  EXPECT_EQ(flash[2], 7);
  EXPECT_NE(failure([&] {
              load_image(file("image_test.3", {1, 2, 3, 4}));
            }).find("neither"),
            std::string::npos);
  EXPECT_NE(failure([&] { load_image(folder + "image_test.none"); }).find("cannot be opened"),
            std::string::npos);
  EXPECT_NE(failure([&] { load_image(folder); }).find(": cannot be read; "), std::string::npos);
  EXPECT_NE(failure([&] { load_image(file("empty.bin", {})); }).find("0 bytes"), std::string::npos);
  const Image high = parse_uf2(uf2_file(1, 0xe48b'ff56, 0x10ff'ff00), "x");
  EXPECT_NE(failure([&] { chip.load(high, "x"); }).find("do not fit"), std::string::npos);
  for (const char* name :
       {"image_test.1", "image_test.2", "image_test.bin", "image_test.3", "empty.bin"})
    std::filesystem::remove(folder + name);
}

}  // namespace
}  // namespace lamplock::sim::chip::image_test
