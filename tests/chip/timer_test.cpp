#include "sim/chip/system/timer.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/chip/system_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::timer_test {
namespace {

class TimerTest : public ::testing::Test {
 protected:
  TimerTest() { rig_.start_clocks(); }
  std::uint32_t read(std::uint32_t offset) { return rig_.system.timer.read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) { rig_.system.timer.write(offset, value); }
  /// Advances to the first cycle of the microsecond `time`.
  void go_to(std::uint64_t time) {
    while (rig_.system.timer.time() < time) rig_.pass(1);
  }
  rigs::SystemRig rig_;
};

TEST_F(TimerTest, CountsOneMicrosecondEvery125Cycles) {
  go_to(5);
  const Cycle start = rig_.wheel.now();
  for (std::uint32_t us = 0; us < 1000; ++us) {
    ASSERT_EQ(read(0x28), 5 + us);
    rig_.wheel.advance_to(start + 125 * us + 124);
    ASSERT_EQ(read(0x28), 5 + us);
    rig_.pass(1);
  }
}

TEST_F(TimerTest, AlarmFiresInTheCycleOfItsMicrosecond) {
  go_to(10);
  write(0x38, 0xf);
  const Cycle start = rig_.wheel.now();
  write(0x10, 15);
  write(0x1c, 12);
  EXPECT_EQ(read(0x20), 9u);
  rig_.wheel.advance_to(start + 249);
  EXPECT_FALSE(rig_.line(Irq::timer_3));
  rig_.wheel.advance_to(start + 250);
  EXPECT_TRUE(rig_.line(Irq::timer_3));
  EXPECT_EQ(read(0x20), 1u);
  EXPECT_EQ(read(0x34), 8u);
  write(0x34, 8);
  EXPECT_FALSE(rig_.line(Irq::timer_3));
  rig_.wheel.advance_to(start + 624);
  EXPECT_FALSE(rig_.line(Irq::timer_0));
  rig_.wheel.advance_to(start + 625);
  EXPECT_TRUE(rig_.line(Irq::timer_0));
  EXPECT_FALSE(rig_.line(Irq::timer_1));
}

TEST_F(TimerTest, ReadingTheLowHalfLatchesTheHighHalf) {
  write(0x04, 0xffffffff);
  write(0x00, 7);
  EXPECT_EQ(read(0x0c), 0xffffffffu);
  rig_.pass(125);
  EXPECT_EQ(read(0x08), 7u) << "as of the read of the low half";
  EXPECT_EQ(read(0x24), 8u);
  EXPECT_EQ(read(0x0c), 0u);
  EXPECT_EQ(read(0x08), 8u);
}

TEST_F(TimerTest, AlarmsCompareTheLowHalfOnly) {
  write(0x38, 1);
  write(0x10, 2);
  write(0x04, 0xfffffffe);
  write(0x00, 0);
  rig_.pass(125 * 3);
  EXPECT_FALSE(rig_.line(Irq::timer_0));
  rig_.pass(125 * 2);
  EXPECT_TRUE(rig_.line(Irq::timer_0));
}

TEST_F(TimerTest, PauseStopsTimeAndAlarms) {
  write(0x38, 1);
  go_to(20);
  write(0x10, 25);
  write(0x30, 1);
  rig_.pass(125 * 1000);
  EXPECT_EQ(read(0x28), 20u);
  EXPECT_FALSE(rig_.line(Irq::timer_0));
  write(0x30, 0);
  rig_.pass(125 * 6);
  EXPECT_EQ(read(0x28) / 2, 13u);
  EXPECT_TRUE(rig_.line(Irq::timer_0));
}

TEST_F(TimerTest, ForcedInterruptAndItsRegisters) {
  write(0x3c, 4);
  EXPECT_TRUE(rig_.line(Irq::timer_2));
  EXPECT_EQ(read(0x40), 4u);
  EXPECT_EQ(read(0x34), 0u);
  EXPECT_EQ(read(0x2c), 7u);
}

TEST_F(TimerTest, TimeIsIndependentOfClkSys) {
  go_to(100);
  const Picoseconds start = rig_.wheel.time();
  std::mt19937_64 random(3);
  constexpr std::uint32_t dividers[] = {0x100, 0x180, 0x200, 0x333, 0x700};
  write(0x38, 1);
  for (int n = 0; n < test::scaled(300); ++n) {
    rig_.system.clocks.write(0x40, dividers[random() % 5]);
    write(0x34, 1);
    const std::uint64_t now = rig_.system.timer.time();
    const std::uint64_t ahead = 1 + random() % 40;
    write(0x10, static_cast<std::uint32_t>(now + ahead));
    while (!rig_.line(Irq::timer_0)) {
      ASSERT_LE(rig_.system.timer.time(), now + ahead);
      rig_.pass(1);
      if (random() % 50 == 0) rig_.system.clocks.write(0x40, dividers[random() % 5]);
    }
    ASSERT_EQ(rig_.system.timer.time(), now + ahead);
    const Picoseconds real = rig_.wheel.time() - start;
    // clk_sys is at least 17.8 MHz: the cycle in which the time is read is at most 56 ns late.
    ASSERT_NEAR(static_cast<double>(real) / 1e6, static_cast<double>(now + ahead) - 100.0, 0.06);
  }
}

TEST_F(TimerTest, TickOfOneCycleMakesA12MHzTimer) {
  rig_.system.watchdog.write(0x2c, 1 | 1u << 9);
  const std::uint32_t before = read(0x28);
  rig_.pass(125'000);
  EXPECT_NEAR(read(0x28) - before, 12'000, 1);
}

TEST_F(TimerTest, HeldInResetTimeDoesNotPass) {
  Peripheral& gate = rig_.system.resets.attach(ResetBit::timer, rig_.system.timer);
  rig_.pass(125'000);
  rig_.system.resets.write(0, 0);
  EXPECT_EQ(gate.read(0x28), 0u);
  rig_.pass(1250);
  EXPECT_NEAR(gate.read(0x28), 10, 1);
}

TEST_F(TimerTest, TimeStopsWithoutTicks) {
  rig_.system.watchdog.write(0x2c, 12);
  const std::uint32_t before = read(0x28);
  rig_.pass(125'000);
  EXPECT_EQ(read(0x28), before);
}

}  // namespace
}  // namespace lamplock::sim::chip::timer_test
