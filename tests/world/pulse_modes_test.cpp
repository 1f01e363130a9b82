#include <gtest/gtest.h>

#include <random>

#include "sim/world/drives.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::pulse_modes_test {
namespace {

constexpr Pin first = Pin::step_x, second = Pin::dir_x;

DriveConfig mode(PulseMode mode) {
  DriveConfig config;
  config.mode[0] = mode;
  return config;
}

TEST(PulseModes, CwAndCcwCountInTheirDirections) {
  for (const bool active_low : {false, true}) {
    PinBus bus;
    DriveConfig config = mode(PulseMode::cw_ccw);
    config.first_active_low[0] = config.second_active_low[0] = active_low;
    if (active_low) {
      bus.set(first, true, 0);
      bus.set(second, true, 0);
    }
    Drives drives(config, bus);
    std::mt19937_64 random(1);
    Picoseconds at = ps_per_us;
    std::int32_t expected = 0;
    for (int n = 0; n < lamplock::test::scaled(50'000); ++n) {
      const bool up = random() % 2 == 0;
      const Picoseconds width = 400'000 + static_cast<Picoseconds>(random() % 100'000);
      bus.set(up ? first : second, !active_low, at);
      bus.set(up ? first : second, active_low, at + width);
      expected += up ? 1 : -1;
      ASSERT_EQ(drives.position()[0], expected);
      at += std::max<Picoseconds>(width + 200'000, 900'000) +
            static_cast<Picoseconds>(random() % 500'000);
    }
    EXPECT_EQ(drives.total_faults(), 0u);
  }
}

TEST(PulseModes, LimitsOfCwAndCcwAreExact) {
  PinBus bus;
  Drives drives(mode(PulseMode::cw_ccw), bus);
  const auto pulse = [&bus](Pin pin, Picoseconds rise, Picoseconds width) {
    bus.set(pin, true, rise);
    bus.set(pin, false, rise + width);
  };
  const DriveFaults& faults = drives.faults(0);
  pulse(first, 0, 700'000);
  pulse(second, 900'000, 400'000);  // exactly at each limit
  EXPECT_EQ(faults.total(), 0u);
  pulse(second, 1'799'999, 400'000);
  EXPECT_EQ(faults.fast_steps, 1u);
  pulse(second, 3'000'000, 399'999);
  EXPECT_EQ(faults.short_pulses, 1u);
  pulse(second, 5'000'000, 800'000);
  pulse(first, 5'999'999, 400'000);  // 1 ps less than the set-up time after CCW
  EXPECT_EQ(faults.late_directions, 1u);
  bus.set(first, true, 8'000'000);
  bus.set(second, true, 9'000'000);
  EXPECT_EQ(faults.both_high, 1u);
  EXPECT_EQ(faults.total(), 4u);
  EXPECT_EQ(drives.position()[0], 1 - 4 + 1 + 1 - 1);
}

/// Levels of A and B at a place.
std::pair<bool, bool> levels(std::int32_t place) {
  const int phase = place & 3;
  return {phase == 1 || phase == 2, phase >= 2};
}

TEST(PulseModes, QuadratureCountsBothWaysAtRandomSpeeds) {
  PinBus bus;
  Drives drives(mode(PulseMode::quadrature), bus);
  std::mt19937_64 random(6);
  Picoseconds at = ps_per_us;
  std::int32_t place = 0;
  for (int run = 0; run < lamplock::test::scaled(2000); ++run) {
    const int way = random() % 2 == 0 ? 1 : -1;
    const auto period = static_cast<Picoseconds>(900'000 + random() % 50'000'000);
    for (auto steps = random() % 60; steps > 0; --steps, at += period) {
      place += way;
      bus.set(first, levels(place).first, at);
      bus.set(second, levels(place).second, at);
      ASSERT_EQ(drives.position()[0], place);
      ASSERT_EQ(drives.position_at(at - 1)[0], place - way);
    }
    at += 900'000;
  }
  EXPECT_EQ(drives.total_faults(), 0u);
}

TEST(PulseModes, QuadratureFaultsAreExact) {
  PinBus bus;
  DriveConfig config = mode(PulseMode::quadrature);
  config.min_period_ns = 0;
  Drives drives(config, bus);
  const DriveFaults& faults = drives.faults(0);
  bus.set(first, true, ps_per_us);
  bus.set(second, true, ps_per_us + 100'000);  // exactly at the minimum gap
  EXPECT_EQ(faults.total(), 0u);
  EXPECT_EQ(drives.position()[0], 2);
  bus.set(first, false, 5 * ps_per_us);
  bus.set(second, false, 5 * ps_per_us + 99'999);
  EXPECT_EQ(faults.quadrature_jumps, 1u);
  bus.set(first, true, 7 * ps_per_us);
  bus.set(first, false, 7 * ps_per_us + 399'999);
  EXPECT_EQ(faults.short_pulses, 1u);
  EXPECT_EQ(faults.total(), 2u);
  EXPECT_EQ(drives.position()[0], 4);

  PinBus fast_bus;
  Drives fast(mode(PulseMode::quadrature), fast_bus);
  fast_bus.set(first, true, ps_per_us);
  fast_bus.set(second, true, ps_per_us + 900'000);
  EXPECT_EQ(fast.faults(0).total(), 0u);
  fast_bus.set(first, false, ps_per_us + 1'799'999);
  EXPECT_EQ(fast.faults(0).fast_steps, 1u);
}

TEST(PulseModes, InvertedStepAndDirection) {
  PinBus bus;
  bus.set(first, true, 0);
  DriveConfig config;
  config.first_active_low[0] = config.second_active_low[0] = true;
  Drives drives(config, bus);
  const auto pulse = [&bus](Picoseconds at) {
    bus.set(first, false, at);
    bus.set(first, true, at + 400'000);
  };
  pulse(ps_per_us);  // DIR low: negative
  EXPECT_EQ(drives.position()[0], -1);
  bus.set(second, true, 2 * ps_per_us);
  pulse(3 * ps_per_us);
  pulse(4 * ps_per_us);
  EXPECT_EQ(drives.position()[0], 1);
  EXPECT_EQ(drives.total_faults(), 0u);
}

TEST(PulseModes, DirectionIsHeldAfterTheStep) {
  PinBus bus;
  DriveConfig config;
  config.dir_hold_ns = 500;
  Drives drives(config, bus);
  bus.set(first, true, ps_per_us);
  bus.set(first, false, ps_per_us + 400'000);
  bus.set(second, true, ps_per_us + 500'000);
  EXPECT_EQ(drives.total_faults(), 0u);
  bus.set(first, true, 3 * ps_per_us);
  bus.set(first, false, 3 * ps_per_us + 400'000);
  bus.set(second, false, 3 * ps_per_us + 499'999);
  EXPECT_EQ(drives.faults(0).unheld_directions, 1u);
  EXPECT_EQ(drives.total_faults(), 1u);
}

TEST(PulseModes, EveryAxisHasItsOwnMode) {
  PinBus bus;
  DriveConfig config;
  config.mode = {PulseMode::quadrature, PulseMode::step_dir, PulseMode::cw_ccw,
                 PulseMode::step_dir};
  config.start = {5, 6, 7, 8};
  Drives drives(config, bus);
  for (int axis = 0; axis < max_axes; ++axis) {
    bus.set(dir_pin(axis), true, ps_per_us);
    bus.set(step_pin(axis), true, 3 * ps_per_us);
    bus.set(step_pin(axis), false, 4 * ps_per_us);
  }
  // B up, A up, A down: -1 -1 +1; one back; CCW and CW; one back.
  EXPECT_EQ(drives.position(), (StepPosition{4, 5, 7, 7}));
  EXPECT_EQ(drives.position_at(0), (StepPosition{5, 6, 7, 8}));
}

}  // namespace
}  // namespace lamplock::sim::pulse_modes_test
