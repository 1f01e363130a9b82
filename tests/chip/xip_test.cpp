// Flash through the cache of execution in place (RP2040 datasheet, 2.6.3): accesses of masters, and
// code that runs there.
#include "tests/chip/xip_rig.hpp"

#include <initializer_list>
#include <vector>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/fabric/irq_lines.hpp"

namespace lamplock::test::xip_test {
namespace {

TEST_F(XipTest, AMissTakesTheTransferOfALineAndAHitNothing) {
  for (const std::uint32_t divider : {2u, 4u, 6u}) {
    set_divider(divider);
    const std::uint32_t line = cached + 0x1000 * divider;
    EXPECT_EQ(wait(line), line_clocks * divider);
    EXPECT_EQ(wait(line + 4), 0u) << "lines of eight bytes";
    EXPECT_EQ(wait(line + 8), line_clocks * divider);
    EXPECT_EQ(wait(line), 0u);
  }
}

TEST_F(XipTest, UseOfTheFlashCountsVisitsAndMissesOfLines) {
  FlashUse use(flash_.storage().size());
  wait(cached + 0x100);  // before the count
  xip_.count_use(&use);
  wait(cached + 0x100);
  wait(cached + 0x104);  // the same visit
  wait(cached + 0x108, Master::core1);
  wait(cached + 0x100);  // the same visit of core 0
  wait(cached + 0x208);
  wait(cached + 0x100);
  wait(no_cache + 0x100);  // the same line of the flash
  xip_.count_use(nullptr);
  wait(cached + 0x300);
  EXPECT_EQ(use.text(),
            "# address visits misses\n"
            "0x10000100 2 1\n"
            "0x10000108 1 1\n"
            "0x10000208 1 1\n");
}

TEST_F(XipTest, NarrowReadsTakeTheirBytes) {
  wait(cached + 0x100);
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Access byte = bus_.read(cached + 0x100 + i, Width::byte, Master::core0, at_++);
    EXPECT_EQ(byte.value, flash_.storage()[0x100 + i]);
    EXPECT_EQ(byte.wait, 0u);
  }
  const Access half = bus_.read(cached + 0x106, Width::half, Master::core0, at_);
  EXPECT_EQ(half.value, flash_word(cached + 0x104) >> 16);
}

TEST_F(XipTest, AFlashIgnoresAddressBitsBeyondItsSize) {
  for (const std::uint32_t high : {0x0020'0000u, 0x0060'0000u, 0x00e0'0000u}) wait(cached + high);
}

// The fixture enters the mode by a read with the command, as the usual boot2 does.
TEST_F(XipTest, QuadContinuousReadNeedsTheFlashToBeInIt) {
  constexpr std::uint32_t continuous = 0xa0u << 24 | 8u << 2 | 4u << 11 | 2u;
  const auto readable = [&] { return !bus_.read(bypass, Width::word, Master::core0, at_).fault; };
  EXPECT_TRUE(flash_.continuous_read());
  EXPECT_TRUE(readable());
  EXPECT_EQ(xip_.ssi().line_fill_cycles(), line_clocks * 2);
  setup(2, (continuous & ~(31u << 11)) | 3u << 11);
  EXPECT_FALSE(readable()) << "one wait cycle too few";
  setup(2, continuous);
  EXPECT_TRUE(readable());
  for (int i = 0; i < 2; ++i) {  // ones end the mode
    flash_.select(0);
    flash_.transfer(0xff, 0);
    flash_.deselect(0);
  }
  ASSERT_FALSE(flash_.continuous_read());
  setup(2, continuous);
  EXPECT_FALSE(readable()) << "the flash waits for a command";
}

// 2.6.3.1: the four aliases.
TEST_F(XipTest, AliasesLookUpAndAllocateAsTheyAreNamed) {
  constexpr std::uint32_t miss = 2 * line_clocks;
  EXPECT_EQ(wait(no_allocate), miss);
  EXPECT_EQ(wait(no_allocate), miss) << "not stored in the cache";
  EXPECT_EQ(wait(cached), miss);
  EXPECT_EQ(wait(no_allocate), 0u) << "but a hit there";
  EXPECT_EQ(wait(bypass), miss);
  EXPECT_EQ(wait(no_cache), miss);
  EXPECT_EQ(wait(no_cache + 0x40), miss);
  EXPECT_EQ(wait(no_cache + 0x40), miss);
  EXPECT_EQ(wait(cached + 0x40), 0u) << "stored in the cache";
  EXPECT_EQ(wait(bypass + 0x80), miss);
  EXPECT_EQ(wait(cached + 0x80), miss);
}

TEST_F(XipTest, HoldsTwoLinesOfASetAndSixteenKilobytesInAll) {
  constexpr std::uint32_t miss = 2 * line_clocks;
  EXPECT_EQ(wait(cached), miss);
  EXPECT_EQ(wait(cached + 0x2000), miss);
  EXPECT_EQ(wait(cached), 0u);
  EXPECT_EQ(wait(cached + 0x4000), miss);
  EXPECT_EQ(wait(cached), 0u);
  EXPECT_EQ(wait(cached + 0x2000), miss);
  for (int round = 0; round < 2; ++round)
    for (std::uint32_t at = 0x8000; at < 0xc000; at += 8)
      ASSERT_EQ(wait(cached + at), round == 0 ? miss : 0);
}

TEST_F(XipTest, AWriteDropsItsLineOrIsRefused) {
  wait(cached);
  wait(cached + 8);
  put(cached + 4, 0);
  EXPECT_EQ(wait(cached), 2 * line_clocks);
  EXPECT_EQ(wait(cached + 8), 0u);
  for (const std::uint32_t alias : {no_allocate, no_cache, bypass})
    EXPECT_TRUE(bus_.write(alias, 0, Width::word, Master::core0, at_).fault);
  put(control + 0x3000, 2);  // ERR_BADWRITE off
  for (const std::uint32_t alias : {no_allocate, no_cache, bypass})
    EXPECT_FALSE(bus_.write(alias, 0, Width::word, Master::core0, at_).fault);
  EXPECT_EQ(wait(cached), 0u) << "ignored";
}

TEST_F(XipTest, CountersCountAccessesAndHits) {
  reports_.clear();
  put(ctr_acc, 1);
  put(ctr_hit, 1);
  wait(cached);
  EXPECT_EQ(get(ctr_acc), 1u);
  EXPECT_EQ(get(ctr_hit), 0u);
  wait(cached);
  wait(bypass);
  EXPECT_EQ(get(ctr_acc), 3u);
  EXPECT_EQ(get(ctr_hit), 1u);
  put(ctr_hit, 7);
  EXPECT_EQ(get(ctr_hit), 0u);
  EXPECT_EQ(get(ctr_acc), 3u);
  EXPECT_TRUE(reports_.empty());
}

// 2.6.3.2: the tags are cleared one set after the other, 1024 of them; reads of the flash wait.
TEST_F(XipTest, AFlushTakesACycleForEachSet) {
  wait(cached);
  put(flush, 1);
  const Cycle begun = at_ - 10;
  EXPECT_EQ(get(stat) & 1u, 0u);
  at_ = begun + 1000;
  Access access = bus_.read(flush, Width::word, Master::core0, at_);
  EXPECT_EQ(access.wait, 24u);
  access = bus_.read(cached, Width::word, Master::core1, begun + 1010);
  EXPECT_EQ(access.wait, 14 + 2 * line_clocks);
  at_ = begun + 1100;
  EXPECT_EQ(get(stat), 3u) << "flush ready, stream empty";
  EXPECT_EQ(bus_.read(flush, Width::word, Master::core0, at_).wait, 0u);
}

// 2.6.3.1 and CTRL: SRAM while it is not a cache; without power there is neither.
TEST_F(XipTest, TheCachesMemoryIsSramWhileTheCacheIsOff) {
  const auto sram_faults = [&] {
    return bus_.read(cache_sram, Width::word, Master::core0, at_).fault;
  };
  wait(cached);
  EXPECT_TRUE(sram_faults());
  put(control + 0x3000, 1);
  EXPECT_FALSE(sram_faults());
  put(cache_sram + 0x3ffc, 0x1234'5678);
  EXPECT_EQ(get(cache_sram + 0x3ffc), 0x1234'5678u) << "the last word";
  EXPECT_EQ(wait(cached), 2 * line_clocks) << "straight to the flash";
  put(control + 0x2000, 8);
  EXPECT_TRUE(sram_faults());
  put(control + 0x2000, 1);
  EXPECT_EQ(get(control) & 1u, 0u) << "cannot be enabled without power";
  put(control + 0x3000, 8);
  EXPECT_FALSE(sram_faults());
  // Lines that a flush has dropped are still in the memory.
  const std::uint32_t first = get(cache_sram);
  put(flush, 1);
  EXPECT_EQ(get(cache_sram), first);
}

TEST_F(XipTest, TheSecondMasterWaitsForTheFirst) {
  constexpr std::uint32_t miss = 2 * line_clocks;
  const auto read = [&](std::uint32_t address, Master master, Cycle at) {
    return bus_.read(address, Width::word, master, at).wait;
  };
  wait(cached + 0x100);
  const Cycle at = at_;
  EXPECT_EQ(read(cached, Master::core0, at), miss);  // through at + miss
  EXPECT_EQ(read(cached + 0x100, Master::core1, at + 6), miss + 1 - 6) << "even for a hit";
  EXPECT_EQ(read(cached + 0x200, Master::dma, at + miss), 2 + miss);
  EXPECT_EQ(read(cached + 0x100, Master::core0, at + 1000), 0u);
}

/// A core that runs code in the flash.
class CodeInFlash : public XipTest {
 protected:
  void code(std::uint32_t offset, std::initializer_list<unsigned> halfwords) {
    for (const unsigned value : halfwords) {
      const auto half = static_cast<std::uint16_t>(value);
      std::memcpy(&flash_.storage()[offset], &half, sizeof half);
      offset += 2;
    }
  }
  void start(std::uint32_t pc) {
    wheel_.advance_to(at_);
    core_.reset(0);
    core_.set_reg(15, pc);
    core_.set_reg(13, 0x2004'1000);
    core_.set_xpsr(1u << 24);
  }
  IrqLines irqs_;
  Core core_{0, bus_, wheel_, irqs_, timing_, note_};
};

TEST_F(CodeInFlash, WaitsForEachLineOnce) {
  code(0x1000, {0xbf00, 0xbf00, 0xbf00, 0xbf00,    // four NOPs: a line
                0xbf00, 0xbf00, 0xbf00, 0xe7f7});  // and three, B to the start
  start(cached + 0x1000);
  const auto line = [&](int instructions) {
    const Cycle from = core_.cycle();
    for (int i = 0; i < instructions; ++i) core_.step();
    return core_.cycle() - from;
  };
  EXPECT_EQ(line(4), 4 + 2 * line_clocks);
  EXPECT_EQ(line(4), 3 + 2 + 2 * line_clocks);
  for (int round = 0; round < 3; ++round) EXPECT_EQ(line(8), 7u + 2u) << "as from SRAM";
}

TEST_F(CodeInFlash, IsFetchedOneWordAtATime) {
  code(0x1000, {0xbf00, 0xbf00, 0xbf00, 0xbf00, 0xbf00, 0xbf00});
  start(cached + 0x1000);
  put(ctr_acc, 0);
  put(ctr_hit, 0);
  for (int i = 0; i < 6; ++i) core_.step();
  EXPECT_EQ(get(ctr_acc), 3u);
  EXPECT_EQ(get(ctr_hit), 1u);
}

TEST_F(CodeInFlash, AnInstructionOverTwoLinesWaitsForBoth) {
  code(0x1006, {0xf000, 0xf801});  // BL to 0x100c
  start(cached + 0x1006);
  EXPECT_EQ(core_.step(), 3u + 2u * 2u * line_clocks);
  EXPECT_EQ(core_.reg(15), cached + 0x100c);
}

TEST_F(CodeInFlash, PastTheCacheEveryWordIsATransfer) {
  code(0x1000, {0xbf00, 0xbf00, 0xbf00, 0xe7fb});  // B to the start
  start(bypass + 0x1000);
  for (int round = 0; round < 2; ++round) {
    const Cycle from = core_.cycle();
    for (int i = 0; i < 4; ++i) core_.step();
    EXPECT_EQ(core_.cycle() - from, 3u + 2u + 2u * 2u * line_clocks);
  }
}

TEST_F(CodeInFlash, ALiteralOfTheSameLineIsAHit) {
  code(0x1000, {0x4800, 0xbf00, 0x5678, 0x1234});  // LDR r0, [pc, #0]
  start(cached + 0x1000);
  EXPECT_EQ(core_.step(), 2u + 2u * line_clocks);
  EXPECT_EQ(core_.reg(0), 0x1234'5678u);
}

TEST_F(CodeInFlash, FaultsWhereNothingCanBeRead) {
  start(cached + 0x1000);
  put(ssi + 8, 0);
  core_.step();
  EXPECT_EQ(core_.exception(), 3u);
}

}  // namespace
}  // namespace lamplock::test::xip_test
