// UF2 files: valid ones are read; all others are refused with the number of the wrong block.
#include "host/flash/uf2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "host/bytes.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "tests/error_of.hpp"
#include "tests/flash/images.hpp"
#include "tests/paths.hpp"
#include "tests/scale.hpp"

namespace lamplock::flash {
namespace {

constexpr std::size_t block = uf2_block_size;

/// A file of three sectors, 48 blocks.
std::string file_of_three() { return write_uf2(test::noise_image(3 * sector_size, 5)); }

void put(std::string& file, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) file[at + i] = static_cast<char>(value >> 8 * i & 0xff);
}

TEST(Uf2, FieldsOfABlockAreThoseOfTheSpecification) {
  const std::string file = file_of_three();
  ASSERT_EQ(file.size(), 48 * block);
  // Microsoft, UF2: block format; RP2040 datasheet, 2.8.4.2.
  const std::vector<std::uint32_t> wanted = {0x0a324655, 0x9e5d5157, 0x2000, 0x10000100,
                                             256,        1,          48,     0xe48bff56};
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_EQ(load<std::uint32_t>(file.data() + block + 4 * i), wanted[i]) << i;
  EXPECT_EQ(load<std::uint32_t>(file.data() + block + 508), 0x0ab16f30u);
  EXPECT_EQ(file.substr(block + 32 + 256, 476 - 256), std::string(476 - 256, '\0'));
}

TEST(Uf2, WritingAndReadingGivesTheSameImage) {
  std::mt19937_64 random(3);
  for (int i = 0; i < lamplock::test::scaled(20); ++i) {
    const FlashImage image = test::noise_image(random() % 20'000, random());
    const FlashImage back = make_flash_image(read_uf2(write_uf2(image), "file"), "file");
    ASSERT_EQ(back.sectors.size(), image.sectors.size());
    for (std::size_t k = 0; k < image.sectors.size(); ++k) {
      EXPECT_EQ(back.sectors[k].address, image.sectors[k].address);
      EXPECT_EQ(back.sectors[k].bytes, image.sectors[k].bytes);
    }
  }
}

TEST(Uf2, BlocksMayComeInAnyOrder) {
  const std::string file = file_of_three();
  std::string turned = file.substr(block) + file.substr(0, block);
  EXPECT_EQ(make_flash_image(read_uf2(turned, "file"), "file").sectors.front().bytes,
            make_flash_image(read_uf2(file, "file"), "file").sectors.front().bytes);
}

/// A changed field of block 7, and the expected error.
struct Damage {
  const char* name;
  std::size_t at;
  std::uint32_t value;
  Uf2Fault fault;
  const char* words;
};

TEST(Uf2, EachWrongFieldIsReportedWithItsBlock) {
  const std::vector<Damage> all = {
      {"first magic", 0, 0x0a324656, Uf2Fault::magic, "no UF2 magic numbers"},
      {"second magic", 4, 0, Uf2Fault::magic, "no UF2 magic numbers"},
      {"last magic", 508, 0, Uf2Fault::magic, "no UF2 magic numbers"},
      {"not for flash", 8, 0x2001, Uf2Fault::flags, "flags 0x2001"},
      {"container", 8, 0x1000, Uf2Fault::flags, "flags 0x1000"},
      {"no family", 8, 0, Uf2Fault::family, "does not say which chip"},
      {"RP2350", 28, 0xe48bff59, Uf2Fault::family, "another chip (family 0xe48bff59)"},
      {"payload", 16, 476, Uf2Fault::payload, "holds 476 bytes"},
      {"alignment", 12, 0x10000780, Uf2Fault::alignment, "0x10000780"},
      {"SRAM", 12, 0x20000000, Uf2Fault::address, "0x20000000, which is not flash"},
      {"after flash", 12, 0x11000000, Uf2Fault::address, "not flash"},
      {"before flash", 12, 0x0fffff00, Uf2Fault::address, "not flash"},
      {"place twice", 12, 0x10000100, Uf2Fault::repeated_place, "like an earlier block"},
      {"count", 24, 47, Uf2Fault::count, "announces 47 blocks, there are 48"},
      {"number", 20, 48, Uf2Fault::number, "number 48 of 48"},
      {"number twice", 20, 3, Uf2Fault::repeated, "number 3 like an earlier block"},
  };
  for (const Damage& damage : all) {
    std::string file = file_of_three();
    put(file, 7 * block + damage.at, damage.value);
    try {
      read_uf2(file, "new.uf2");
      ADD_FAILURE() << damage.name;
    } catch (const Uf2Error& error) {
      EXPECT_EQ(error.fault(), damage.fault) << damage.name;
      EXPECT_EQ(error.block(), 7u) << damage.name;
      EXPECT_EQ(error.exit(), Exit::bad_input);
      const std::string text = error.what();
      EXPECT_TRUE(text.starts_with("error: new.uf2: block 7: ")) << text;
      EXPECT_NE(text.find(damage.words), std::string::npos) << text;
    }
  }
}

TEST(Uf2, ChecksumsAndTagsAfterThePayloadAreSkipped) {
  std::string file = file_of_three();
  for (std::size_t i = 0; i < file.size(); i += block) put(file, i + 8, 0x2000 | 0x4000 | 0x8000);
  EXPECT_EQ(read_uf2(file, "file").size(), 48u);
}

TEST(Uf2, PartsOfFilesAreRefused) {
  const std::string file = file_of_three();
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, block - 1, block + 1, 5 * block}) {
    EXPECT_THROW(read_uf2(file.substr(0, size), "file"), Uf2Error) << size;
  }
}

TEST(Uf2, AnyDamageIsRefusedOrHarmless) {
  std::mt19937_64 random(11);
  const std::string file = file_of_three();
  const auto right = read_uf2(file, "file");
  for (int i = 0; i < lamplock::test::scaled(20'000); ++i) {
    std::string changed = file;
    const std::size_t at = random() % changed.size();
    const int kind = static_cast<int>(random() % 4);
    if (kind == 0) changed[at] = static_cast<char>(random());
    if (kind == 1) changed.resize(at);
    if (kind == 2) changed.insert(at, std::string(1 + random() % 700, static_cast<char>(random())));
    if (kind == 3)
      put(changed, at / block * block + random() % 8 * 4, static_cast<std::uint32_t>(random()));
    try {
      const auto parts = read_uf2(changed, "file");
      // Accepted: the difference is only in data or in fields that are not used.
      ASSERT_EQ(parts.size(), right.size());
      for (std::size_t k = 0; k < parts.size(); ++k) {
        ASSERT_EQ(parts[k].bytes.size(), page_size);
        ASSERT_EQ(parts[k].address % page_size, 0u);
        ASSERT_GE(parts[k].address, flash_base);
      }
    } catch (const Uf2Error& error) {
      ASSERT_EQ(error.exit(), Exit::bad_input);
      ASSERT_LE(error.block(), changed.size() / block);
    }
  }
}

TEST(FlashImage, ConsistsOfWholeSectorsWithErasedGaps) {
  std::vector<std::uint8_t> boot(256, 1);
  test::stamp(boot);
  const FlashImage image = make_flash_image(
      {{flash_base + 0x3ff0, std::vector<std::uint8_t>(32, 7)}, {flash_base, boot}}, "test");
  ASSERT_EQ(image.sectors.size(), 3u);
  EXPECT_EQ(image.size, 256u + 32);
  EXPECT_EQ(image.sectors[1].address, flash_base + 0x3000);
  EXPECT_EQ(image.sectors[0].bytes[256], erased);
  EXPECT_EQ(image.sectors[1].bytes[0xfef], erased);
  EXPECT_EQ(image.sectors[1].bytes[0xff0], 7);
  EXPECT_EQ(image.sectors[2].bytes[15], 7);
  EXPECT_EQ(image.sectors[2].bytes[16], erased);
}

TEST(FlashImage, NeverOverlapsTheSettings) {
  std::vector<std::uint8_t> boot(256, 1);
  test::stamp(boot);
  const auto with = [&](std::uint32_t address, std::size_t size) {
    return make_flash_image({{flash_base, boot}, {address, std::vector<std::uint8_t>(size)}},
                            "new.uf2");
  };
  // shared/boards/pico_flash.hpp: 512 KiB.
  EXPECT_EQ(with(0x1007'ff00, 256).sectors.back().address, 0x1007'f000u);
  for (const auto& [address, size] :
       std::vector<std::pair<std::uint32_t, std::size_t>>{{0x1007'ff00, 257},
                                                          {0x1008'0000, 1},
                                                          {0x1020'0000, 1},
                                                          {0x2000'0000, 1},
                                                          {0x0fff'ff00, 512},
                                                          {0xffff'ffff, 1}}) {
    const std::string text = lamplock::test::error_of([&, a = address, s = size] { with(a, s); });
    EXPECT_NE(text.find("the settings"), std::string::npos) << text;
  }
}

TEST(FlashImage, MustBeBootable) {
  std::vector<std::uint8_t> boot(256, 1);
  test::stamp(boot);
  boot[100] ^= 1;
  EXPECT_NE(lamplock::test::error_of([&] {
              make_flash_image({{flash_base, boot}}, "x");
            }).find("wrong checksum"),
            std::string::npos);
  EXPECT_NE(lamplock::test::error_of([&] {
              make_flash_image({{flash_base + 0x1000, boot}}, "x");
            }).find("begin of the flash"),
            std::string::npos);
  EXPECT_NE(lamplock::test::error_of([&] { make_flash_image({}, "x"); }).find("begin of the flash"),
            std::string::npos);
  boot[100] ^= 1;
  EXPECT_NE(lamplock::test::error_of([&] {
              make_flash_image({{flash_base, boot}, {flash_base + 255, {1}}}, "x");
            }).find("overlap"),
            std::string::npos);
}

Part part_of(std::vector<std::uint8_t> bytes) { return {flash_base, std::move(bytes)}; }

TEST(FlashImage, OfLamplockIsRefusedWithAnyByteChanged) {
  std::mt19937_64 random(17);
  for (const std::size_t size : {264u, 1'000u, 4'096u, 5'000u, 8'192u}) {
    const std::vector<std::uint8_t> good = test::lamplock_bytes(size, size);
    EXPECT_NO_THROW(make_flash_image({part_of(good)}, "file")) << size;
    // Every byte, under the sanitizers every tenth.
    const auto stride = static_cast<std::size_t>(std::max(1, 10 / lamplock::test::scaled(10)));
    for (std::size_t at = 0; at < size; at += stride) {
      std::vector<std::uint8_t> bad = good;
      bad[at] ^= static_cast<std::uint8_t>(1 + random() % 255);
      const std::string text =
          lamplock::test::error_of([&] { make_flash_image({part_of(bad)}, "file"); });
      ASSERT_NE(text.find("wrong checksum"), std::string::npos) << size << ' ' << at << text;
    }
    // A file of whole sectors is read like one of whole pages.
    const FlashImage image = make_flash_image({part_of(good)}, "file");
    EXPECT_NO_THROW(make_flash_image(read_uf2(write_uf2(image), "file"), "file"));
    // The end is missing.
    std::vector<std::uint8_t> half(good.begin(), good.begin() + static_cast<int>(size / 2));
    half.resize(std::max<std::size_t>(half.size(), page_size));
    EXPECT_THROW(make_flash_image({part_of(half)}, "file"), Error) << size;
  }
}

TEST(FlashImage, OfLamplockMayEndWithErasedWords) {
  std::vector<std::uint8_t> bytes = test::lamplock_bytes(1'000, 4);
  // A word of data before the CRC that equals erased flash.
  std::fill_n(bytes.end() - 8, 4, erased);
  const std::uint32_t crc = wire::crc32(std::span(bytes).subspan(256, 1'000 - 260));
  for (std::size_t i = 0; i < 4; ++i) bytes[996 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  EXPECT_NO_THROW(make_flash_image({part_of(bytes)}, "file"));
  // Four bytes set the CRC register to 0, whose complement is stored: all ones.
  std::vector<std::uint8_t> ones = test::lamplock_bytes(1'004, 5);
  const std::uint32_t state = ~wire::crc32(std::span(ones).subspan(256, 1'004 - 264));
  for (std::size_t i = 0; i < 4; ++i) ones[996 + i] = static_cast<std::uint8_t>(state >> 8 * i);
  ASSERT_EQ(wire::crc32(std::span(ones).subspan(256, 1'004 - 260)), 0xffff'ffffu);
  std::fill_n(ones.end() - 4, 4, erased);
  EXPECT_NO_THROW(make_flash_image({part_of(ones)}, "file"));
}

TEST(FlashImage, OfOthersIsCheckedOnlyByItsBootCode) {
  std::vector<std::uint8_t> bytes = test::lamplock_bytes(1'000, 9);
  bytes[boards::image_mark_offset] ^= 1;
  test::stamp(bytes);
  bytes[600] ^= 1;
  EXPECT_NO_THROW(make_flash_image({part_of(bytes)}, "file"));
}

#ifdef LAMPLOCK_HAS_FIRMWARE
TEST(Uf2, TheFirmwareOfThisBuildIsRefusedWithAnyPayloadDamaged) {
  const std::string good = read_file(lamplock::test::in_build("lamplock-rp2040.uf2"));
  EXPECT_NO_THROW(make_flash_image(read_uf2(good, "file"), "file"));
  std::mt19937_64 random(23);
  for (int i = 0; i < lamplock::test::scaled(50); ++i) {
    std::string bad = good;
    const std::size_t at = random() % (good.size() / block) * block + 32 + random() % 256;
    bad[at] = static_cast<char>(bad[at] ^ 1 << random() % 8);
    EXPECT_THROW(make_flash_image(read_uf2(bad, "file"), "file"), Error) << at;
  }
}
#endif

}  // namespace
}  // namespace lamplock::flash
