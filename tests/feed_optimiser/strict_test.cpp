// The strict variant keeps the limits of every axis at every step, and ends where it has to.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/feed_optimiser/optimise.hpp"
#include "host/feed_optimiser/time_optimum.hpp"
#include "tests/error_of.hpp"
#include "tests/matchers.hpp"
#include "tests/scale.hpp"

namespace lamplock::feed_optimiser {
namespace {

using test::HasSubstr;

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}
/// Equal probabilities for all orders of magnitude.
double magnitude(Random& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}

Method random_method(Random& random, Variant variant) {
  Method method{variant, {}, magnitude(random, 0.3e-3, 3e-3), {}};
  for (std::size_t a = 0; a < axes; ++a) {
    method.limits.speed_mm_s[a] = magnitude(random, 3, 500);
    method.limits.accel_mm_s2[a] = magnitude(random, 100, 20'000);
    method.limits.jerk_mm_s3[a] = magnitude(random, 2000, 2e6);
  }
  method.law = {uniform(random, 1, 15), uniform(random, 0, 7), uniform(random, 0, 1),
                uniform(random, 0, 0.2)};
  return method;
}

std::vector<Block> random_polyline(Random& random, double size_mm) {
  std::vector<Block> blocks;
  Point at{uniform(random, -100, 100), uniform(random, -100, 100), uniform(random, -10, 10)};
  const int count = std::uniform_int_distribution(1, 8)(random);
  const bool flat = random() % 2 == 0;
  for (int i = 0; i < count; ++i) {
    Point to{at.x + uniform(random, -size_mm, size_mm), at.y + uniform(random, -size_mm, size_mm),
             flat ? at.z : at.z + uniform(random, -size_mm, size_mm)};
    if (random() % 5 == 0) to.y = at.y, to.z = at.z;
    blocks.push_back(straight_block(at, to));
    at = to;
  }
  return blocks;
}

std::array<double, 3> coordinates(const Point& p) { return {p.x, p.y, p.z}; }

/// By differences of four places in a row, at rest before the first and after the last one.
void expect_limits(const std::vector<Point>& path, const Method& method, std::uint64_t seed) {
  std::vector<Point> at(3, path.front());
  at.insert(at.end(), path.begin(), path.end());
  at.insert(at.end(), 3, path.back());
  const double t = method.period_s;
  for (std::size_t i = 3; i < at.size(); ++i)
    for (std::size_t a = 0; a < axes; ++a) {
      const double p0 = coordinates(at[i - 3])[a], p1 = coordinates(at[i - 2])[a],
                   p2 = coordinates(at[i - 1])[a], p3 = coordinates(at[i])[a];
      const double v = (p3 - p2) / t, acc = ((p3 - p2) - (p2 - p1)) / (t * t),
                   j = ((p3 - p2) - 2 * (p2 - p1) + (p1 - p0)) / (t * t * t);
      ASSERT_LE(std::abs(v), method.limits.speed_mm_s[a]) << seed << ' ' << i;
      ASSERT_LE(std::abs(acc), method.limits.accel_mm_s2[a]) << seed << ' ' << i;
      ASSERT_LE(std::abs(j), method.limits.jerk_mm_s3[a]) << seed << ' ' << i;
    }
}

std::vector<Point> whole_path(const std::vector<OptimisedBlock>& blocks) {
  std::vector<Point> path;
  for (const OptimisedBlock& block : blocks) {
    const std::vector<Point> more = places(block);
    path.insert(path.end(), more.begin() + (path.empty() ? 0 : 1), more.end());
  }
  return path;
}

double distance_mm(const Point& a, const Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(Strict, KeepsTheLimitsOnRandomPolylines) {
  const int count = test::scaled(10'000, 200);
  for (int seed = 1; seed <= count; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Method method = random_method(random, Variant::strict);
    const std::vector<Block> given = random_polyline(random, magnitude(random, 0.5, 20));
    const std::vector<Block> blocks = join_straight(given, method);
    std::vector<OptimisedBlock> optimised;
    try {
      optimised = optimise(blocks, method, "random");
    } catch (const Error& error) {
      ASSERT_THAT(error.what(), HasSubstr("less than the control period"));
      continue;
    }
    expect_limits(whole_path(optimised), method, static_cast<std::uint64_t>(seed));
    for (std::size_t i = 0; i < optimised.size(); ++i) {
      const std::vector<Point> at = places(optimised[i]);
      ASSERT_LT(distance_mm(at.back(), blocks[i].to), 1e-9);
      ASSERT_LT(distance_mm(at[at.size() - 2], blocks[i].to), 1e-9) << "not at rest";
    }
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(Strict, TakesLittleMoreThanTheOptimumWithAFastLaw) {
  // A law that is at the limit from the first step on has the shape of the exact optimum.
  Method method{Variant::strict, {100, 10, 0, 0}, 0.1e-3, {}};
  method.limits.speed_mm_s.fill(100);
  method.limits.accel_mm_s2.fill(2000);
  method.limits.jerk_mm_s3.fill(50'000);
  for (const double length_mm : {0.01, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0}) {
    const Block block = straight_block({0, 0, 0}, {length_mm, 0, 0});
    const OptimisedBlock optimised = optimise({{block}}, method, "line").front();
    const double optimum = optimum_s(length_mm, optimised.task.limits);
    EXPECT_GE(optimised.seconds(), optimum * (1 - 1e-6)) << length_mm;
    EXPECT_LE(optimised.seconds(), optimum * 1.01 + 10 * method.period_s) << length_mm;
  }
}

TEST(Strict, JerkGrowsByTheLaw) {
  Method method{Variant::strict, {2, 7, 0, 0.1}, 1e-3, {}};
  method.limits.speed_mm_s.fill(20);
  method.limits.accel_mm_s2.fill(1000);
  method.limits.jerk_mm_s3.fill(10'000);
  const Block block = straight_block({0, 0, 0}, {10, 0, 0});
  const OptimisedBlock optimised = optimise({{block}}, method, "line").front();
  const std::vector<double> jerk = law_values(optimised.profile, *optimised.table);
  const Profile& p = optimised.profile;
  ASSERT_EQ(jerk.size(), p.accelerate + p.hold + p.brake);
  EXPECT_GT(p.rise, 20u);
  for (std::size_t i = 0; i < p.rise; ++i)
    EXPECT_NEAR(jerk[i], p.scale * std::min(std::pow(2, 7 + 0.1 * static_cast<double>(i)), 10'000.),
                0.01)
        << i;
  EXPECT_GT(p.scale, 0.5);
  EXPECT_LE(p.scale, 1);
}

TEST(Strict, KeepsTheLimitsOnArcs) {
  const int count = test::scaled(400, 40);
  for (int seed = 1; seed <= count; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Method method = random_method(random, Variant::strict);
    const double radius = magnitude(random, 0.5, 50), sweep = uniform(random, -6.28, 6.28);
    const double start = uniform(random, 0, 6.28),
                 rise = random() % 2 == 0 ? 0 : uniform(random, -5, 5);
    std::vector<Point> vertices;
    constexpr int chords = 40;
    for (int i = 0; i <= chords; ++i) {
      const double part = static_cast<double>(i) / chords, angle = start + sweep * part;
      vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), rise * part});
    }
    const std::optional<Block> arc = arc_block(vertices);
    ASSERT_TRUE(arc) << seed;
    ASSERT_NEAR(arc->arc->radius_mm, radius, 1e-6);
    ASSERT_NEAR(arc->arc->sweep_rad, sweep, 1e-6);
    const OptimisedBlock optimised = optimise({{*arc}}, method, "arc").front();
    expect_limits(places(optimised), method, static_cast<std::uint64_t>(seed));
    for (const Point& p : places(optimised))
      ASSERT_NEAR(std::hypot(p.x, p.y), radius, 1e-6) << seed;
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(Arcs, AreNotSeenInOtherCurves) {
  std::vector<Point> parabola;
  for (int i = 0; i <= 20; ++i) parabola.push_back({i * 0.5, i * i * 0.05, 0});
  EXPECT_FALSE(arc_block(parabola));
  EXPECT_FALSE(arc_block(std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
}

TEST(JoinedBlocks, KeepTheirDirection) {
  Method method{Variant::strict, {}, 1e-3, {}};
  method.limits.speed_mm_s.fill(20);
  method.limits.accel_mm_s2.fill(1000);
  method.limits.jerk_mm_s3.fill(10'000);
  const Point a{0, 0, 0}, b{1, 2, 0}, c{2, 4, 0}, d{1, 2, 0}, e{1, 2, 1};
  const std::vector<Block> joined =
      join_straight({{straight_block(a, b), straight_block(b, c), straight_block(c, c),
                      straight_block(c, d), straight_block(d, e)}},
                    method);
  ASSERT_EQ(joined.size(), 3u);
  EXPECT_EQ(joined[0].to, c);
  EXPECT_EQ(joined[1].to, d);
  EXPECT_EQ(joined[2].to, e);
}

TEST(JoinedBlocks, StayOnThePathWhateverTheLimits) {
  Random random(21);
  for (int seed = 0; seed < test::scaled(200, 40); ++seed) {
    Method method{Variant::strict, {}, 2e-3, {}};
    method.limits.speed_mm_s.fill(20);
    method.limits.accel_mm_s2.fill(1000);
    method.limits.jerk_mm_s3.fill(magnitude(random, 1e3, 1e18));
    // A curve of many small turns, whose ends differ by much in direction.
    std::vector<Block> given;
    Point at{0, 0, 0};
    double direction = 0;
    const double turn = magnitude(random, 1e-12, 0.5);
    for (int i = 0; i < 200; ++i, direction += turn) {
      const Point to{at.x + std::cos(direction), at.y + std::sin(direction), 0};
      given.push_back(straight_block(at, to));
      at = to;
    }
    const std::vector<Block> joined = join_straight(given, method);
    std::size_t block = 0;
    for (const Block& piece : given) {
      const Block& line = joined[block];
      const double x = line.to.x - line.from.x, y = line.to.y - line.from.y;
      const double off = std::abs(x * (piece.to.y - line.from.y) - y * (piece.to.x - line.from.x)) /
                         line.length_mm;
      ASSERT_LE(off, 1.001e-5) << seed << ", turn " << turn;
      if (line.to == piece.to) ++block;
    }
    ASSERT_EQ(block, joined.size());
  }
}

TEST(Optimum, IsThatOfTheDoubleS) {
  // All seven phases: 0.1 s of jerk, 0.1 s of acceleration, 0.2 s each; v = 0.4 m/s.
  const PathLimits limits{400, 2000, 20'000};
  const double ramp = 0.1 + 0.2;
  EXPECT_NEAR(optimum_s(400 * (ramp + 0.5), limits), 2 * ramp + 0.5, 1e-12);
  // At the joints of its cases the time is continuous.
  for (const double length : {400 * ramp, 2 * 2000. * 2000 * 2000 / (20'000. * 20'000)})
    EXPECT_NEAR(optimum_s(length * (1 - 1e-9), limits), optimum_s(length * (1 + 1e-9), limits),
                1e-8);
}

TEST(BadMethod, IsRefused) {
  const auto refusal = [](auto change, Point to = {10, 5, 0}) {
    Method method{Variant::strict, {}, 1e-3, {}};
    method.limits.speed_mm_s.fill(20);
    method.limits.accel_mm_s2.fill(1000);
    method.limits.jerk_mm_s3.fill(10'000);
    change(method);
    return test::error_of([&] { optimise({{straight_block({0, 0, 0}, to)}}, method, "part.ngc"); });
  };
  EXPECT_THAT(refusal([](Method& m) { m.law = {1e10, 100, 0, 0}; }), HasSubstr("n^k is too large"));
  EXPECT_THAT(refusal([](Method& m) { m.law.n = 0.5; }), HasSubstr("n: 0.5 is not"));
  EXPECT_THAT(refusal([](Method& m) { m.law.step_b = -0.1; }), HasSubstr("step of b: -0.1"));
  EXPECT_THAT(refusal([](Method& m) { m.limits.speed_mm_s[1] = 0; }),
              HasSubstr("speed limit: 0 mm/s for Y"));
  EXPECT_THAT(refusal([](Method& m) { m.limits.jerk_mm_s3[0] = -1; }), HasSubstr("jerk limit: -1"));
  EXPECT_THAT(refusal([](Method& m) { m.limits.accel_mm_s2[2] = std::nan(""); }),
              HasSubstr("acceleration limit: nan"));
  EXPECT_THAT(refusal([](Method& m) { m.period_s = 0; }), HasSubstr("control period: 0 ms"));
  EXPECT_THAT(
      refusal([](Method& m) { m.period_s = 0.5; }, {0.01, 0, 0}),
      HasSubstr("part.ngc:0: a block of 0.01 mm takes 31.7 ms, less than the control period"));
  EXPECT_THAT(refusal([](Method& m) { m.period_s = 1e-6; }, {1e7, 0, 0}),
              HasSubstr("more than 20000000 control periods"));
  EXPECT_THAT(refusal([](Method& m) { m.period_s = 1e-6; }),
              HasSubstr("part.ngc:0: in a control period of 0.001 ms the rounding"));
}

}  // namespace
}  // namespace lamplock::feed_optimiser
