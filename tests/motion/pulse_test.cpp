// Jerk pulses: phases whose acceleration rises and falls in stairs, tick by tick.
#include "firmware/motion/profile/pulse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "tests/motion/jerk_watch.hpp"
#include "tests/motion/plan_checks.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::pulse_test {
namespace {

using test::Chain;
using test::ChainPlan;
using test::Fault;
using test::native;

constexpr double unit_q62 = 4611686018427387904.0;  // 2^62

/// Three phases with random lengths, speeds and distance.
struct Phases {
  Int128 distance_q62;
  std::int64_t v0_q62 = 0, v1_q62 = 0;
  std::uint32_t lead = 0, cruise = 0, tail = 0;
};

Phases random_phases(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto ticks = [&] { return static_cast<std::uint32_t>(std::exp(4 + 2.5 * unit(random))); };
  Phases p;
  const double speed = 0.4 * std::exp(4 * unit(random) - 4);
  p.v0_q62 = random() % 6 == 0 ? 0 : static_cast<std::int64_t>(speed * unit(random) * unit_q62);
  p.v1_q62 = random() % 6 == 0 ? 0 : static_cast<std::int64_t>(speed * unit(random) * unit_q62);
  p.lead = 1 + ticks();
  p.cruise = random() % 3 == 0 ? 0 : ticks();
  p.tail = 1 + ticks();
  const auto way = static_cast<std::int64_t>(speed * unit(random) * unit_q62);
  p.distance_q62 = Int128::product(way, p.lead + p.cruise + p.tail);
  return p;
}

AxisProfile without_ramps(const Phases& p) {
  return make_phases(p.distance_q62, p.v0_q62, p.v1_q62, p.lead, p.cruise, p.tail);
}

/// A jerk at which the longer phases have room for pulses and the shorter ones do not.
AxisLimits jerk_for(const AxisProfile& p, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double lead = static_cast<double>(abs64(p.lead_accel_q62)) / p.lead_ticks;
  const double tail = static_cast<double>(abs64(p.tail_accel_q62)) / p.tail_ticks;
  AxisLimits axis;
  const double jerk =
      65536 * std::min(1e13, std::max(lead, tail)) * 3 * std::pow(300, unit(random));
  axis.jerk_q78 = 1 + static_cast<std::int64_t>(std::min(jerk, 9e18));
  return axis;
}

TEST(Pulse, ChangesSpeedAndPositionLikeConstantAcceleration) {
  std::mt19937_64 random(71);
  int fitting = 0;
  for (int i = 0; i < test::scaled(20'000); ++i) {
    SCOPED_TRACE(i);
    const Phases phases = random_phases(random);
    const AxisProfile flat = without_ramps(phases);
    AxisProfile p = flat;
    const AxisLimits axis = jerk_for(flat, random);
    if (!make_pulses(p, phases.v1_q62, axis.jerk_q78)) continue;
    ++fitting;
    ASSERT_TRUE(keeps_jerk(p, axis.jerk_q78));
    // Accelerations are rounded to units that make every stair exact; this is the error per phase.
    const auto unit = static_cast<double>(stepper::pulse_accel_unit);
    const double n = p.ticks();
    ASSERT_LE(std::fabs(static_cast<double>(p.cruise_speed_q62() - flat.cruise_speed_q62())),
              unit * p.lead_ticks);
    ASSERT_LE(std::fabs(static_cast<double>(p.end_speed_q62() - phases.v1_q62)),
              unit * p.tail_ticks);
    ASSERT_LE(std::fabs(static_cast<double>(native(displacement_q62(p) - displacement_q62(flat)))),
              unit * n * n);
  }
  EXPECT_GT(fitting, test::scaled(20'000) / 8);
}

TEST(Pulse, EqualsTheSumOfItsTicks) {
  std::mt19937_64 random(72);
  for (int i = 0; i < test::scaled(10'000); ++i) {
    SCOPED_TRACE(i);
    const Phases phases = random_phases(random);
    AxisProfile p = without_ramps(phases);
    const AxisLimits axis = jerk_for(p, random);
    const bool fits = make_pulses(p, phases.v1_q62, axis.jerk_q78);
    ASSERT_EQ(fits, keeps_jerk(p, axis.jerk_q78));
    const test::TickSum sum = test::sum_ticks(p);
    ASSERT_EQ(native(displacement_q62(p)), sum.end_q62);
    const Excursion e = excursion(p);
    ASSERT_EQ(native(e.low_q62), sum.min_q62);
    ASSERT_EQ(native(e.high_q62), sum.max_q62);
    ASSERT_EQ(sum.sign_changes_outside_turns, 0);
    if (!fits) continue;
    ASSERT_LE(sum.max_accel_q62, std::max(abs64(p.lead_accel_q62), abs64(p.tail_accel_q62)));
    test::JerkWatch watch(axis);
    watch.allow_stairs(p);
    watch.tick(0);
    test::for_each_tick(p,
                        [&](test::Native, std::int64_t, std::int64_t accel) { watch.tick(accel); });
    watch.tick(0);
    ASSERT_FALSE(watch.broken()) << watch.worst() << " stairs";
  }
}

/// Checks straight ramps from zero to the acceleration and back, through the middle of every stair.
TEST(Pulse, StairsApproximateStraightRamps) {
  std::mt19937_64 random(79);
  for (int i = 0; i < test::scaled(2'000); ++i) {
    SCOPED_TRACE(i);
    const auto n = static_cast<std::uint32_t>(random() % 200'000 + 8);
    const auto ramp = static_cast<std::uint8_t>(
        random() % 4 == 0 ? stepper::falling_ramp : 1 + random() % stepper::max_ramp);
    const auto accel =
        (static_cast<std::int64_t>(random() % (1u << 30)) - (1 << 29)) * stepper::pulse_accel_unit;
    const bool falls = ramp == stepper::falling_ramp;
    const std::uint32_t r = stepper::ramp_of(n, ramp).ticks();
    std::uint32_t at = 0;
    stepper::Stair stair;
    for (std::uint32_t k = stepper::first_stair(ramp);
         stepper::next_stair(accel, n, ramp, k, stair); at += stair.ticks, ++k) {
      if (stair.ticks == 0) continue;
      const auto left = static_cast<std::uint32_t>(random() % (stair.ticks + 1));
      const std::uint32_t t = at + stair.ticks - left;
      const double up = falls ? 1 : static_cast<double>(t) / r;
      const double down = (falls ? r - static_cast<double>(t) : static_cast<double>(n) - t) / r;
      const double straight = static_cast<double>(accel) * std::min({1.0, up, down});
      const std::int64_t is = stepper::straight_ramp_q62(accel, n, ramp, k, left);
      ASSERT_NEAR(static_cast<double>(is), straight, 2) << "stair " << k << ", " << left;
      if (stair.ticks % 2 == 0) {
        ASSERT_EQ(stepper::straight_ramp_q62(accel, n, ramp, k, stair.ticks / 2), stair.accel_q62);
      }
    }
  }
}

TEST(Pulse, IsRefusedIfNoRampIsLongEnough) {
  // n^2 J / 4 is the maximum: slightly less fits, slightly more does not.
  std::mt19937_64 random(73);
  for (int i = 0; i < test::scaled(2'000); ++i) {
    const auto n = static_cast<std::uint32_t>(4096 + random() % 100'000);
    const std::int64_t jerk_q78 = std::int64_t{1} << (40 + random() % 6);
    const auto most = static_cast<std::int64_t>(static_cast<double>(jerk_q78) / 65536 * n *
                                                static_cast<double>(n) / 4);
    for (const double part : {0.99, 1.01}) {
      const auto change = static_cast<std::int64_t>(part * static_cast<double>(most));
      AxisProfile p;
      p.lead_ticks = n;
      p.lead_accel_q62 = change / static_cast<std::int64_t>(n) & ~std::int64_t{1};
      const std::int64_t v1 = p.cruise_speed_q62();
      ASSERT_EQ(make_pulses(p, v1, jerk_q78), part < 1) << n;
    }
  }
}

/// Brakes from a state of an axis and checks the limits.
TEST(Pulse, BrakesFromAnyStateWithinTheJerkLimit) {
  std::mt19937_64 random(74);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < test::scaled(2'000); ++i) {
    SCOPED_TRACE(i);
    Chain chain = test::random_chain(random, 2);
    test::limit_jerk(chain, random);
    stepper::MotionState from;
    Accelerations accel{};
    for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a) {
      const AxisLimits& axis = chain.limits.axis[a];
      from.axis[a].speed_q62 =
          static_cast<std::int64_t>(unit(random) * std::exp(-6 * std::fabs(unit(random))) *
                                    static_cast<double>(axis.plan_speed_q62));
      // Not more than a ramp of planned motion: it changes the speed by less than the limit.
      const double jerk = std::max(1.0, static_cast<double>(axis.jerk_q78) / 65536);
      const double most = std::min(static_cast<double>(axis.accel_q62),
                                   std::sqrt(2 * jerk * static_cast<double>(axis.speed_q62)));
      accel[a] =
          static_cast<std::int64_t>(unit(random) * std::exp(-6 * std::fabs(unit(random))) * most);
      if (axis.jerk_q78 == 0) accel[a] = 0;
      if (random() % 4 == 0) accel[a] = 0;
      if (random() % 8 == 0) from.axis[a].speed_q62 = 0;
    }
    const Segment s = make_brake(from, chain.limits, accel);
    ASSERT_TRUE(s.end.at_rest());
    for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a) {
      const AxisLimits& axis = chain.limits.axis[a];
      const AxisProfile& p = s.axis[a];
      ASSERT_LE(p.ticks(), s.ticks);
      ASSERT_LE(abs64(p.end_speed_q62()), stepper::pulse_accel_unit * std::int64_t{s.ticks});
      ASSERT_EQ(s.end.axis[a].position_q64, displacement_q62(p) << 2);
      ASSERT_LE(abs64(p.lead_accel_q62), axis.accel_q62);
      ASSERT_LE(abs64(p.tail_accel_q62), axis.accel_q62);
      if (axis.jerk_q78 == 0 || p.ticks() > 300'000) continue;
      const test::TickSum sum = test::sum_ticks(p);
      ASSERT_EQ(native(displacement_q62(p)), sum.end_q62);
      ASSERT_EQ(sum.sign_changes_outside_turns, 0);
      ASSERT_LE(sum.max_accel_q62, axis.accel_q62);
      test::JerkWatch watch(axis);
      watch.allow_stairs(p);
      const auto begin = static_cast<double>(accel[a]);
      watch.start(begin);
      test::for_each_tick(p,
                          [&](test::Native, std::int64_t, std::int64_t now) { watch.tick(now); });
      watch.tick(0);
      ASSERT_FALSE(watch.broken()) << "axis " << a << ": " << watch.worst() << " stairs";
    }
  }
}

/// Checks a plan that cannot continue from its speed: everything before that point, and the brake
/// that follows. The machine then continues from rest (docs/planning.md, 6a).
Fault fault_of_stop(const Chain& chain, const ChainPlan& plan) {
  stepper::MotionState from = test::rest_at_zero();
  for (std::uint32_t i = 0; i < plan.segments.size(); ++i) {
    const Segment& s = plan.segments[i];
    if (const Fault fault = test::segment_fault(chain, from, s, plan.beats[i], i)) return fault;
    from = s.end;
  }
  if (!stays_inside(make_brake(from, chain.limits), from, chain.limits))
    return {"the brake leaves the work space", static_cast<std::uint32_t>(plan.segments.size())};
  return {};
}

/// Checks every property of a plan with jerk: analytically, for some plans also tick by tick.
Fault fault_of(std::uint64_t number, Planner& planner, bool every_tick, int& stopped) {
  std::mt19937_64 random(number * 0x9e3779b97f4a7c15u + 7500);
  Chain chain = test::random_chain(random, 3 + random() % 60);
  if (random() % 8 == 0) chain.mode = wire::JoinMode::start_stop;
  test::limit_jerk(chain, random);
  ChainPlan plan;
  Fault fault = test::chain_fault(chain, planner, plan);
  if (plan.result != Result::ok && !plan.segments.empty() && !plan.segments.back().end.at_rest()) {
    ++stopped;
    return fault_of_stop(chain, plan);
  }
  if (fault || !every_tick) return fault;
  return test::ticks_fault(chain.limits, plan.segments, 1'000'000);
}

TEST(Pulse, ChainsKeepEveryLimitAndCanAlwaysStop) {
  const auto planner = std::make_unique<Planner>();
  const auto chains = static_cast<std::uint64_t>(test::scaled(1'000));
  int stopped = 0;
  for (std::uint64_t number = 0; number < chains; ++number)
    ASSERT_EQ(fault_of(number, *planner, number % 10 == 0, stopped), Fault{}) << "chain " << number;
  EXPECT_LE(stopped, static_cast<int>(chains / 2000));
}

}  // namespace
}  // namespace lamplock::motion::pulse_test
