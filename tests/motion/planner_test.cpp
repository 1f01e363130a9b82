// The planner on random chains: properties of every plan.
#include "firmware/motion/free/planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/motion/profile/profile.hpp"
#include "tests/motion/plan_checks.hpp"
#include "tests/motion/same_plan.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;
using test::ChainPlan;
using test::in_work_space;

/// Resting at every point is one of the solutions; at kilohertz beats the online search may miss it
/// slightly, since the board has time for only a part of the search.
TEST(Planner, IsHardlyEverSlowerThanFromRestToRest) {
  Planner planner;
  long all_free = 0, all_start_stop = 0;
  int slower = 0;
  for (int i = 0; i < test::scaled(150); ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 4100);
    Chain chain = test::random_chain(random, 100);
    const ChainPlan free = test::plan_chain(chain, planner);
    chain.mode = wire::JoinMode::start_stop;
    const ChainPlan start_stop = test::plan_chain(chain, planner);
    for (const ChainPlan* plan : {&free, &start_stop}) ASSERT_EQ(plan->result, Result::ok);
    for (const Segment& s : start_stop.segments) ASSERT_TRUE(s.end.at_rest());
    const auto beats = static_cast<double>(start_stop.total_beats()),
               free_beats = static_cast<double>(free.total_beats());
    if (free_beats > beats * 1.01 + 1) ++slower;
    ASSERT_LE(free_beats, beats * 1.02 + 1);
    all_free += free.total_beats();
    all_start_stop += start_stop.total_beats();
  }
  EXPECT_LE(slower, test::scaled(150) / 1000);
  EXPECT_LT(static_cast<double>(all_free), 0.9 * static_cast<double>(all_start_stop));
}

TEST(Planner, SoftLimitsMatterInTheseChains) {
  // The work space of random chains is the bounding box of their points. Plans without it must
  // often leave it; otherwise ManyChains would not test it.
  Planner planner;
  int outside = 0;
  for (int i = 0; i < 40; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 4100);
    Chain chain = test::random_chain(random, 100);
    const Chain tight = chain;
    test::open_work_space(chain);
    const ChainPlan plan = test::plan_chain(chain, planner);
    MotionState from = test::rest_at_zero();
    for (const Segment& s : plan.segments) {
      for (int a = 0; a < chain.limits.axes; ++a) {
        const Excursion e = excursion(s.axis[index(a)]);
        const Int128 start = from.axis[index(a)].position_q64;
        outside += in_work_space(tight.limits.axis[index(a)], start, e) ? 0 : 1;
      }
      from = s.end;
    }
  }
  EXPECT_GT(outside, 20);
}

TEST(Planner, FixedBeatsAreKept) {
  // The beats of a plan are possible: if they are fixed, they must be kept, even where they were
  // free before.
  Planner planner;
  for (int i = 0; i < test::scaled(40); ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 4200);
    Chain chain = test::random_chain(random, 14);
    test::open_work_space(chain);  // fixed beats leave no alternative to crossing a soft limit
    const ChainPlan plan = test::plan_chain(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    for (std::size_t k = 0; k < chain.targets.size(); ++k)
      chain.targets[k].beats = static_cast<std::uint16_t>(plan.beats[k]);
    const ChainPlan ordered = test::plan_chain(chain, planner);
    long ticks_to_sum = 0;
    ASSERT_EQ(test::plan_fault(chain, ordered, ticks_to_sum), test::Fault{});
  }
}

TEST(Planner, ImpossibleFixedBeatsAreRefusedWithTheirPoint) {
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(100, 4, 0.1, 2, 200));
  chain.limits.axis[0].min_steps = chain.limits.axis[1].min_steps = -1'000'000;
  for (int i = 0; i < 5; ++i) {
    wire::Target t;
    t.steps[0] = 20 * (i + 1);
    chain.targets.push_back(t);
  }
  chain.targets[3].steps[0] = 100'000;  // 500 mm away
  for (std::size_t i = 4; i < 5; ++i) chain.targets[i].steps[0] = 100'020;
  chain.targets[3].beats = 2;  // 500 are needed at 0.1 m/s
  Planner planner;
  const test::WholeRequest whole(chain);
  std::uint32_t failed = 99;
  EXPECT_EQ(planner.plan(whole.request, failed), Result::unreachable);
  EXPECT_EQ(failed, 3u);
}

TEST(Planner, NeverExceedsTheRangeOfItsNumbers) {
  // Slow machines, large spaces, fast lamps: refused or exact, never wrong.
  std::mt19937_64 random(43);
  Planner planner;
  int refused = 0;
  for (int i = 0; i < test::scaled(2'000); ++i) {
    std::uniform_real_distribution<double> unit(0, 1);
    const auto any = [&](double lo, double hi) { return lo * std::pow(hi / lo, unit(random)); };
    const settings::Values values =
        test::machine_settings(any(1, 5000), any(1e-3, 200), any(2e-5, 4), 1, any(0.5, 5000));
    Limits limits;
    std::uint16_t setting = 0;
    if (make_limits(values, beat_ticks(values), full_tick_q16, limits, setting) != Result::ok)
      continue;
    Chain chain;
    chain.limits = limits;
    wire::Target t;
    t.steps[0] = static_cast<std::int32_t>(any(1, std::max(2, limits.axis[0].max_steps)));
    chain.targets = {t};
    const ChainPlan plan = test::plan_chain(chain, planner);
    if (plan.result != Result::ok) {
      ++refused;
      continue;
    }
    long ticks_to_sum = 0;
    ASSERT_EQ(test::plan_fault(chain, plan, ticks_to_sum), test::Fault{}) << "machine " << i;
  }
  EXPECT_GT(refused, 0);
}

TEST(Planner, DependsOnlyOnThePoints) {
  for (int i = 0; i < test::scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 4400);
    // More than a window and the horizon after it: not all points can be known at once.
    const Chain chain = test::random_chain(random, 2 * (window_points + run_horizon));
    Planner fresh, used;
    test::plan_chain(test::random_chain(random, 50), used);
    const ChainPlan all_at_once = test::plan_chain(chain, fresh);
    const ChainPlan little_by_little =
        test::plan_chain(chain, used, {}, static_cast<std::uint32_t>(1 + random() % 40));
    ASSERT_NO_FATAL_FAILURE(test::expect_same_plan(all_at_once, little_by_little));
  }
}

/// State of an axis n ticks into a profile, position relative to its start.
AxisState state_after(const AxisProfile& p, std::uint32_t n) {
  const std::uint32_t lead = std::min(n, p.lead_ticks);
  const std::uint32_t cruise = std::min(n - lead, p.cruise_ticks);
  const std::uint32_t tail = n - lead - cruise;
  const std::int64_t speed = p.speed_q62 + p.lead_accel_q62 * lead;
  const Int128 way = stepper::displacement_q62(p.speed_q62, p.lead_accel_q62, lead) +
                     stepper::displacement_q62(speed, 0, cruise) +
                     stepper::displacement_q62(speed, p.tail_accel_q62, tail);
  return {way, speed + p.tail_accel_q62 * tail};
}

/// Brakes an axis at several ticks of a profile.
void expect_brake_inside(const AxisLimits& axis, Int128 start, const AxisProfile& p,
                         std::mt19937_64& random) {
  const std::uint32_t every = 1 + p.ticks() / 60;
  for (auto n = static_cast<std::uint32_t>(random() % every); n < p.ticks(); n += every) {
    const AxisState at = state_after(p, n);
    const AxisProfile brake = make_brake(at.speed_q62, axis.plan_accel_q62,
                                         braking_ticks(at.speed_q62, axis.plan_accel_q62));
    const Int128 way = at.position_q64 + stepper::displacement_q62(brake);
    ASSERT_TRUE(in_work_space(axis, start + (way << 2))) << "braking after " << n << " ticks";
  }
}

TEST(Planner, BrakingFromAnyTickStaysInsideTheWorkSpace) {
  Planner planner;
  for (int i = 0; i < test::scaled(100); ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 4500);
    const Chain chain = test::random_chain(random, 60);
    test::plan_chain(chain, planner, [&](const Planner& p, const PlanRequest& request) {
      MotionState from = request.start;
      for (std::uint32_t k = 0; k < request.commits(); ++k) {
        const Segment& s = p.segment(k);
        for (int a = 0; a < chain.limits.axes; ++a) {
          SCOPED_TRACE(testing::Message() << "point " << request.points[k] << " axis " << a);
          ASSERT_NO_FATAL_FAILURE(expect_brake_inside(chain.limits.axis[index(a)],
                                                      from.axis[index(a)].position_q64,
                                                      s.axis[index(a)], random));
        }
        from = s.end;
      }
    });
    if (testing::Test::HasFailure()) return;
  }
}

TEST(Planner, StartStopTakesTheWholeBeatsOfTheClosedForm) {
  Planner planner;
  for (int i = 0; i < test::scaled(100); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 4600);
    Chain chain = test::random_chain(random, 60);
    chain.mode = wire::JoinMode::start_stop;
    const ChainPlan plan = test::plan_chain(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    StepPosition from{};
    for (std::size_t k = 0; k < chain.targets.size(); ++k) {
      // T with the true limits and with those reduced for whole ticks: the beats are between, and
      // are equal except for ties.
      double best = 0, planned = 0;
      for (int a = 0; a < chain.limits.axes; ++a) {
        const AxisLimits& axis = chain.limits.axis[index(a)];
        const double way =
            std::fabs(static_cast<double>(chain.targets[k].steps[index(a)]) - from[index(a)]);
        const auto time = [&](std::int64_t accel_q62, std::int64_t speed_q62) {
          const double accel = std::ldexp(static_cast<double>(accel_q62), -62);
          const double speed = std::ldexp(static_cast<double>(speed_q62), -62);
          return std::sqrt(way * accel) <= speed ? 2 * std::sqrt(way / accel)
                                                 : way / speed + speed / accel;
        };
        best = std::max(best, time(axis.accel_q62, axis.speed_q62));
        planned = std::max(planned, time(axis.plan_accel_q62, axis.plan_speed_q62));
      }
      const double beat = chain.limits.beat_ticks;
      ASSERT_GE(plan.beats[k], std::max(1.0, std::ceil(best / beat * (1 - 1e-9)))) << k;
      ASSERT_LE(plan.beats[k], std::max(1.0, std::ceil(planned / beat * (1 + 1e-6)))) << k;
      from = chain.targets[k].steps;
    }
  }
}

TEST(Planner, LeastBeatsLimitTheRateOfShots) {
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(100, 4, 0.1, 1, 200));
  for (int i = 0; i < 10; ++i) {
    wire::Target t;
    t.steps[0] = i;
    chain.targets.push_back(t);
  }
  tighten_work_space(chain);
  test::WholeRequest whole(chain);
  whole.request.min_beats = 3;
  Planner planner;
  std::uint32_t failed = 0;
  ASSERT_EQ(planner.plan(whole.request, failed), Result::ok);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(planner.beats(i), 3);
  // Shots must not exceed the rate either if the host fixes beats; a move without a shot may.
  chain.targets[4].beats = 2;
  for (const std::uint8_t shots : std::array<std::uint8_t, 2>{1, 0}) {
    chain.targets[4].shots = shots;
    whole.fill(chain);
    EXPECT_EQ(planner.plan(whole.request, failed), shots == 1 ? Result::unreachable : Result::ok);
  }
}

TEST(Planner, RefusesBeatsWhoseTicksExceedASegment) {
  // At 1 Hz 2^31 ticks are 2147 beats: one more is refused, not wrapped.
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(1, 4, 0.1, 1, 200));
  chain.targets.resize(1);
  chain.targets[0].steps[0] = 100;
  for (const std::uint16_t beats : std::array<std::uint16_t, 4>{2147, 2148, 4295, 8192}) {
    chain.targets[0].beats = beats;
    const test::WholeRequest whole(chain);
    Planner planner;
    std::uint32_t failed = 0;
    const Result result = planner.plan(whole.request, failed);
    EXPECT_EQ(result, beats == 2147 ? Result::ok : Result::unreachable) << beats;
    if (result == Result::ok) {
      EXPECT_EQ(planner.segment(0).ticks, 2147u * chain.limits.beat_ticks);
    }
  }
}

TEST(Planner, PointsAlongTheEndsOfTheWorkSpaceAreReached) {
  // At 4 kHz. With windows of 40 points the improver's moves once left boxes here that could not be
  // reproduced, and speeds chosen from the rest of the old ones could not be joined.
  constexpr std::int32_t points[][3] = {
      {-8945, -5181, -9916}, {-8973, -5189, -9901},  {-2849, 865, -9901},   {-2814, 865, -9904},
      {-2787, 851, -9879},   {-2761, 843, -9858},    {-2761, 811, -9864},   {-2748, 811, -9861},
      {-2748, 805, -9830},   {-2732, 788, -9804},    {2409, 769, -9776},    {2383, 737, -9763},
      {-10000, 773, -7439},  {-10000, 744, -7477},   {-10000, 774, -7507},  {-10000, 808, -7500},
      {-9984, 842, -10000},  {-10000, 823, -9992},   {-9999, 839, -10000},  {-10000, 839, -10000},
      {-9999, 874, -10000},  {-9968, 894, -9991},    {-9968, 861, -4762},   {-9968, 833, -4759},
      {-9983, 833, -4798},   {-9983, 795, -4801},    {10000, 764, -4791},   {10000, 750, -4791},
      {9983, 755, -4819},    {9983, 736, -4819},     {-2690, 709, -4836},   {558, 743, -4844},
      {552, 769, -4852},     {562, 788, -4819},      {-10000, 795, 9410},   {-10000, 10000, 9423},
      {-9971, 9985, 9443},   {-9942, 10000, -10000}, {-9942, 10000, -9991}, {10000, 9999, -9953}};
  Chain chain;
  settings::Values values = test::machine_settings(4000, 2, 1, 3, 200);
  for (int a = 0; a < 3; ++a) {
    values.set_milli(settings::for_axis(settings::Id::travel_x, a), 100'000);
    values.set_milli(settings::for_axis(settings::Id::min_corner_x, a), -50'000);
  }
  chain.limits = test::limits_of(values, 65536 / 512 * 509);
  for (const auto& point : points) {
    wire::Target t;
    std::copy(std::begin(point), std::end(point), t.steps.begin());
    chain.targets.push_back(t);
  }
  test::WholeRequest whole(chain);
  PlanRequest& request = whole.request;
  request.count = request.known_end = window_points;
  request.rest_at_end = false;
  const std::int32_t start[] = {-8956, -5188, -9916};
  Planner planner;
  std::uint32_t failed = 0;
  for (std::int32_t off = -20; off <= 20; ++off) {
    for (std::size_t a = 0; a < 3; ++a)
      request.start.axis[a].position_q64 = stepper::middle_of_step(start[a] + off);
    EXPECT_EQ(planner.plan(request, failed), Result::ok) << off << ", place " << failed;
  }
}

}  // namespace
}  // namespace lamplock::motion
