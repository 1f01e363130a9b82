// The bus fabric against the RP2040 datasheet, 2.1 and 2.2.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <vector>

#include "sim/chip/fabric/bus.hpp"

namespace lamplock::test::bus_test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

/// Registers that store what is written.
class Block final : public Peripheral {
 public:
  std::string_view name() const override { return "BLOCK"; }
  std::uint32_t read(std::uint32_t offset) override {
    ++reads;
    return words[offset];
  }
  std::uint32_t peek(std::uint32_t offset) const override {
    const auto found = words.find(offset);
    return found == words.end() ? 0 : found->second;
  }
  void write(std::uint32_t offset, std::uint32_t value) override {
    words[offset] = value;
    last = value;
  }
  std::uint32_t write_clear_bits(std::uint32_t offset) const override {
    return offset == 0x40 ? 0xff : 0;
  }
  void reset() override { words.clear(); }
  std::map<std::uint32_t, std::uint32_t> words;
  std::uint32_t last = 0;
  int reads = 0;
};

class BusTest : public testing::Test {
 protected:
  std::uint32_t read(std::uint32_t address, Width width = Width::word) {
    const Access access = bus_.read(address, width, Master::core0, 0);
    EXPECT_FALSE(access.fault) << std::hex << address;
    return access.value;
  }
  bool faults(std::uint32_t address, Master master = Master::core0) {
    return bus_.read(address, Width::word, master, 0).fault;
  }
  Access write(std::uint32_t address, std::uint32_t value, Width width = Width::word) {
    return bus_.write(address, value, width, Master::core0, 0);
  }
  TimeWheel wheel_;
  Timing timing_;
  std::vector<std::string> reports_;
  Bus bus_{wheel_, timing_, [this](const std::string& what) { reports_.push_back(what); }};
};

TEST_F(BusTest, SramTakesEveryWidth) {
  for (const std::uint32_t base : {0x2000'0000u, 0x2003'fff0u, 0x2004'0000u, 0x2004'1ff8u}) {
    write(base, 0x1122'3344);
    EXPECT_EQ(read(base), 0x1122'3344u);
    write(base + 1, 0xaa, Width::byte);
    EXPECT_EQ(read(base), 0x1122'aa44u);
    write(base + 2, 0xbeef, Width::half);
    EXPECT_EQ(read(base), 0xbeef'aa44u);
    EXPECT_EQ(read(base + 3, Width::byte), 0xbeu);
    EXPECT_EQ(read(base + 2, Width::half), 0xbeefu);
  }
  EXPECT_TRUE(faults(0x2004'2000));
  EXPECT_TRUE(faults(0x2080'0000));
}

TEST_F(BusTest, SingleBanksShowEveryFourthWord) {
  for (std::uint32_t word = 0; word < 64 * 1024; word += 77) write(0x2000'0000 + 4 * word, word);
  for (std::uint32_t word = 0; word < 64 * 1024; word += 77)
    EXPECT_EQ(read(0x2100'0000 + 0x1'0000 * (word % 4) + 4 * (word / 4)), word);
  write(0x2102'0006, 0xabcd, Width::half);
  EXPECT_EQ(read(0x2000'001a, Width::half), 0xabcdu);
  EXPECT_TRUE(faults(0x2104'0000));
}

TEST_F(BusTest, RomIsReadOnly) {
  bus_.rom()[16] = 'M';
  EXPECT_EQ(read(16, Width::byte), std::uint32_t{'M'});
  write(16, 0);
  EXPECT_EQ(read(16, Width::byte), std::uint32_t{'M'});
  EXPECT_TRUE(faults(0x4000));
}

TEST_F(BusTest, WithoutFlashAReadFaultsAndIsReported) {
  EXPECT_TRUE(faults(0x1000'0000));
  EXPECT_EQ(reports_.size(), 1u);
}

TEST_F(BusTest, MemoryAnswersWhileItIsMapped) {
  std::vector<std::uint8_t> memory(16 * 1024);
  EXPECT_TRUE(faults(0x1500'1234));
  bus_.map_memory(0x1500'0000, memory, true);
  write(0x1500'1234, 0x5a);
  EXPECT_EQ(memory[0x1234], 0x5a);
  EXPECT_EQ(read(0x1500'1234), 0x5au);
  EXPECT_TRUE(faults(0x1500'4000));
  bus_.unmap_memory(0x1500'0000);
  EXPECT_TRUE(faults(0x1500'1234));
}

TEST_F(BusTest, AliasesCombineWithoutReading) {
  Block block;
  bus_.map(0x4005'4000, block);
  write(0x4005'4020, 0x0000'ff00);
  write(0x4005'5020, 0x0000'0ff0);
  EXPECT_EQ(block.words[0x20], 0x0000'f0f0u);
  write(0x4005'6020, 0xf000'0000);
  EXPECT_EQ(block.words[0x20], 0xf000'f0f0u);
  write(0x4005'7020, 0xf00f'00f0);
  EXPECT_EQ(block.words[0x20], 0x0000'f000u);
  EXPECT_EQ(block.reads, 0);
  EXPECT_EQ(read(0x4005'7020), 0x0000'f000u);
}

TEST_F(BusTest, BitsThatAWriteClearsPassAliasesAsWritten) {
  Block block;
  bus_.map(0x5011'0000, block);
  block.words[0x40] = 0xff0f;
  write(0x5011'3040, 0x0001);  // clear alias
  EXPECT_EQ(block.last, 0xff01u);
}

TEST_F(BusTest, NarrowWritesReachRegistersReplicated) {
  Block block;
  bus_.map(0x4005'8000, block);
  write(0x4005'800d, 0xa5, Width::byte);
  EXPECT_EQ(block.words[0xc], 0xa5a5'a5a5u);
  write(0x4005'800e, 0x1234, Width::half);
  EXPECT_EQ(block.words[0xc], 0x1234'1234u);
  block.words[0xc] = 0x4433'2211;
  EXPECT_EQ(read(0x4005'800e, Width::byte), 0x33u);
  EXPECT_EQ(read(0x4005'800e, Width::half), 0x4433u);
  write(0x4005'a00c, 0x80, Width::byte);  // set alias
  EXPECT_EQ(block.words[0xc], 0xc4b3'a291u);
}

TEST_F(BusTest, SioIsForCoresAndEachHasItsOwn) {
  Block first, second;
  bus_.map_sio(first, second);
  write(0xd000'0010, 7);
  bus_.write(0xd000'0010, 9, Width::word, Master::core1, 0);
  EXPECT_EQ(first.words[0x10], 7u);
  EXPECT_EQ(second.words[0x10], 9u);
  EXPECT_TRUE(faults(0xd000'0010, Master::dma));
  EXPECT_TRUE(write(0xd000'1010, 1).fault);  // no aliases
}

TEST_F(BusTest, MissingBlocksAreReportedOrFault) {
  EXPECT_EQ(read(0x4003'c00c), 0u);
  ASSERT_EQ(reports_.size(), 1u);
  EXPECT_EQ(reports_[0], "SPI0 read at 0x4003c00c");
  EXPECT_FALSE(write(0x4004'4002, 1, Width::byte).fault);
  EXPECT_EQ(reports_[1], "I2C0 written at 0x40044000");
  for (const std::uint32_t unmapped : {0x4006'8000u, 0x4007'0000u, 0x4100'0000u, 0x5005'0000u,
                                       0x5000'4000u, 0x5100'0000u, 0x3000'0000u, 0x6000'0000u})
    EXPECT_TRUE(faults(unmapped)) << std::hex << unmapped;
}

TEST_F(BusTest, TimeIsUpdatedForCoresOnly) {
  Block block;
  bus_.map(0x5000'0000, block);
  bus_.read(0x5000'0000, Width::word, Master::dma, 100);
  EXPECT_EQ(wheel_.now(), 0u);
  bus_.read(0x5000'0000, Width::word, Master::core0, 50);
  EXPECT_EQ(wheel_.now(), 50u);
}

TEST_F(BusTest, MemoryOnThePeripheralBusIsWatched) {
  std::array<std::uint8_t, 4096> dpram{};
  bus_.map_memory(0x5010'0000, dpram, true);
  std::vector<std::array<std::uint32_t, 3>> stores;
  bus_.watch_memory(0x5010'0000,
                    [&](std::uint32_t offset, std::uint32_t before, std::uint32_t after) {
                      stores.push_back({offset, before, after});
                    });
  write(0x5010'0080, 0x1111'2222);
  write(0x5010'0082, 0x3333, Width::half);
  EXPECT_EQ(read(0x5010'0080), 0x3333'2222u);
  ASSERT_EQ(stores.size(), 2u);
  EXPECT_EQ(stores[1], (std::array<std::uint32_t, 3>{0x80, 0x1111'2222, 0x3333'2222}));
  EXPECT_EQ(bus_.memory_at(0x5010'0100).size(), 4096u - 0x100);
  EXPECT_TRUE(bus_.memory_at(0x4000'0000).empty());
}

}  // namespace
}  // namespace lamplock::test::bus_test
