#include "sim/chip/system/watchdog.hpp"

#include <gtest/gtest.h>

#include "tests/chip/system_rig.hpp"

namespace lamplock::sim::chip::watchdog_test {
namespace {

constexpr std::uint32_t enable = 1u << 30;
constexpr std::uint32_t all_but_oscillators = 0x1fffc;

class WatchdogTest : public ::testing::Test {
 protected:
  WatchdogTest() {
    rig_.start_clocks();
    rig_.system.psm.attach(PsmBit::proc0, [this](bool held) { held ? ++held_ : ++released_; });
  }
  std::uint32_t read(std::uint32_t offset) { return rig_.system.watchdog.read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) {
    rig_.system.watchdog.write(offset, value);
  }
  rigs::SystemRig rig_;
  int held_ = 0, released_ = 0;
};

TEST_F(WatchdogTest, CountsTwicePerTick) {
  rig_.system.psm.write(8, all_but_oscillators);
  // Aligns to a tick.
  const std::uint64_t tick = rig_.system.ticks.ticks() + 1;
  while (rig_.system.ticks.ticks() < tick) rig_.pass(1);
  write(0x4, 2000);
  write(0x0, enable);
  rig_.pass(125 * 10);
  EXPECT_EQ(read(0) & 0xffffffu, 1980u);
  rig_.pass(125 * 990 - 1);
  EXPECT_EQ(held_, 0);
  rig_.pass(1);
  EXPECT_EQ(held_, 1);
  EXPECT_EQ(released_, 1);
  EXPECT_EQ(read(0x8), 1u);
  rig_.pass(100'000);
  EXPECT_EQ(held_, 1) << "fires once";
}

TEST_F(WatchdogTest, DisabledItWaits) {
  write(0x4, 20);
  rig_.pass(125 * 1000);
  EXPECT_EQ(read(0), 0x07000000u | 20u);
  EXPECT_EQ(read(0x8), 0u);
}

TEST_F(WatchdogTest, NothingIsResetUnlessSelected) {
  write(0x0, 1u << 31);
  EXPECT_EQ(held_, 0);
  EXPECT_EQ(read(0x8), 2u);
  EXPECT_EQ(rig_.wheel.frequency(), 125'000'000u);
}

TEST_F(WatchdogTest, SelectedStagesAreResetScratchIsKept) {
  struct Bench {
    explicit Bench(rigs::SystemRig& rig)
        : timer(rig.system.resets.attach(ResetBit::timer, rig.system.timer)),
          io(rig.system.resets.attach(ResetBit::io_bank0, rig.gpio.io_bank())) {}
    Peripheral& timer;
    Peripheral& io;
  } bench(rig_);
  rig_.system.resets.write(0, 0);
  bench.io.write(4, 5);
  rig_.sio.core(0).write(0x10, 1);
  rig_.sio.core(0).write(0x20, 1);
  EXPECT_EQ(rig_.gpio.pad_levels(), 1u);
  for (std::uint32_t n = 0; n < 8; ++n) write(0xc + 4 * n, 0x100 + n);
  rig_.system.psm.write(8, all_but_oscillators);
  write(0x0, 1u << 31);
  EXPECT_EQ(held_, 1);
  EXPECT_EQ(rig_.gpio.pad_levels(), 0u);
  EXPECT_EQ(bench.io.peek(4), 0x1fu);
  EXPECT_EQ(rig_.system.resets.read(0), 0x1ffffffu);
  EXPECT_EQ(rig_.wheel.frequency(), 6'500'000u) << "clk_ref and clk_sys are back at the ring";
  EXPECT_NE(rig_.system.xosc.hz(), 0u) << "not selected";
  for (std::uint32_t n = 0; n < 8; ++n) EXPECT_EQ(read(0xc + 4 * n), 0x100 + n);
  EXPECT_EQ(read(0x8), 2u);
  EXPECT_TRUE(rig_.reports.empty()) << rig_.reports.front();
}

TEST_F(WatchdogTest, OnlySubsystemsAreResetByTheSelectionOfResets) {
  Peripheral& io = rig_.system.resets.attach(ResetBit::io_bank0, rig_.gpio.io_bank());
  rig_.system.resets.write(0, 0);
  io.write(4, 5);
  rig_.system.resets.write(4, 1u << 5);
  write(0x0, 1u << 31);
  EXPECT_EQ(held_, 0);
  EXPECT_EQ(io.peek(4), 0x1fu);
  EXPECT_EQ(rig_.system.resets.read(0), 1u << 5);
}

TEST_F(WatchdogTest, PowerUpClearsScratchAndReportsItsReason) {
  write(0xc, 5);
  write(0x0, 1u << 31);
  rig_.system.reset(ChipReset::run_pin);
  EXPECT_EQ(read(0xc), 0u);
  EXPECT_EQ(read(0x8), 0u);
  EXPECT_EQ(rig_.system.vreg.read(8), 1u << 16);
  EXPECT_EQ(held_, 1);
  EXPECT_EQ(released_, 1);
  EXPECT_EQ(rig_.system.xosc.hz(), 0u);
  rig_.system.reset(ChipReset::brown_out);
  EXPECT_EQ(rig_.system.vreg.read(8), 1u << 8);
  EXPECT_TRUE(rig_.reports.empty()) << rig_.reports.front();
}

TEST_F(WatchdogTest, TickRegister) {
  EXPECT_EQ(read(0x2c) & 0x7ffu, 12u | 3u << 9);
  const std::uint32_t left = read(0x2c) >> 11;
  EXPECT_GE(left, 1u);
  EXPECT_LE(left, 12u);
  write(0x2c, 12);
  EXPECT_EQ(read(0x2c) & 0x7ffu, 12u);
}

}  // namespace
}  // namespace lamplock::sim::chip::watchdog_test
