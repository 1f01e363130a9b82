// Compensation: printed lengths, polygon offsets by libpolyclipping and GEOS, narrow places, open
// contours.
#include "host/cutting/offset.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "host/error.hpp"
#include "tests/cutting/geos_offset.hpp"
#include "tests/cutting/polygon_offset.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::offset_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

std::vector<Contour> moved(const std::vector<Contour>& contours, double distance_mm,
                           Join join = Join::arc) {
  OffsetOptions options;
  options.distance_mm = distance_mm;
  options.join = join;
  return offset(contours, options).contours;
}

void expect_connected(const Contour& contour) {
  for (std::size_t i = 0; i < contour.edges.size(); ++i) {
    const bool is_last = i + 1 == contour.edges.size();
    if (!is_last || contour.closed) {
      EXPECT_EQ(contour.edges[i].to, contour.edges[is_last ? 0 : i + 1].from);
    }
    const Edge& edge = contour.edges[i];
    EXPECT_GT(length_of(edge), 0);
    if (edge.is_line()) continue;
    EXPECT_NEAR(distance(edge.to, edge.centre), radius_of(edge), 1e-5);
    EXPECT_NEAR(distance(arc_from(edge.centre, edge.from, edge.sweep).to, edge.to), 0, 1e-5);
  }
}

const Contour square = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
const Contour l_shape = polygon({{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}});

double offset_length(const Contour& contour, double distance_mm, Join join = Join::arc) {
  const std::vector<Contour> result = moved({contour}, distance_mm, join);
  if (result.size() != 1) return 0;
  expect_connected(result[0]);
  return length_of(result[0]);
}

// The test cuts of N. Ausmanas, "Analysis of nonmetallic materials cutting by low power diode
// laser", 2017, with a beam of 0.5 mm: a rounded rectangle of 60 x 20 mm, a hole, a square, an L.
TEST(offset, lengths_of_the_test_cuts) {
  const Contour rectangle = rounded_rectangle({0, 0}, 60, 20, 3);
  EXPECT_NEAR(offset_length(rectangle, 0), 154.8496, 0.0001);
  EXPECT_NEAR(offset_length(rectangle, 0.25), 156.4204, 0.0001);
  EXPECT_NEAR(offset_length(rectangle, -0.25), 153.2788, 0.0001);
  EXPECT_NEAR(offset_length(circle({5, 5}, 4), -0.25), 23.5619, 0.0001);
  EXPECT_NEAR(offset_length(reversed(circle({5, 5}, 4)), 0.25), 23.5619, 0.0001);
  EXPECT_NEAR(offset_length(square, 0.25), 41.5708, 0.0001);
  EXPECT_NEAR(offset_length(square, -0.25), 38, 0.0001);
  EXPECT_NEAR(offset_length(l_shape, 0.25), 81.4635, 0.0001);
  EXPECT_NEAR(offset_length(l_shape, -0.25), 77.8927, 0.0001);
  EXPECT_NEAR(offset_length(square, 0.25, Join::mitre), 42, 1e-9);
  EXPECT_NEAR(offset_length(l_shape, 0.25, Join::mitre), 82, 1e-9);
  // The concave corner of the L is an intersection.
  bool has_corner = false;
  const std::vector<Contour> grown = moved({l_shape}, 0.25);
  for (const Edge& edge : grown.at(0).edges)
    has_corner = has_corner || distance(edge.to, {10.25, 10.25}) < 1e-9;
  EXPECT_TRUE(has_corner);
}

TEST(offset, arcs_stay_arcs_and_lines_lines) {
  const std::vector<Contour> grown = moved({rounded_rectangle({0, 0}, 60, 20, 3)}, 0.25);
  ASSERT_EQ(grown.size(), 1u);
  EXPECT_EQ(grown[0].edges.size(), 8u);
  for (const Edge& edge : grown[0].edges) {
    if (!edge.is_line()) {
      EXPECT_NEAR(radius_of(edge), 3.25, 1e-12);
    }
  }
}

/// A star with holes in it, counter-clockwise outside and clockwise holes.
std::vector<Contour> any_part(Random& random) {
  const auto corners = [&](int min) { return min + static_cast<int>(random.next() % 10); };
  std::vector<Contour> part{random_star(random, {0, 0}, 14, 24, corners(6))};
  const auto holes = random.next() % 4;
  for (std::size_t i = 0; i < holes; ++i) {
    const double turn = 2 * pi * (static_cast<double>(i) + 0.1 * random.uniform()) / 3;
    const Vec centre = Vec{std::cos(turn), std::sin(turn)} * 6.5;
    part.push_back(reversed(random.uniform() < 0.3
                                ? circle(centre, 1 + 3 * random.uniform())
                                : random_star(random, centre, 1, 4.5, corners(5))));
  }
  return part;
}

/// One whose arcs do not cross other arcs.
std::vector<Contour> random_part(Random& random) {
  for (;;) {
    std::vector<Contour> part = any_part(random);
    if (contour_faults(part).empty()) return part;
  }
}

/// Loops large enough not to depend on rounding, and the sum of their areas.
struct Topology {
  int outside = 0, holes = 0;
};
template <class Area>
Topology topology_of(const std::vector<Area>& areas) {
  constexpr double min_area = 0.002;
  Topology topology;
  for (const double area : areas) {
    if (area > min_area) ++topology.outside;
    if (area < -min_area) ++topology.holes;
  }
  return topology;
}

/// How the offset differs from that of an oracle, which has chords of this error; empty: by at most
/// 0.002 mm, with the same numbers of outside contours and holes.
std::string difference(const std::vector<Contour>& result, const std::vector<Polygon>& expected,
                       double chords_mm) {
  std::vector<double> areas, expected_areas;
  for (const Contour& contour : result) areas.push_back(signed_area(contour));
  for (const Polygon& polygon : expected) expected_areas.push_back(area_of(polygon));
  const Topology topology = topology_of(areas), wanted = topology_of(expected_areas);
  if (topology.outside != wanted.outside || topology.holes != wanted.holes) return "topology";
  const std::vector<Polygon> ours = polygons_of(result, chords_mm);
  const double away = std::max(furthest(ours, expected), furthest(expected, ours));
  return away <= 0.002 ? "" : fmt::format("{} mm", away);
}

/// The part with short lines instead of arcs, as other programs export it.
std::vector<Contour> with_short_lines(const std::vector<Contour>& part) {
  std::vector<Contour> lines;
  for (const Polygon& corners : polygons_of(part, 0.002)) lines.push_back(polygon(corners));
  return lines;
}

// Where two arcs meet at a small angle, chords move the corner by many times their error. The time
// of the libraries grows with the square of their number.
constexpr double coarse_mm = 2e-4, fine_mm = 1e-5;

TEST(offset, agrees_with_polygon_offsets_of_two_libraries) {
  Random random(11);
  const GeosOffset geos(coarse_mm), fine_geos(fine_mm);
  // The second library is slow: all parts in the full run, otherwise some of each kind.
  const int geos_step = scaled(2) >= 4 ? 1 : 4;
  int split = 0;
  for (int i = 0; i < scaled(250, 20); ++i) {
    std::vector<Contour> part = random_part(random);
    if (i % 4 == 3) part = with_short_lines(part);
    const double distance_mm = (random.uniform() < 0.5 ? 1 : -1) * (0.05 + 2 * random.uniform());
    const std::vector<Contour> result = moved(part, distance_mm);
    for (const Contour& contour : result) {
      expect_connected(contour);
      ASSERT_TRUE(contour.closed);
    }
    const auto clipper = [&](double chords_mm) {
      return clipper_offset(polygons_of(part, chords_mm), distance_mm, chords_mm);
    };
    if (!difference(result, clipper(coarse_mm), coarse_mm).empty()) {
      EXPECT_EQ(difference(result, clipper(fine_mm), fine_mm), "") << i;
    }
    if ((i + i / 4) % geos_step == 0 &&
        !difference(result, geos.offset(part, distance_mm), coarse_mm).empty()) {
      EXPECT_EQ(difference(result, fine_geos.offset(part, distance_mm), fine_mm), "") << i;
    }
    split += result.size() != part.size() ? 1 : 0;
  }
  EXPECT_GT(split, 0) << "some parts must fall apart or lose a hole";
}

TEST(offset, every_point_has_the_distance) {
  Random random(12);
  for (int i = 0; i < scaled(200, 10); ++i) {
    const std::vector<Contour> part = random_part(random);
    const double distance_mm = 0.05 + 2 * random.uniform();
    for (const double side : {1.0, -1.0}) {
      for (const Contour& contour : moved(part, side * distance_mm)) {
        for (const Edge& edge : contour.edges) {
          for (const double at : {0.0, 0.3, 0.7}) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const Contour& original : part) {
              for (const Edge& other : original.edges)
                nearest = std::min(nearest, distance_to(other, point_at(edge, at)));
            }
            ASSERT_NEAR(nearest, distance_mm, 3e-6);
          }
        }
      }
    }
  }
}

TEST(offset, a_mitre_is_the_arc_with_its_corner_filled) {
  Random random(13);
  for (int i = 0; i < scaled(100, 10); ++i) {
    std::vector<Contour> part = random_part(random);
    const std::vector<Contour> arcs = moved(part, 0.4), mitres = moved(part, 0.4, Join::mitre);
    double arc_area = 0, mitre_area = 0;
    for (const Contour& contour : arcs) arc_area += signed_area(contour);
    for (const Contour& contour : mitres) {
      expect_connected(contour);
      mitre_area += signed_area(contour);
    }
    // Each corner adds d^2 (tan(turn / 2) - turn / 2), unless another edge is near it.
    double added = 0;
    for (const Contour& contour : part) {
      for (std::size_t k = 0; k < contour.edges.size(); ++k) {
        const Vec before = direction_at(contour.edges[k], 1),
                  after = direction_at(contour.edges[(k + 1) % contour.edges.size()], 0);
        const double turn = std::atan2(cross(before, after), dot(before, after));
        if (turn > 0 && std::cos(turn / 2) > 0.25) added += 0.16 * (std::tan(turn / 2) - turn / 2);
      }
    }
    EXPECT_LE(mitre_area, arc_area + added + 1e-4);
    EXPECT_GE(mitre_area, arc_area + 0.2 * added - 1e-4);
  }
}

std::vector<Fault> faults_of(const std::vector<Contour>& contours, double distance_mm) {
  OffsetOptions options;
  options.distance_mm = distance_mm;
  return offset(contours, options).faults;
}

TEST(offset, narrow_places_and_vanished_contours_are_reported) {
  // Two chambers with a passage of 0.4 mm between them, from x = 10 to 14.
  const Contour chambers = polygon({{0, 0},
                                    {10, 0},
                                    {10, 4.8},
                                    {14, 4.8},
                                    {14, 0},
                                    {24, 0},
                                    {24, 10},
                                    {14, 10},
                                    {14, 5.2},
                                    {10, 5.2},
                                    {10, 10},
                                    {0, 10}});
  EXPECT_EQ(moved({chambers}, -0.1).size(), 1u);
  EXPECT_TRUE(faults_of({chambers}, -0.1).empty());
  EXPECT_EQ(moved({chambers}, -0.3).size(), 2u);
  const std::vector<Fault> narrow = faults_of({chambers}, -0.3);
  ASSERT_EQ(narrow.size(), 2u);
  for (const Fault& fault : narrow) {
    EXPECT_EQ(fault.kind, FaultKind::narrow);
    EXPECT_NEAR(fault.size_mm, 0.4, 1e-9) << "the passage";
    EXPECT_NEAR(fault.at.y, 5, 0.001);
    EXPECT_LT(std::min(std::abs(fault.at.x - 10), std::abs(fault.at.x - 14)), 0.31);
  }
  // A passage exactly as wide as the beam: two chambers again.
  for (const Contour& chamber : moved({chambers}, -0.2)) expect_connected(chamber);
  const std::vector<Fault> gone = faults_of({reversed(circle({5, 5}, 0.2)), square}, 0.25);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_EQ(gone[0].kind, FaultKind::vanished);
  EXPECT_EQ(gone[0].contour, 0u);
  EXPECT_NEAR(gone[0].size_mm, 0.4 * pi, 1e-9);
  EXPECT_TRUE(moved({reversed(circle({0, 0}, 0.25))}, 0.25).empty()) << "exactly the beam";
  EXPECT_TRUE(moved({square}, -5).empty()) << "shrinks to a point";
}

TEST(offset, a_passage_is_narrow_if_the_beam_is_wider) {
  Random random(14);
  for (int i = 0; i < scaled(100, 10); ++i) {
    // Two discs with a passage between them, anywhere and in any direction.
    const double half = 0.05 + 0.5 * random.uniform(), radius = 3 + random.uniform();
    const double length = 1 + 3 * random.uniform(),
                 mouth = std::sqrt(radius * radius - half * half);
    const Vec left{-length / 2 - mouth, 0}, right{length / 2 + mouth, 0};
    const double sweep = 2 * pi - 2 * std::asin(half / radius);
    const Edge disc = arc_from(right, {length / 2, -half}, sweep);
    const Edge other = arc_from(left, {-length / 2, half}, sweep);
    Contour dumbbell{
        {{{-length / 2, -half}, disc.from, {}, 0}, disc, {disc.to, other.from, {}, 0}, other},
        true};
    dumbbell.edges[0].from = other.to;
    const double turn = 2 * pi * random.uniform();
    const Vec away{100 * random.uniform(), 0};
    for (Edge& edge : dumbbell.edges) {
      edge = {turned(edge.from, turn) + away, turned(edge.to, turn) + away,
              turned(edge.centre, turn) + away, edge.sweep};
    }
    const double distance_mm = 0.02 + random.uniform();
    const std::vector<Fault> faults = faults_of({dumbbell}, -distance_mm);
    if (distance_mm < half) {
      EXPECT_TRUE(faults.empty());
      continue;
    }
    ASSERT_EQ(faults.size(), 2u);
    for (const Fault& fault : faults) {
      EXPECT_EQ(fault.kind, FaultKind::narrow);
      EXPECT_EQ(fault.contour, 0u);
      // The beam touches both sides of the mouth, which is where the disc ends.
      EXPECT_NEAR(fault.size_mm, 2 * half, 1e-6);
      const Vec at = turned(fault.at - away, -turn);
      EXPECT_NEAR(at.y, 0, 1e-6);
      EXPECT_NEAR(std::abs(at.x) - length / 2, std::sqrt(distance_mm * distance_mm - half * half),
                  1e-6);
    }
  }
}

TEST(offset, open_contours_are_moved_to_one_side) {
  const Contour hook{{{{0, 0}, {10, 0}, {}, 0}, {{10, 0}, {10, 10}, {}, 0}}, false};
  const std::vector<Contour> right = moved({hook}, 0.5), left = moved({hook}, -0.5);
  ASSERT_EQ(right.size(), 1u);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_FALSE(right[0].closed);
  EXPECT_EQ(right[0].edges.front().from, (Vec{0, -0.5}));
  EXPECT_EQ(right[0].edges.back().to, (Vec{10.5, 10}));
  EXPECT_NEAR(length_of(right[0]), 20 + pi / 4, 1e-9);
  EXPECT_EQ(left[0].edges.front().from, (Vec{0, 0.5}));
  EXPECT_NEAR(length_of(left[0]), 19, 1e-9);
}

TEST(offset, far_from_the_origin_and_with_wrong_numbers) {
  Contour far = l_shape;
  for (Edge& edge : far.edges)
    edge = with_ends(edge, edge.from + Vec{1e5, -1e5}, edge.to + Vec{1e5, -1e5});
  EXPECT_NEAR(offset_length(far, 0.25), 81.4635, 0.0001);
  EXPECT_TRUE(moved({}, 1).empty());
  EXPECT_THROW(moved({square}, std::numeric_limits<double>::quiet_NaN()), Error);
  EXPECT_THROW(moved({square}, std::numeric_limits<double>::infinity()), Error);
}

}  // namespace
}  // namespace lamplock::cutting::offset_test
