// The limits of a plan and those of its brake are for the same shortest tick.
#include "firmware/machine/runners/window_plan.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "firmware/machine/runners/next_window.hpp"
#include "tests/scale.hpp"

namespace lamplock::machine::window_plan_test {
namespace {

/// A job and its plans, one after the other.
struct Plans {
  motion::PointQueue queue;
  lamp::BeamPath beam;
  RunOptions options;
  WindowPlan plan;
  NextWindow window{queue, beam, options, plan.request()};
  motion::MotionState state;
  bool off_target = true;

  Plans() {
    for (stepper::AxisState& axis : state.axis) axis.position_q64 = stepper::middle_of_step(0);
  }

  void make(const settings::Values& values, const PlanPace& pace) {
    window.fill_request({state.at_rest(), off_target, false});
    motion::PlanRequest& request = plan.request();
    request.queue = &queue;
    request.start = state;
    request.follows = !off_target;
    plan.start(pace);
    while (plan.advance(values, values)) {
    }
  }

  void hand_out() {
    const std::uint32_t count = plan.count();
    state = plan.segment(count - 1).end;
    if (state.at_rest())
      for (stepper::AxisState& axis : state.axis) axis.speed_q62 = 0;
    const Place next = window.place_after(0, count);
    while (queue.begin() != next.point) queue.mark_done(queue.begin());
    window.continue_at(next);
    off_target = false;
  }
};

/// Ways of one beat to some seconds, as slave of a lamp whose expected shortest tick varies.
TEST(WindowPlan, BrakesWithTheLimitsOfItsTicks) {
  settings::Values values;
  values.set_milli(settings::Id::lamp_mode, static_cast<int>(settings::LampMode::slave) * 1000);
  const std::uint32_t beat = beat_ticks(values);
  std::mt19937_64 random(1);
  const auto number = [&](int low, int high) {
    return std::uniform_int_distribution<>(low, high)(random);
  };
  int long_plans = 0, changes = 0;
  for (int job = 0; job < test::scaled(20); ++job) {
    const auto it = std::make_unique<Plans>();
    it->options.points_total = 400;
    it->plan.begin_job(values, beat, 65'000);
    std::uint32_t before = it->plan.min_tick_q16();
    std::int32_t x = 0;
    while (it->window.place().point != it->options.points_total) {
      while (it->queue.free() != 0 && it->queue.end() != it->options.points_total) {
        x = number(0, 9) == 0 ? number(-8000, 8000) : x + number(-2, 2);
        wire::Target target;
        target.steps[0] = x;
        target.shots = 1;
        it->queue.push(target);
      }
      it->window.forget();
      PlanPace pace;
      pace.wanted.tick_q16 = static_cast<std::uint32_t>(65'300 + 50 * number(0, 3));
      pace.long_tick_q16 = static_cast<std::uint32_t>(65'000 + 50 * number(0, 1));
      pace.short_ticks = short_plan_ticks(beat);
      pace.long_ticks = long_plan_ticks(beat);
      pace.may_cut = number(0, 3) != 0;
      it->make(values, pace);
      ASSERT_TRUE(it->plan.found());
      motion::Limits limits;
      std::uint16_t setting = 0;
      const std::uint32_t shortest = it->plan.min_tick_q16();
      ASSERT_EQ(motion::make_limits(values, beat, shortest, limits, setting), Result::ok);
      for (std::size_t a = 0; a < 3; ++a)
        ASSERT_EQ(it->plan.brake_limits().axis[a].accel_q62, limits.axis[a].brake_accel_q62);
      long_plans += shortest < 65'300;
      changes += shortest != before;
      before = shortest;
      it->hand_out();
    }
  }
  EXPECT_GT(long_plans, test::scaled(20));
  EXPECT_GT(changes, test::scaled(20));
}

}  // namespace
}  // namespace lamplock::machine::window_plan_test
