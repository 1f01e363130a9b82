// Profiles, summed tick by tick as in the tick generator.
#include "firmware/motion/profile/profile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/motion/tick_sum.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::profile_test {
namespace {

using test::native;
using test::Native;
using test::to_int128;

constexpr double unit_q62 = 4611686018427387904.0;  // 2^62

/// Furthest distance from v0 to v1 in n ticks at acceleration a, with the speed limited.
double furthest(double v0, double v1, double n, double a, double limit) {
  const double peak = std::min((v0 + v1 + a * n) / 2, limit);
  const double up = (peak - v0) / a, down = (peak - v1) / a;
  return (v0 + peak) / 2 * up + (v1 + peak) / 2 * down + peak * (n - up - down);
}

/// A demand that is feasible with the planning limits, and the true limits.
struct Demand {
  Int128 distance_q62;
  std::int64_t v0_q62 = 0, v1_q62 = 0;
  std::uint32_t ticks = 0;
  std::int64_t plan_speed_q62 = 0, plan_accel_q62 = 0;
  std::int64_t speed_q62 = 0, accel_q62 = 0;
};

/// Random feasible demands: any share of the possible displacements, including the extremes.
Demand random_demand(std::mt19937_64& random, double fewest_ticks, double max_ticks) {
  std::uniform_real_distribution<double> unit(0, 1);
  const auto log_uniform = [&](double lo, double hi) {
    return lo * std::pow(hi / lo, unit(random));
  };
  Demand d;
  const double beat = log_uniform(fewest_ticks, max_ticks);
  const auto beats = static_cast<std::uint32_t>(1 + random() % 4);
  const auto beat_ticks = static_cast<std::uint32_t>(beat / beats) + 100;
  d.ticks = beats * beat_ticks;
  const double n = d.ticks;
  const double speed = log_uniform(1e-4, 0.98);
  const double accel = std::max(speed * log_uniform(0.2, 20) / n, 1e-11);
  d.speed_q62 = static_cast<std::int64_t>(speed * unit_q62);
  d.accel_q62 = static_cast<std::int64_t>(accel * unit_q62);
  // The reserve left by Limits.
  const double plan_accel = accel * (1 - 1.1 / beat_ticks) - 2 / unit_q62;
  const double plan_speed = speed * (1 - 5.0 / beat_ticks) - 2 / unit_q62;
  d.plan_speed_q62 = static_cast<std::int64_t>(plan_speed * unit_q62);
  d.plan_accel_q62 = static_cast<std::int64_t>(plan_accel * unit_q62);
  double v0 = (2 * unit(random) - 1) * plan_speed;
  if (random() % 6 == 0) v0 = 0;
  double v1 = std::clamp(v0 + (2 * unit(random) - 1) * plan_accel * n, -plan_speed, plan_speed);
  if (random() % 6 == 0 && std::fabs(v0) < plan_accel * n) v1 = 0;
  if (random() % 8 == 0) v1 = v0;
  const double high = furthest(v0, v1, n, plan_accel, plan_speed);
  const double low = -furthest(-v0, -v1, n, plan_accel, plan_speed);
  double part = unit(random);
  if (random() % 4 == 0) part = random() % 2 == 0 ? 1e-9 : 1 - 1e-9;
  const double way = low + (high - low) * part;
  d.v0_q62 = static_cast<std::int64_t>(v0 * unit_q62);
  d.v1_q62 = static_cast<std::int64_t>(v1 * unit_q62);
  d.distance_q62 = to_int128(static_cast<Native>(way * unit_q62));
  return d;
}

AxisProfile profile_of(const Demand& d) {
  return make_profile(d.distance_q62, d.v0_q62, d.v1_q62, d.ticks, d.plan_speed_q62);
}

testing::Message text(const Demand& d) {
  return testing::Message() << "distance {" << d.distance_q62.hi() << ", " << d.distance_q62.lo()
                            << "} v0 " << d.v0_q62 << " v1 " << d.v1_q62 << " ticks " << d.ticks
                            << " speed " << d.plan_speed_q62 << " of " << d.speed_q62 << " accel "
                            << d.plan_accel_q62 << " of " << d.accel_q62;
}

TEST(Profile, KeepsEveryLimitAtEveryTick) {
  std::mt19937_64 random(31);
  int refused = 0;
  for (int i = 0; i < test::scaled(10'000); ++i) {
    const Demand d = random_demand(random, 100, 20'000);
    const AxisProfile p = profile_of(d);
    ASSERT_EQ(p.ticks(), d.ticks) << text(d);
    const test::TickSum sum = test::sum_ticks(p);
    ASSERT_LE(sum.max_speed_q62, d.speed_q62) << text(d);
    ASSERT_EQ(within_limits(p, d.speed_q62, d.accel_q62), sum.max_accel_q62 <= d.accel_q62)
        << text(d);
    if (sum.max_accel_q62 > d.accel_q62) ++refused;
    // The closed form equals the sum of the ticks, and excursions equal the visited range.
    ASSERT_EQ(native(displacement_q62(p)), sum.end_q62) << text(d);
    const Excursion e = excursion(p);
    ASSERT_EQ(native(e.low_q62), sum.min_q62) << text(d);
    ASSERT_EQ(native(e.high_q62), sum.max_q62) << text(d);
    ASSERT_EQ(sum.sign_changes_outside_turns, 0) << text(d);
  }
  // A ramp of a few ticks at both limits at once can be too coarse, some times in a million; this
  // is detected, and the planner finds another solution.
  EXPECT_LE(refused, 1 + test::scaled(10'000) / 50'000);
}

TEST(Profile, EndsAtTheRequestedPlaceAndSpeed) {
  std::mt19937_64 random(32);
  double worst = 0;
  for (int i = 0; i < test::scaled(50'000); ++i) {
    const Demand d = random_demand(random, 100, 100'000);
    const AxisProfile p = profile_of(d);
    ASSERT_EQ(p.speed_q62, d.v0_q62);
    const double error =
        std::fabs(static_cast<double>(native(displacement_q62(p) - d.distance_q62)) / unit_q62);
    worst = std::max(worst, error);
    ASSERT_LT(error, 1e-6) << text(d);
    // Accelerations are whole even numbers of 2^-62: the last tick may be off by two per tick.
    ASSERT_LE(std::llabs(p.end_speed_q62() - d.v1_q62), 2LL * p.tail_ticks) << text(d);
  }
  testing::Test::RecordProperty("worst_end_error_steps", std::to_string(worst));
}

TEST(Profile, CruisesAtThePlanningSpeedWhereATriangleWouldExceedIt) {
  constexpr std::int64_t speed = one_q62 / 10;
  constexpr std::uint32_t ticks = 10'000;
  const AxisProfile p = make_profile(Int128::product(speed, ticks * 9 / 10), 0, 0, ticks, speed);
  EXPECT_GT(p.cruise_ticks, ticks / 2);
  EXPECT_LE(p.cruise_speed_q62(), speed + speed / 1000);
  EXPECT_GE(p.cruise_speed_q62(), speed - speed / 1000);
}

TEST(Profile, PeakAccelerationIsTheMinimum) {
  std::mt19937_64 random(33);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    Demand d = random_demand(random, 500, 20'000);
    const AxisProfile p = profile_of(d);
    if (p.cruise_ticks != 0) continue;
    const double t = d.ticks, v0 = static_cast<double>(d.v0_q62),
                 v1 = static_cast<double>(d.v1_q62);
    const double e = static_cast<double>(native(d.distance_q62)) - (v0 + v1) * t / 2, w = v1 - v0;
    const double least = (2 * std::fabs(e) + std::sqrt(4 * e * e + w * w * t * t)) / (t * t);
    const auto peak =
        static_cast<double>(std::max(abs64(p.lead_accel_q62), abs64(p.tail_accel_q62)));
    ASSERT_LE(peak, least * (1 + 1.1 / t) + 8) << text(d);
  }
}

TEST(Profile, DetectsABrokenLimit) {
  std::mt19937_64 random(34);
  for (int i = 0; i < test::scaled(1'000); ++i) {
    const Demand d = random_demand(random, 100, 2'000);
    const AxisProfile p = profile_of(d);
    const test::TickSum sum = test::sum_ticks(p);
    if (sum.max_accel_q62 == 0) continue;
    EXPECT_TRUE(within_limits(p, sum.max_speed_q62, sum.max_accel_q62));
    EXPECT_FALSE(within_limits(p, sum.max_speed_q62 - 1, sum.max_accel_q62));
    EXPECT_FALSE(within_limits(p, sum.max_speed_q62, sum.max_accel_q62 - 1));
  }
}

TEST(Brake, EndsAtRestAndKeepsTheLimit) {
  std::mt19937_64 random(35);
  for (int i = 0; i < test::scaled(5'000); ++i) {
    const Demand d = random_demand(random, 100, 5'000);
    const std::uint32_t least = braking_ticks(d.v0_q62, d.plan_accel_q62);
    const std::uint32_t ticks = least + static_cast<std::uint32_t>(random() % 50);
    const AxisProfile p = make_brake(d.v0_q62, d.plan_accel_q62, ticks);
    const test::TickSum sum = test::sum_ticks(p);
    ASSERT_LE(sum.max_accel_q62, d.accel_q62) << text(d);
    ASSERT_LE(sum.max_speed_q62, abs64(d.v0_q62)) << text(d);
    ASSERT_LE(abs64(p.end_speed_q62()), 2LL * least) << text(d);
    ASSERT_EQ(native(displacement_q62(p)), sum.end_q62);
    // Distance of a steady deceleration over whole ticks, the last of which may be half wasted.
    const double v = static_cast<double>(d.v0_q62) / unit_q62;
    const double way = v * std::fabs(v) / 2 / (static_cast<double>(d.plan_accel_q62) / unit_q62);
    const double end = static_cast<double>(sum.end_q62) / unit_q62;
    ASSERT_GE(std::fabs(end), std::fabs(way) * (1 - 1e-9) - 1e-9) << text(d);
    ASSERT_LE(std::fabs(end), std::fabs(way) + std::fabs(v) / 2 + 1e-9) << text(d);
  }
}

}  // namespace
}  // namespace lamplock::motion::profile_test
