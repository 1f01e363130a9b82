// The guarantees of the reversal guard, over random motion with smooth and abrupt reversals.
#include "firmware/stepper/reversal_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include "firmware/stepper/pulse_output.hpp"
#include "firmware/stepper/segment.hpp"
#include "tests/scale.hpp"

namespace lamplock::stepper {
namespace {

/// Bresenham's output for an axis in one tick.
struct Wanted {
  std::int32_t step = 0;  ///< -1, 0, 1
  int heading = 0;        ///< sign of the rate; 0 = none
};

/// The guard's output for that tick.
struct Put {
  bool step = false;
  bool back = false;
  std::int32_t owed = 0;
  bool asked = false;  ///< the guard was asked
  bool operator==(const Put&) const = default;
};

/// Ticks of one axis with reversals and random rates below `max_rate` steps per tick.
std::vector<Wanted> random_motion(std::mt19937_64& random, double max_rate, bool abrupt) {
  std::vector<Wanted> all;
  Int128 position = middle_of_step(0);
  double rate = 0;
  const auto pick = [&random](double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random);
  };
  while (all.size() < 3000) {
    double target = pick(-max_rate, max_rate) * (random() % 3 == 0 ? 0.01 : 1);
    if (random() % 5 == 0) target = 0;
    const int ticks = static_cast<int>(1 + random() % (random() % 3 == 0 ? 400 : 30));
    if (abrupt) rate = target;
    const double accel = (target - rate) / ticks;
    for (int i = 0; i < ticks; ++i) {
      const auto q62 = static_cast<std::int64_t>(rate * 0x1p62);
      const std::int64_t before = position.hi();
      position = position + (Int128::product(q62, 1) << 2);
      all.push_back({static_cast<std::int32_t>(position.hi() - before), q62 == 0  ? 0
                                                                        : q62 < 0 ? -1
                                                                                  : 1});
      rate += accel;
    }
  }
  return all;
}

/// Calls the guard in every tick.
std::vector<Put> ask_always(ReversalGuard guard, const std::vector<Wanted>& motion) {
  std::vector<Put> all;
  guard.wake(1000);
  for (const Wanted& w : motion) {
    if (w.heading != 0) guard.head(w.heading < 0);
    const bool step = guard.tick(w.step);
    all.push_back({step, guard.back(), guard.owed(), true});
  }
  return all;
}

/// Calls the guard as boards do: only while it does not let steps pass.
std::vector<Put> ask_when_needed(ReversalGuard guard, const std::vector<Wanted>& motion) {
  std::vector<Put> all;
  std::uint32_t since_step = 1000;
  for (const Wanted& w : motion) {
    Put put{w.step != 0, guard.back(), 0, false};
    const bool passes = w.heading == 0 ? guard.settled() : guard.passes(w.heading < 0);
    if (!passes) {
      if (guard.settled()) guard.wake(since_step);
      if (w.heading != 0) guard.head(w.heading < 0);
      put.step = guard.tick(w.step);
      put = {put.step, guard.back(), guard.owed(), true};
    }
    all.push_back(put);
    since_step = put.step ? 1 : since_step + 1;
  }
  return all;
}

/// Checks set-up and hold time at every change of direction, the time between two steps, and that
/// no step is lost or doubled.
void expect_guarded(const std::vector<Wanted>& motion, const std::vector<Put>& out,
                    const DirectionTimes& times) {
  std::int64_t wanted = 0, put = 0, last_step = -1000, last_turn = -1000;
  bool back = false;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto tick = static_cast<std::int64_t>(i);
    if (out[i].back != back) {
      ASSERT_GE(tick - last_step, int{times.hold_ticks}) << i;
      last_turn = tick;
      back = out[i].back;
    }
    wanted += motion[i].step;
    if (out[i].step) {
      ASSERT_GE(tick - last_turn, int{times.setup_ticks}) << i;
      ASSERT_GE(tick - last_step, int{times.period_ticks}) << i;
      put += back ? -1 : 1;
      last_step = tick;
    }
    ASSERT_EQ(wanted - put, out[i].owed) << i;
  }
}

DirectionTimes random_times(std::mt19937_64& random) {
  const auto pick = [&random] { return static_cast<std::uint8_t>(1 + random() % 25); };
  return {pick(), pick()};
}

/// The same, with a time between two steps.
DirectionTimes random_times_and_period(std::mt19937_64& random) {
  DirectionTimes times = random_times(random);
  const int most = times.setup_ticks + times.hold_ticks;
  times.period_ticks = static_cast<std::uint8_t>(1 + random() % static_cast<unsigned>(most));
  return times;
}

/// Highest rate that leaves the times between steps.
double max_rate(const DirectionTimes& times) { return 0.95 / times.period_ticks; }

TEST(ReversalGuard, KeepsSetUpAndHoldAndLosesNoStep) {
  std::mt19937_64 random(1);
  std::size_t waited = 0;
  for (int run = 0; run < test::scaled(300); ++run) {
    const DirectionTimes times = random_times_and_period(random);
    ReversalGuard guard;
    guard.set_times(times);
    guard.begin(false);
    const std::vector<Wanted> motion = random_motion(random, max_rate(times), run % 2 == 0);
    const std::vector<Put> out = ask_when_needed(guard, motion);
    ASSERT_NO_FATAL_FAILURE(expect_guarded(motion, out, times)) << "run " << run;
    waited += static_cast<std::size_t>(
        std::count_if(out.begin(), out.end(), [](const Put& put) { return put.owed != 0; }));
  }
  EXPECT_GT(waited, static_cast<std::size_t>(test::scaled(300)) * 10);
}

/// Boards divide motion at any tick and call the guard only where it is necessary.
TEST(ReversalGuard, GivesTheSameTicksWhetherCalledAlwaysOrWhenNeeded) {
  std::mt19937_64 random(2);
  for (int run = 0; run < test::scaled(300); ++run) {
    ReversalGuard guard;
    const DirectionTimes times = random_times_and_period(random);
    guard.set_times(times);
    guard.begin(random() % 2 == 0);
    const std::vector<Wanted> motion = random_motion(random, max_rate(times), run % 2 == 0);
    const std::vector<Put> always = ask_always(guard, motion);
    const std::vector<Put> needed = ask_when_needed(guard, motion);
    for (std::size_t i = 0; i < motion.size(); ++i) {
      ASSERT_EQ(needed[i].step, always[i].step) << "run " << run << " tick " << i;
      ASSERT_EQ(needed[i].back, always[i].back) << "run " << run << " tick " << i;
      ASSERT_EQ(needed[i].owed, always[i].owed) << "run " << run << " tick " << i;
    }
  }
}

/// After its last reversal an axis at less than half a step per tick catches up within the guard
/// time plus as many ticks as it can lag in that time; then it steps as Bresenham does. A reversal
/// during a guard waits for the rest of that guard first: DIR may change twice.
TEST(ReversalGuard, IsOverAfterItsTime) {
  std::mt19937_64 random(3);
  std::size_t outside = 0;
  for (int run = 0; run < test::scaled(300); ++run) {
    const DirectionTimes times = random_times(random);
    const int guard_ticks = times.setup_ticks + times.hold_ticks;
    ReversalGuard guard;
    guard.set_times(times);
    guard.begin(false);
    const std::vector<Wanted> motion = random_motion(random, 0.5, run % 2 == 0);
    const std::vector<Put> out = ask_when_needed(guard, motion);
    int heading = 0;
    std::int64_t over = 0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const auto tick = static_cast<std::int64_t>(i);
      if (motion[i].heading != 0 && motion[i].heading != heading) {
        heading = motion[i].heading;
        const std::int64_t lag = i == 0 ? 0 : std::abs(out[i - 1].owed);
        const int guards = i != 0 && out[i - 1].asked ? 2 : 1;
        over = std::max(over, tick + 2 * (guards * guard_ticks + lag) + 4);
      }
      if (tick < over) continue;
      ++outside;
      ASSERT_FALSE(out[i].asked) << "run " << run << " tick " << i;
      ASSERT_EQ(out[i].step, motion[i].step != 0);
      if (out[i].step) {
        ASSERT_EQ(out[i].back, motion[i].step < 0);
      }
    }
  }
  EXPECT_GT(outside, static_cast<std::size_t>(test::scaled(300)) * 500);
}

/// A machine reverses with a finite acceleration: 50 m/s2 at 1000 steps/mm is 5e-5 steps per tick
/// squared. The axis lags by at most one step and catches up before its next step.
TEST(ReversalGuard, OwesOneStepAtASmoothReversal) {
  std::mt19937_64 random(4);
  int owed = 0;
  for (int run = 0; run < test::scaled(2000); ++run) {
    const DirectionTimes times = random_times(random);
    ReversalGuard guard;
    guard.set_times(times);
    guard.begin(false);
    std::vector<Wanted> motion;
    const auto accel = static_cast<std::int64_t>(5e-5 * 0x1p62);
    std::int64_t rate = 400 * accel;
    Int128 position{0, random()};
    for (int i = 0; i < 800; ++i, rate -= accel) {
      const std::int64_t before = position.hi();
      position = position + (Int128::product(rate, 1) << 2);
      motion.push_back({static_cast<std::int32_t>(position.hi() - before), rate == 0  ? 0
                                                                           : rate < 0 ? -1
                                                                                      : 1});
    }
    const std::vector<Put> out = ask_when_needed(guard, motion);
    ASSERT_NO_FATAL_FAILURE(expect_guarded(motion, out, times)) << "run " << run;
    const auto ticks_owed =
        std::count_if(out.begin(), out.end(), [](const Put& put) { return put.owed != 0; });
    ASSERT_LE(ticks_owed, times.setup_ticks + times.hold_ticks);
    for (const Put& put : out) ASSERT_LE(std::abs(put.owed), 1);
    owed += ticks_owed != 0 ? 1 : 0;
  }
  EXPECT_GT(owed, 0) << "no reversal just after a step";
}

TEST(ReversalGuard, ConvertsTheSettingsToTheShortestTicks) {
  using settings::Id;
  settings::Values values;
  EXPECT_EQ(pulse_output(values).times.setup_ticks, 1);
  EXPECT_EQ(pulse_output(values).times.hold_ticks, 1);
  for (const Id id : {Id::direction_setup, Id::direction_hold}) {
    for (std::int32_t ns = settings::range(id).min_milli; ns <= settings::range(id).max_milli;
         ns += 10) {
      ASSERT_TRUE(values.set_milli(id, ns));
      const DirectionTimes times = pulse_output(values).times;
      const std::uint32_t ticks = id == Id::direction_setup ? times.setup_ticks : times.hold_ticks;
      ASSERT_GE(ticks * min_tick_ns, static_cast<std::uint32_t>(ns));
      ASSERT_LT((ticks - 1) * min_tick_ns, static_cast<std::uint32_t>(ns));
    }
  }
}

TEST(PulseOutput, TakesModesAndPolarityOfEveryAxis) {
  using settings::Id;
  settings::Values values;
  ASSERT_TRUE(values.set_milli(Id::step_invert, 0b0101 * 1000));
  ASSERT_TRUE(values.set_milli(Id::direction_invert, 0b1100 * 1000));
  for (int axis = 0; axis < max_axes; ++axis)
    ASSERT_TRUE(values.set_milli(settings::for_axis(Id::pulse_mode_x, axis), axis % 3 * 1000));
  const PulseOutput output = pulse_output(values);
  for (int axis = 0; axis < max_axes; ++axis) {
    const AxisPulses& pulses = output.axis[index(axis)];
    EXPECT_EQ(static_cast<int>(pulses.mode), axis % 3);
    EXPECT_EQ(pulses.first_inverted, axis == 0 || axis == 2);
    EXPECT_EQ(pulses.second_inverted, axis == 2 || axis == 3);
  }
}

}  // namespace
}  // namespace lamplock::stepper
