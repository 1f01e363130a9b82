// The feeder: when its sensor detects a sheet, also with a broken wire; drives that are disabled.
#include <gtest/gtest.h>

#include "sim/world/world.hpp"

namespace lamplock::sim {
namespace {

TEST(Feeder, DetectsASheetAfterTheFeedDistance) {
  PinBus bus;
  Feeder feeder({.gap = 200 * ps_per_ms, .sheet = 150 * ps_per_ms}, bus);
  const auto run = [&](Picoseconds to) {
    while (feeder.next_event() <= to) feeder.advance(feeder.next_event());
  };
  EXPECT_TRUE(bus.level(Pin::aux_in));
  bus.set(Pin::aux_out, true, 0);
  run(150 * ps_per_ms);
  bus.set(Pin::aux_out, false, 150 * ps_per_ms);
  EXPECT_EQ(feeder.next_event(), never);
  bus.set(Pin::aux_out, true, 1000 * ps_per_ms);
  EXPECT_EQ(feeder.next_event(), 1050 * ps_per_ms);
  run(1050 * ps_per_ms);
  EXPECT_FALSE(bus.level(Pin::aux_in));
  EXPECT_EQ(feeder.sheets(), 1);
  run(1199 * ps_per_ms);
  EXPECT_FALSE(bus.level(Pin::aux_in));
  run(1200 * ps_per_ms);
  EXPECT_TRUE(bus.level(Pin::aux_in));
  run(2000 * ps_per_ms);
  EXPECT_EQ(feeder.sheets(), 3);
}

TEST(Feeder, DetectsNothingThroughABrokenWire) {
  PinBus bus;
  Feeder feeder({.broken_from = 250 * ps_per_ms}, bus);
  bus.set(Pin::aux_out, true, 0);
  for (Picoseconds at = 0; at < 1000 * ps_per_ms; at = feeder.next_event()) {
    feeder.advance(at);
    EXPECT_EQ(bus.level(Pin::aux_in), at < 200 * ps_per_ms || at >= 250 * ps_per_ms) << at;
  }
}

TEST(Drives, MissStepsWhileDisabledAndBeforeTheyHold) {
  PinBus bus;
  Drives drives({.wake_ms = 100, .axes_of_enable_z = 0b0100}, bus);
  Picoseconds now = 0;
  const auto missed = [&](Pin step, Picoseconds at) {
    now = at;
    const std::uint64_t before = drives.total_faults();
    bus.set(step, true, now);
    bus.set(step, false, now + ps_per_us / 2);
    return drives.total_faults() - before;
  };
  EXPECT_EQ(missed(Pin::step_x, 1 * ps_per_ms), 0u);  // the enable input is not wired
  bus.set(Pin::enable, true, 2 * ps_per_ms);
  bus.set(Pin::enable_z, true, 2 * ps_per_ms);
  EXPECT_EQ(missed(Pin::step_x, 3 * ps_per_ms), 0u);
  bus.set(Pin::enable, false, 4 * ps_per_ms);
  EXPECT_EQ(missed(Pin::step_x, 5 * ps_per_ms), 1u);
  EXPECT_EQ(missed(Pin::step_z, 6 * ps_per_ms), 0u);
  bus.set(Pin::enable, true, 10 * ps_per_ms);
  EXPECT_EQ(missed(Pin::step_x, 109 * ps_per_ms), 1u);
  EXPECT_EQ(missed(Pin::step_x, 110 * ps_per_ms), 0u);
  bus.set(Pin::enable_z, false, 120 * ps_per_ms);
  EXPECT_EQ(missed(Pin::step_z, 130 * ps_per_ms), 1u);
  EXPECT_EQ(drives.faults(2).unpowered_steps, 1u);
}

}  // namespace
}  // namespace lamplock::sim
