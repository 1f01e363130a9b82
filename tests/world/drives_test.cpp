#include "sim/world/drives.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/scale.hpp"

namespace lamplock::sim {
namespace {

/// Generates random pulse trains for one axis that a drive can follow, with single faults added.
class Train {
 public:
  Train(PinBus& bus, int axis, std::uint64_t seed) : bus_(bus), axis_(axis), random_(seed) {}

  void step() {
    const int fault = fault_wanted();
    const bool turn = fault == 3 || pick(4) == 0;
    Picoseconds rise = last_rise_ + 900'000 + static_cast<Picoseconds>(pick(2'000'000));
    if (fault == 2 && !turn && !steps.empty()) {  // the first step has no predecessor
      rise = last_rise_ + width_ + 1 + static_cast<Picoseconds>(pick(899'998 - 700'000));
      ++expected.fast_steps;
    }
    if (turn) {
      negative_ = !negative_;
      Picoseconds setup = 200'000 + static_cast<Picoseconds>(pick(200'000));
      if (fault == 3) {
        setup = static_cast<Picoseconds>(pick(200'000));
        ++expected.late_directions;
      }
      bus_.set(dir_pin(axis_), negative_, rise - setup);
    }
    width_ = 400'000 + static_cast<Picoseconds>(pick(100'000));
    if (fault == 1) {
      width_ = 1 + static_cast<Picoseconds>(pick(399'999));
      ++expected.short_pulses;
    }
    bus_.set(step_pin(axis_), true, rise);
    bus_.set(step_pin(axis_), false, rise + width_);
    position += negative_ ? -1 : 1;
    steps.emplace_back(rise, position);
    last_rise_ = rise;
  }

  std::int32_t position_at(Picoseconds at) const {
    std::int32_t result = 0;
    for (const auto& [time, after] : steps)
      if (time <= at) result = after;
    return result;
  }

  std::int32_t position = 0;
  DriveFaults expected;
  double fault_share = 0;
  std::vector<std::pair<Picoseconds, std::int32_t>> steps;

 private:
  std::uint64_t pick(std::uint64_t below) { return random_() % below; }
  /// 0 none, 1 short pulse, 2 too fast, 3 direction too late; never two in one step.
  int fault_wanted() {
    if (static_cast<double>(pick(1000)) >= 1000 * fault_share) return 0;
    return static_cast<int>(1 + pick(3));
  }
  PinBus& bus_;
  int axis_;
  std::mt19937_64 random_;
  bool negative_ = false;
  Picoseconds last_rise_ = 0;
  Picoseconds width_ = 450'000;
};

TEST(Drives, CountExactlyAndReportNothingForGoodTrains) {
  PinBus bus;
  Drives drives({}, bus);
  std::vector<Train> trains;
  trains.reserve(max_axes);
  for (int axis = 0; axis < max_axes; ++axis)
    trains.emplace_back(bus, axis, static_cast<std::uint64_t>(axis) + 1);
  for (int n = 0; n < lamplock::test::scaled(50'000); ++n)
    for (Train& train : trains) train.step();
  for (std::size_t axis = 0; axis < trains.size(); ++axis)
    EXPECT_EQ(drives.position()[axis], trains[axis].position);
  EXPECT_EQ(drives.total_faults(), 0u);
}

TEST(Drives, ReportExactlyTheInjectedFaults) {
  for (int seed = 0; seed < lamplock::test::scaled(20); ++seed) {
    PinBus bus;
    Drives drives({}, bus);
    const int axis = seed % max_axes;
    Train train(bus, axis, static_cast<std::uint64_t>(seed));
    train.fault_share = 0.05;
    for (int n = 0; n < 5'000; ++n) train.step();
    EXPECT_EQ(drives.faults(axis), train.expected) << seed;
    EXPECT_GT(train.expected.short_pulses, 20u);
    EXPECT_GT(train.expected.fast_steps, 20u);
    EXPECT_GT(train.expected.late_directions, 20u);
    EXPECT_EQ(drives.total_faults(), train.expected.total());
    EXPECT_EQ(drives.position()[static_cast<std::size_t>(axis)], train.position);
  }
}

TEST(Drives, LimitsAreExact) {
  PinBus bus;
  Drives drives({.min_pulse_ns = 400, .min_period_ns = 900, .dir_setup_ns = 200}, bus);
  const auto pulse = [&bus](Picoseconds rise, Picoseconds width) {
    bus.set(Pin::step_x, true, rise);
    bus.set(Pin::step_x, false, rise + width);
  };
  pulse(0, 400'000);
  pulse(900'000, 400'000);
  bus.set(Pin::dir_x, true, 1'600'000);
  pulse(1'800'000, 400'000);
  EXPECT_EQ(drives.total_faults(), 0u);
  pulse(2'699'999, 400'000);
  EXPECT_EQ(drives.faults(0).fast_steps, 1u);
  pulse(3'599'999, 399'999);
  EXPECT_EQ(drives.faults(0).short_pulses, 1u);
  bus.set(Pin::dir_x, false, 4'600'001);
  pulse(4'800'000, 400'000);
  EXPECT_EQ(drives.faults(0).late_directions, 1u);
  EXPECT_EQ(drives.total_faults(), 3u);
}

TEST(Drives, CountPausesThatAreTooShort) {
  for (const bool active_low : {false, true}) {
    PinBus bus;
    bus.set(Pin::step_x, active_low, 0);
    Drives drives({.min_low_ns = 2500, .first_active_low = {active_low}}, bus);
    const auto pulse = [&bus, active_low](Picoseconds begin) {
      bus.set(Pin::step_x, !active_low, begin);
      bus.set(Pin::step_x, active_low, begin + 3'000'000);
    };
    pulse(10'000'000);
    pulse(15'500'000);
    EXPECT_EQ(drives.total_faults(), 0u);
    pulse(20'999'999);
    EXPECT_EQ(drives.faults(0).short_pauses, 1u);
    EXPECT_EQ(drives.total_faults(), 1u);
  }
}

TEST(Drives, KnowEarlierPositions) {
  PinBus bus;
  Drives drives({}, bus);
  Train train(bus, 2, 7);
  for (int n = 0; n < 10'000; ++n) train.step();
  std::mt19937_64 random(5);
  for (int n = 0; n < 200; ++n) {
    const auto& reference = train.steps[train.steps.size() - 1 - random() % 4000];
    for (Picoseconds offset : {-1, 0, 1})
      ASSERT_EQ(drives.position_at(reference.first + offset)[2],
                train.position_at(reference.first + offset));
  }
}

TEST(Drives, BeforeTheirHistoryTheyGiveTheOldestPosition) {
  PinBus bus;
  Drives drives({}, bus);
  constexpr std::int32_t count = 5000;
  for (int n = 0; n < count; ++n) {
    bus.set(Pin::step_a, true, n * ps_per_us);
    bus.set(Pin::step_a, false, n * ps_per_us + ps_per_us / 2);
  }
  EXPECT_EQ(drives.position_at(0)[3], count - static_cast<std::int32_t>(Drives::remembered_steps));
}

}  // namespace
}  // namespace lamplock::sim
