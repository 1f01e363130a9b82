#include "firmware/program/curves/arc.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/program/curve_checks.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::arc_test {
namespace {

/// Limit documented in arc.hpp; 10^-5 mm is 100.
constexpr long double point_error = 1;

using Random = std::mt19937_64;
long double between(Random& random, long double low, long double high) {
  return low + (high - low) * static_cast<long double>(random() >> 1) / 0x1p63L;
}
long double any_size(Random& random, long double low, long double high) {
  return low * std::pow(high / low, between(random, 0, 1));
}
std::int64_t rounded(long double v) { return std::llround(v); }

/// A round arc: radius from 0.01 mm to 4 m, sweep from 10^-6 to almost a full turn, anywhere, in
/// any plane. `change` is added to the radius at the end.
ArcRequest any_arc(Random& random, long double change = 0) {
  ArcRequest r{};
  const std::array<CurvePlane, 3> planes{plane_xy, plane_zx, plane_yz};
  r.plane = planes[random() % 3];
  const long double radius = any_size(random, 1e5L, 4e10L);
  const long double start = between(random, 0, two_pi_l);
  // Ends are rounded, so short sweeps of small radii are not arcs.
  const long double least = std::max(1e-6L, 50 / radius);
  const long double sweep = random() % 2 != 0 ? any_size(random, least, two_pi_l - least)
                                              : between(random, least, two_pi_l - least);
  r.clockwise = random() % 2 != 0;
  const long double end = start + (r.clockwise ? -sweep : sweep);
  for (std::int64_t& axis : r.centre) axis = rounded(between(random, -5e10L, 5e10L));
  for (std::int64_t& axis : r.start) axis = rounded(between(random, -1e11L, 1e11L));
  for (std::int64_t& axis : r.end) axis = rounded(between(random, -1e11L, 1e11L));
  if (random() % 2 != 0) r.end[r.plane.normal] = r.start[r.plane.normal];
  if (random() % 2 != 0) r.end[3] = r.start[3];
  const auto put = [&](Place& place, long double angle, long double at) {
    place[r.plane.first] = r.centre[r.plane.first] + rounded(at * std::cos(angle));
    place[r.plane.second] = r.centre[r.plane.second] + rounded(at * std::sin(angle));
  };
  put(r.start, start, radius);
  put(r.end, end, radius + change);
  r.turns = random() % 4 == 0 ? static_cast<std::uint32_t>(random() % 4) : 0;
  r.tolerance_e7 = rounded(any_size(random, 1e2L, 1e6L));
  // A test of few pieces is as strong as one of many.
  const long double piece = std::sqrt(8 * static_cast<long double>(r.tolerance_e7) / radius);
  if (sweep * (r.turns + 1) / piece > 2000) r.tolerance_e7 = rounded(1e-5L * radius) + 100;
  return r;
}

Errors run(const ArcRequest& r, Curve& curve) {
  curve.begin_arc(r);
  const std::vector<Place> places = trace(curve, r.start);
  EXPECT_EQ(places.back(), r.end);
  return errors_of(places, r.plane, TrueArc(r));
}

void expect_length(const Curve& curve, long double want) {
  EXPECT_NEAR(static_cast<double>(curve.length_e7()), static_cast<double>(want),
              static_cast<double>(want / 10000 + 3));
}

TEST(Arc, EveryPointIsOnTheArcAndEveryChordKeepsTheTolerance) {
  Random random(1);
  long double worst = 0;
  for (int i = 0; i < test::scaled(700); ++i) {
    const ArcRequest r = any_arc(random);
    SCOPED_TRACE(i);
    ASSERT_TRUE(arc_fits(r));
    Curve curve;
    const Errors errors = run(r, curve);
    worst = std::max(worst, errors.point);
    ASSERT_LE(errors.point, point_error);
    ASSERT_LE(errors.other, 0.51L);
    ASSERT_LE(errors.chord, static_cast<long double>(r.tolerance_e7) + 3);
    const TrueArc arc(r);
    expect_length(curve, arc.length_with(other_way(r.start, r.end, r.plane)));
  }
  RecordProperty("worst_e7", std::to_string(worst));
}

TEST(Arc, UsesAsFewPiecesAsTheToleranceAllows) {
  Random random(2);
  int divided = 0;
  for (int i = 0; i < test::scaled(5000); ++i) {
    const ArcRequest r = any_arc(random);
    const TrueArc arc(r);
    Curve curve;
    curve.begin_arc(r);
    const long double n = curve.pieces();
    const auto tolerance = static_cast<long double>(r.tolerance_e7);
    ASSERT_LE(arc.chord_error(n), tolerance * 1.0001L + 3) << i;
    // With one piece less, the error or the angle of a piece would be too large.
    if (n == 1 || std::abs(arc.sweep) / (n - 1) > two_pi_l / 4) continue;
    ++divided;
    ASSERT_GT(arc.chord_error(n - 1), tolerance * 0.9999L - 3) << i;
    if (n >= 4) {
      ASSERT_GT(arc.chord_error(n), tolerance / 2) << i;
    }
  }
  EXPECT_GT(divided, test::scaled(5000) / 2);
}

TEST(Arc, SpiralsBlendFromOneRadiusToTheOther) {
  Random random(3);
  for (int i = 0; i < test::scaled(400); ++i) {
    const long double part = between(random, -1, 1);
    Random again = random;
    const long double radius = TrueArc(any_arc(again)).start_radius;
    // The largest difference that arc_fits() allows.
    const long double most = std::max(4.9e4L, std::min(4.9e6L, radius / 1001));
    const ArcRequest r = any_arc(random, part * most);
    ASSERT_TRUE(arc_fits(r));
    SCOPED_TRACE(i);
    Curve curve;
    const Errors errors = run(r, curve);
    ASSERT_LE(errors.point, point_error);
    // Spirals of less than 6 10^-6 rad are not divided.
    ASSERT_LE(errors.chord, static_cast<long double>(r.tolerance_e7) + 10);
    const TrueArc arc(r);
    expect_length(curve, arc.length_with(other_way(r.start, r.end, r.plane)));
  }
}

/// Length of a spiral in closed form: the integral of the root of r^2 + c^2, with c the change in
/// each radian.
long double spiral_length(const TrueArc& arc) {
  const long double c = std::abs((arc.end_radius - arc.start_radius) / arc.sweep);
  const auto integral = [c](long double r) {
    return (r * std::hypot(r, c) + c * c * std::asinh(r / c)) / 2;
  };
  return std::abs(integral(arc.end_radius) - integral(arc.start_radius)) / c;
}

TEST(Arc, LengthsOfSpiralsOfAFewMicrometresAreRight) {
  // Radii may differ by 0.005 mm even if they are small: by any factor, up to three turns.
  Random random(7);
  for (int i = 0; i < test::scaled(4000); ++i) {
    long double small = any_size(random, 20, 2e5L), large = small + any_size(random, 20, 4.99e4L);
    if (random() % 2 != 0) std::swap(small, large);
    const long double sweep = between(random, 0.01L, two_pi_l - 0.01L);
    ArcRequest r{{rounded(small), 0, 0, 0}, {}, {}, plane_xy, random() % 2 != 0, 0, 100};
    r.end[0] = rounded(large * std::cos(sweep));
    r.end[1] = rounded(large * std::sin(sweep));
    if (random() % 2 != 0) r.end[2] = rounded(any_size(random, 1e2L, 1e6L));
    r.turns = static_cast<std::uint32_t>(random() % 4);
    ASSERT_TRUE(arc_fits(r));
    SCOPED_TRACE(testing::Message() << i << ": from " << small << " to " << large);
    Curve curve;
    ASSERT_LE(run(r, curve).point, point_error);
    const TrueArc arc(r);
    const long double want = std::hypot(spiral_length(arc), other_way(r.start, r.end, r.plane));
    // Radii are whole numbers, rounded down.
    EXPECT_NEAR(static_cast<double>(curve.length_e7()), static_cast<double>(want),
                static_cast<double>(want / 10000 + 3 + std::abs(arc.sweep)));
  }
}

TEST(Arc, TheAngleGrowsFromPieceToPiece) {
  Random random(4);
  for (int i = 0; i < test::scaled(500); ++i) {
    const ArcRequest r = any_arc(random);
    Curve curve;
    curve.begin_arc(r);
    const std::vector<Place> places = trace(curve, r.start);
    const TrueArc arc(r);
    // The smallest angle is 2 units wide; points are rounded.
    const long double least = std::abs(arc.sweep) / static_cast<long double>(curve.pieces());
    if (least * arc.start_radius < 4) continue;
    for (std::size_t k = 1; k < places.size(); ++k) {
      const Point a = in_plane(places[k - 1], r.plane) - arc.centre;
      const Point b = in_plane(places[k], r.plane) - arc.centre;
      const long double across = a.x * b.y - a.y * b.x;
      ASSERT_GT(r.clockwise ? -across : across, 0) << i << " piece " << k;
    }
  }
}

TEST(Arc, FullCircles) {
  Random random(5);
  for (int i = 0; i < test::scaled(100); ++i) {
    ArcRequest r = any_arc(random);
    r.end[r.plane.first] = r.start[r.plane.first];
    r.end[r.plane.second] = r.start[r.plane.second];
    SCOPED_TRACE(i);
    Curve curve;
    const Errors errors = run(r, curve);
    ASSERT_LE(errors.point, point_error);
    ASSERT_LE(errors.other, 0.51L);
    ASSERT_GE(curve.pieces(), 4u);
    ASSERT_NEAR(std::abs(static_cast<double>(TrueArc(r).sweep)),
                static_cast<double>(two_pi_l * std::max<long double>(r.turns, 1)), 1e-9);
    expect_length(curve, TrueArc(r).length_with(other_way(r.start, r.end, r.plane)));
  }
}

TEST(Arc, TurnsAreAdditionalTurns) {
  ArcRequest r{{mm(10), 0, 0, 0}, {0, mm(10), mm(6), mm(-90)}, {}, plane_xy, false, 0, mm(0.002)};
  Curve curve;
  for (const std::uint32_t turns : {0u, 1u, 2u, 3u, 100u}) {
    r.turns = turns;
    SCOPED_TRACE(turns);
    ASSERT_LE(run(r, curve).point, point_error);
    const double sweep = (turns > 1 ? turns - 1 : 0) + 0.25;
    EXPECT_NEAR(static_cast<double>(curve.length_e7()),
                std::hypot(1e8 * sweep * 2 * std::numbers::pi, mm(6), mm(90)), 3);
  }
  r.turns = 4'000'000'000;
  curve.begin_arc(r);
  // 9999.25 turns; the largest piece is 2 acos(1 - 0.0002) = 0.0400007 rad.
  EXPECT_EQ(curve.pieces(), std::ceil(9999.25 * two_pi_l / (2 * std::acos(1 - 0.0002L))));
}

TEST(Arc, NoDriftOverManyTurns) {
  ArcRequest r{{mm(4000), 0, 0, 0}, {mm(4000), 0, mm(1), 0}, {}, plane_xy, false, 0, mm(0.01)};
  r.turns = static_cast<std::uint32_t>(test::scaled(100));
  Curve curve;
  EXPECT_LE(run(r, curve).point, point_error);
  EXPECT_GT(curve.pieces(), 1000 * r.turns);
}

TEST(Arc, HugeRadiusAndTinySweep) {
  // 4 m, 10^-6 rad: a distance of 4 um.
  ArcRequest r{
      {0, mm(-4000), 0, 0}, {rounded(4e4L), mm(-4000), 0, 0}, {}, plane_xy, false, 0, mm(0.002)};
  Curve curve;
  ASSERT_TRUE(arc_fits(r));
  EXPECT_LE(run(r, curve).point, point_error);
  EXPECT_EQ(curve.pieces(), 1u);
  EXPECT_EQ(curve.length_e7(), 40000);
  r.tolerance_e7 = 1;
  EXPECT_LE(run(r, curve).point, point_error);
  EXPECT_EQ(curve.pieces(), 1u);
  // The same ends in the other direction: almost a full turn.
  r.clockwise = true;
  r.tolerance_e7 = mm(0.01);
  EXPECT_LE(run(r, curve).point, point_error);
  EXPECT_NEAR(static_cast<double>(curve.length_e7()), 4e10 * (2 * std::numbers::pi - 1e-6), 10);
}

TEST(Arc, RadiiBeyondTheMachine) {
  // R 1 km over a distance of 1 m, and R 7 km.
  for (const double radius : {1e6, 6.9e6}) {
    ArcRequest r{{0, 0, 0, 0}, {mm(1000), mm(500), 0, 0}, {}, plane_xy, true, 0, mm(0.002)};
    ASSERT_TRUE(centre_of_radius(r.start, r.end, r.plane, mm(radius), true, r.centre));
    ASSERT_TRUE(arc_fits(r));
    Curve curve;
    const Errors errors = run(r, curve);
    EXPECT_LE(errors.point, 10);
    EXPECT_LE(errors.chord, mm(0.002) + 10);
    EXPECT_GE(curve.pieces(), 4u);
  }
}

TEST(Arc, SweepsThatRoundToZeroAreNeitherZeroNorATurn) {
  // 0.3 units of an angle.
  const std::int64_t far = max_coordinate_e7;
  for (const bool clockwise : {false, true}) {
    const ArcRequest r{
        {0, -far, 0, 0}, {1, -far, 0, 0}, {0, far, 0, 0}, plane_xy, clockwise, 0, far};
    Curve curve;
    curve.begin_arc(r);
    const std::vector<Place> places = trace(curve, r.start);
    EXPECT_EQ(places.back(), r.end);
    const double turn = 2 * std::numbers::pi * 2 * static_cast<double>(far);
    if (clockwise) {
      EXPECT_NEAR(static_cast<double>(curve.length_e7()) / turn, 1, 1e-6);
    }
    EXPECT_EQ(curve.pieces(), clockwise ? 4u : 1u);
  }
}

TEST(Arc, RadiusFindsTheCentreOfTheOriginalArc) {
  Random random(6);
  for (int i = 0; i < test::scaled(5000); ++i) {
    const ArcRequest r = any_arc(random);
    const TrueArc arc(r);
    if (std::abs(arc.sweep) > two_pi_l) continue;
    const bool large = std::abs(arc.sweep) > two_pi_l / 2;
    const std::int64_t radius = rounded(arc.start_radius);
    Place centre{};
    const bool found =
        centre_of_radius(r.start, r.end, r.plane, large ? -radius : radius, r.clockwise, centre);
    // Near half a turn and near a full one the centre depends on rounding.
    const long double chord = length(in_plane(r.end, r.plane) - in_plane(r.start, r.plane));
    const auto radius_l = static_cast<long double>(radius);
    const long double aside = radius_l * radius_l - chord * chord / 4;
    if (aside < 1e-6L * radius_l * radius_l) continue;
    ASSERT_TRUE(found) << i;
    const Point off = in_plane(centre, r.plane) - in_plane(r.centre, r.plane);
    // An error of 2 in the radius, over the sine of half the sweep.
    ASSERT_LE(length(off), 3 + 4 * radius_l / chord + 4 * radius_l / std::sqrt(aside)) << i;
    ASSERT_EQ(centre[r.plane.normal], r.start[r.plane.normal]);
    ArcRequest again = r;
    again.centre = centre;
    ASSERT_TRUE(arc_fits(again)) << i;
    ASSERT_NEAR(static_cast<double>(TrueArc(again).sweep), static_cast<double>(arc.sweep),
                static_cast<double>(40 / chord + 40 / std::sqrt(aside)))
        << i;
  }
}

TEST(Arc, TheSignOfTheRadiusSelectsTheSideOfTheCentre) {
  const Place a{}, b{mm(10), 0, mm(7), 0};
  const double aside = std::sqrt(100.0 - 25.0);
  Place c{};
  ASSERT_TRUE(centre_of_radius(a, b, plane_xy, mm(10), false, c));
  EXPECT_EQ(c, (Place{mm(5), mm(aside), 0, 0}));
  ASSERT_TRUE(centre_of_radius(a, b, plane_xy, mm(10), true, c));
  EXPECT_EQ(c, (Place{mm(5), mm(-aside), 0, 0}));
  ASSERT_TRUE(centre_of_radius(a, b, plane_xy, mm(-10), false, c));
  EXPECT_EQ(c, (Place{mm(5), mm(-aside), 0, 0}));
  ASSERT_TRUE(centre_of_radius(a, b, plane_xy, mm(-10), true, c));
  EXPECT_EQ(c, (Place{mm(5), mm(aside), 0, 0}));
}

TEST(Arc, ARadiusThatIsTooSmallIsAnError) {
  const Place a{}, b{mm(10), 0, 0, 0};
  Place c{1, 2, 3, 4};
  EXPECT_TRUE(centre_of_radius(a, b, plane_xy, mm(5), false, c));
  EXPECT_EQ(c, (Place{mm(5), 0, 0, 0}));
  // Half a distance of 3 sqrt 2, rounded to 7 decimals, is too short by rounding.
  EXPECT_TRUE(centre_of_radius(a, {mm(3), mm(3), 0, 0}, plane_xy, 21'213'203, false, c));
  EXPECT_EQ(c, (Place{mm(1.5), mm(1.5), 0, 0}));
  // LinuxCNC accepts 0.00127 mm: 2.9 reads R4.99873 and refuses R4.99872.
  for (const double radius : {4.9999, 4.999, 4.99873, -4.99873}) {
    EXPECT_TRUE(centre_of_radius(a, b, plane_xy, mm(radius), false, c)) << radius;
    EXPECT_EQ(c, (Place{mm(5), 0, 0, 0})) << radius;
  }
  EXPECT_FALSE(centre_of_radius(a, b, plane_xy, mm(4.9987299), false, c));
  EXPECT_FALSE(centre_of_radius(a, b, plane_xy, mm(-4.9987299), false, c));
  EXPECT_FALSE(centre_of_radius(a, b, plane_xy, mm(4.995), false, c));
  EXPECT_FALSE(centre_of_radius(a, b, plane_xy, 0, false, c));
  EXPECT_FALSE(centre_of_radius(a, a, plane_xy, mm(5), false, c));
  EXPECT_FALSE(centre_of_radius(a, {0, 0, mm(1), 0}, plane_xy, mm(5), false, c));
  EXPECT_FALSE(centre_of_radius(a, b, plane_xy, max_coordinate_e7 + 1, false, c));
  EXPECT_FALSE(
      centre_of_radius(a, b, plane_xy, std::numeric_limits<std::int64_t>::max(), false, c));
}

/// A number of a program, rounded to decimals.
std::int64_t with_decimals(long double e7, int decimals) {
  const long double unit = std::pow(10.0L, 7 - decimals);
  return rounded(unit * std::round(e7 / unit));
}

TEST(Arc, HalfCirclesOfRoundedNumbersAreRead) {
  Random random(17);
  int too_short = 0, refused = 0;
  for (int i = 0; i < test::scaled(4000); ++i) {
    const int decimals = 2 + static_cast<int>(random() % 3);
    const long double radius = any_size(random, 1e6L, 1e9L), angle = between(random, 0, two_pi_l);
    const Place start{with_decimals(between(random, -1e9L, 1e9L), decimals),
                      with_decimals(between(random, -1e9L, 1e9L), decimals), mm(3), 0};
    Place end = start;
    end[0] += with_decimals(2 * radius * std::cos(angle), decimals);
    end[1] += with_decimals(2 * radius * std::sin(angle), decimals);
    const std::int64_t given = with_decimals(radius, decimals);
    const Point way = in_plane(end, plane_xy) - in_plane(start, plane_xy);
    const long double half = length(way) / 2, missing = half - static_cast<long double>(given);
    if (std::abs(missing - 12'700) < 1e-3L) continue;  // the limit itself
    Place centre{};
    const bool found = centre_of_radius(start, end, plane_xy, random() % 2 == 0 ? given : -given,
                                        random() % 2 == 0, centre);
    ASSERT_EQ(found, missing < 12'700) << i;
    ASSERT_TRUE(found || decimals == 2) << i;
    refused += !found;
    if (!found || missing <= 0) continue;
    ++too_short;
    // The centre is the middle, the radius half the distance of the ends.
    const Point off = in_plane(centre, plane_xy) - in_plane(start, plane_xy);
    ASSERT_NEAR(static_cast<double>(2 * length(off)), static_cast<double>(2 * half), 4) << i;
    ASSERT_TRUE(arc_fits({start, end, centre, plane_xy, false, 1, mm(0.002)})) << i;
  }
  EXPECT_GT(too_short, 0);
  EXPECT_GT(refused, 0);
}

TEST(Arc, RadiiAgreeAsInGrbl) {
  const auto fits = [](double start, double end) {
    return arc_fits({{mm(start), 0, 0, 0}, {0, mm(end), 0, 0}, {}, plane_xy, false, 0, mm(0.002)});
  };
  EXPECT_TRUE(fits(1, 1.005));  // 0.005 mm
  EXPECT_FALSE(fits(1, 1.0050001));
  EXPECT_TRUE(fits(1, 0.995));
  EXPECT_FALSE(fits(1, 0.9949999));
  EXPECT_TRUE(fits(100, 100.1));  // 0.1 %
  EXPECT_FALSE(fits(100, 100.1000001));
  EXPECT_TRUE(fits(100, 99.9));
  EXPECT_TRUE(fits(4000, 4000.5));  // 0.5 mm
  EXPECT_FALSE(fits(4000, 4000.5000001));
  EXPECT_FALSE(arc_fits({{}, {mm(10), 0, 0, 0}, {}, plane_xy, false, 0, mm(0.002)}));
}

TEST(Arc, AShortArcTo100And120) {
  // A radius of 150 mm, from (0, 0) to (100, 120).
  ArcRequest r{{}, {mm(100), mm(120), 0, 0}, {}, plane_xy, false, 0, mm(0.002)};
  for (const bool clockwise : {false, true}) {
    r.clockwise = clockwise;
    ASSERT_TRUE(centre_of_radius(r.start, r.end, plane_xy, mm(150), clockwise, r.centre));
    // d = sqrt(24400) = 156.205; the centre is sqrt(150^2 - d^2/4) = 128.0625 beside its middle.
    const double side = clockwise ? -1 : 1, aside = std::sqrt(22500.0 - 6100.0);
    const double d = std::sqrt(24400.0);
    EXPECT_LE(std::abs(r.centre[0] - mm(50 - side * aside * 120 / d)), 1);
    EXPECT_LE(std::abs(r.centre[1] - mm(60 + side * aside * 100 / d)), 1);
    Curve curve;
    const Errors errors = run(r, curve);
    EXPECT_LE(errors.point, point_error);
    EXPECT_LE(errors.chord, mm(0.002) + 2);
    // 2 asin(d / 300) = 1.095 rad in pieces of up to 0.0103280 rad.
    EXPECT_EQ(curve.pieces(), 107u);
    EXPECT_NEAR(static_cast<double>(curve.length_e7()), 1.5e9 * 2 * std::asin(d / 300), 3);
  }
}

/// Degenerate requests give a single piece to the end.
TEST(Arc, DegenerateArcsAreAStraightPiece) {
  const Place a{mm(1), mm(2), mm(3), mm(4)}, b{mm(5), mm(-6), mm(7), mm(-8)};
  const std::int64_t far = max_coordinate_e7 + 1;
  const std::array<ArcRequest, 5> requests{{
      {a, b, a, plane_xy, false, 0, mm(0.002)},                       // centre = start
      {a, b, b, plane_zx, true, 7, mm(0.002)},                        // centre = end
      {a, a, a, plane_yz, false, 0, mm(0.002)},                       // no distance
      {a, b, {far, 0, 0, 0}, plane_xy, false, 0, mm(0.002)},          // a centre out of range
      {a, b, {0, -far, 0, 0}, plane_xy, false, 1'000'000, mm(0.002)}  //
  }};
  for (const ArcRequest& r : requests) {
    Curve curve;
    curve.begin_arc(r);
    EXPECT_EQ(curve.pieces(), 1u);
    Place at{};
    EXPECT_TRUE(curve.next(at));
    EXPECT_EQ(at, r.end);
    EXPECT_FALSE(curve.next(at));
    EXPECT_FALSE(arc_fits(r) && r.centre != a) << "only a point with radius 0 fits";
    const long double way =
        std::hypot(length(in_plane(r.end, r.plane) - in_plane(r.start, r.plane)),
                   other_way(r.start, r.end, r.plane));
    EXPECT_NEAR(static_cast<double>(curve.length_e7()), static_cast<double>(way), 3);
  }
}

TEST(Arc, AnyToleranceTerminates) {
  ArcRequest r{{mm(4000), 0, 0, 0}, {mm(4000), 0, 0, 0}, {}, plane_xy, false, 0, 0};
  Curve curve;
  const std::array<std::int64_t, 2> none{0, std::numeric_limits<std::int64_t>::min()};
  for (const std::int64_t tolerance : none) {
    r.tolerance_e7 = tolerance;
    const Errors errors = run(r, curve);
    EXPECT_EQ(curve.pieces(), 62832u);
    EXPECT_LE(errors.point, point_error);
    EXPECT_LE(errors.chord, 52);
  }
  for (const std::int64_t tolerance :
       {mm(4000), mm(1e5), std::numeric_limits<std::int64_t>::max()}) {
    r.tolerance_e7 = tolerance;
    EXPECT_LE(run(r, curve).point, point_error);
    EXPECT_EQ(curve.pieces(), 4u);
  }
}

TEST(Arc, TheSmallestArcs) {
  // All circles and arcs within a few units: the fewest possible pieces, and they end.
  for (std::int64_t x = -3; x <= 3; ++x) {
    for (std::int64_t y = -3; y <= 3; ++y) {
      for (const std::int64_t tolerance : {0, 1, 5}) {
        const ArcRequest r{{2, 1, 0, 0}, {x, y, 5, 0}, {}, plane_xy, y > 0, 0, tolerance};
        Curve curve;
        curve.begin_arc(r);
        const std::vector<Place> places = trace(curve, r.start);
        ASSERT_EQ(places.back(), r.end);
        ASSERT_LE(curve.pieces(), 65536u);
      }
    }
  }
}

TEST(Arc, AtTheLimitsOfTheNumbers) {
  // Corners of the +-10 m machine and of the accepted range.
  const std::array<std::int64_t, 2> sizes{max_position_e7, max_coordinate_e7};
  for (const std::int64_t most : sizes) {
    for (int bits = 0; bits < 128; ++bits) {
      const auto at = [&](int bit) { return (bits >> bit & 1) != 0 ? most : -most; };
      const ArcRequest r{{at(0), at(1), at(6), 0},
                         {at(2), at(3), -at(6), most},
                         {at(4), at(5), 0, 0},
                         plane_xy,
                         at(6) > 0,
                         0,
                         most / 1000};
      Curve curve;
      curve.begin_arc(r);
      (void)arc_fits(r);
      const std::vector<Place> places = trace(curve, r.start);
      ASSERT_EQ(places.back(), r.end);
      ArcRequest turns = r;
      turns.turns = 4'000'000'000;
      turns.tolerance_e7 = 0;
      Curve far;
      far.begin_arc(turns);
      ASSERT_LE(far.pieces(), 1u << 30);
      Place centre{};
      for (const std::int64_t radius : {most, -most, 2 * most})
        (void)centre_of_radius(r.start, r.end, plane_xy, radius, at(6) > 0, centre);
      const TrueArc arc(r);
      if (arc.start_radius == 0 || arc.end_radius == 0) continue;
      // Ten thousand turns, the maximum count.
      const long double turned = 1e4L * two_pi_l * (arc.start_radius + arc.end_radius) / 2;
      ASSERT_GE(static_cast<long double>(far.length_e7()), std::min(0.99L * turned, 0x1p61L))
          << bits;
      // 2^-44 of the radius, and rounding.
      ASSERT_LE(errors_of(places, plane_xy, arc).point, 2 + arc.start_radius * 0x1p-43L) << bits;
    }
  }
}

/// Some arcs computed by an independent program in double precision.
struct Golden {
  ArcRequest request;
  std::uint32_t pieces;
  std::uint32_t look_at;  ///< index of the compared end
  Place place;
  std::int64_t length_e7;
};

TEST(Arc, GoldenTable) {
  const std::vector<Golden> table = {
      // A quarter of 10 mm
      {{{100000000, 0, 0, 0}, {0, 100000000, 0, 0}, {0, 0, 0, 0}, plane_xy, false, 0, 20000},
       40,
       13,
       {87249601, 48862124, 0, 0},
       157079633},
      // three quarters of it, clockwise
      {{{100000000, 0, 0, 0}, {0, 100000000, 0, 0}, {0, 0, 0, 0}, plane_xy, true, 0, 20000},
       118,
       39,
       {1331144, -99991140, 0, 0},
       471238898},
      // a full circle in G18
      {{{30000000, 0, 40000000, 0},
        {30000000, 0, 40000000, 0},
        {0, 0, 0, 0},
        plane_zx,
        true,
        0,
        100000},
       50,
       16,
       {-48966461, 0, 10113640, 0},
       314159265},
      // a helix of three turns in G19 with A
      {{{10000000, 250000000, 0, 0},
        {310000000, 250000000, 0, 3600000000},
        {0, 0, 0, 0},
        plane_yz,
        false,
        3,
        200000},
       236,
       78,
       {109152542, 249645674, -13305544, 1189830508},
       5937727672},
      // half an inch, coarse
      {{{0, 0, 0, 0}, {254000000, 0, 0, 0}, {127000000, 0, 0, 0}, plane_xy, true, 0, 5000000},
       6,
       2,
       {63500000, 109985226, 0, 0},
       398982267},
      // 4 m, 0.1 rad
      {{{40000000000, 0, 0, 0},
        {39800166611, 3993336666, 50000000, 0},
        {0, 0, 0, 0},
        plane_xy,
        false,
        0,
        20000},
       50,
       16,
       {39979521748, 1279781558, 16000000, 0},
       4000312488},
      // a hole of 0.1 mm
      {{{1000500000, 500000000, 0, 0},
        {1000500000, 500000000, 0, 0},
        {1000000000, 500000000, 0, 0},
        plane_xy,
        false,
        0,
        20000},
       12,
       4,
       {999750000, 500433013, 0, 0},
       3141593},
  };
  for (const Golden& golden : table) {
    Curve curve;
    curve.begin_arc(golden.request);
    const std::vector<Place> places = trace(curve, golden.request.start);
    ASSERT_EQ(curve.pieces(), golden.pieces);
    for (std::size_t axis = 0; axis < max_axes; ++axis)
      EXPECT_NEAR(static_cast<double>(places[golden.look_at][axis]),
                  static_cast<double>(golden.place[axis]), 2)
          << golden.look_at << " axis " << axis;
    EXPECT_NEAR(static_cast<double>(curve.length_e7()), static_cast<double>(golden.length_e7), 3);
  }
}

}  // namespace
}  // namespace lamplock::program::arc_test
