// Contours that cross themselves or each other: the boundary of their area by winding numbers of
// points, its compensation by libpolyclipping, the report of the places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/cutting/offset.hpp"
#include "host/cutting/simple_contours.hpp"
#include "tests/cutting/polygon_offset.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::crossing_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

Vec any_place(Random& random) { return {20 * random.uniform() - 10, 20 * random.uniform() - 10}; }

/// Corners anywhere, joined by lines and arcs: crosses itself in many ways.
Contour scribble(Random& random) {
  std::vector<Vec> corners;
  for (auto count = 4 + random.next() % 6; count > 0; --count) corners.push_back(any_place(random));
  Contour contour = polygon(corners);
  for (Edge& edge : contour.edges) {
    if (random.uniform() < 0.6) edge = bulged(edge.from, edge.to, 1.2 * random.uniform() - 0.6);
  }
  return contour;
}

double nearest_edge(const std::vector<Contour>& contours, const Vec& at) {
  double nearest = 1e9;
  for (const Contour& contour : contours) {
    for (const Edge& edge : contour.edges) nearest = std::min(nearest, distance_to(edge, at));
  }
  return nearest;
}

void expect_on(const std::vector<Contour>& boundary, const std::vector<Contour>& contours) {
  for (const Contour& contour : boundary) {
    EXPECT_TRUE(contour.closed);
    for (std::size_t i = 0; i < contour.edges.size(); ++i) {
      const Edge& edge = contour.edges[i];
      EXPECT_EQ(edge.to, contour.edges[(i + 1) % contour.edges.size()].from);
      for (const double part : {0.0, 0.3, 0.7})
        EXPECT_LE(nearest_edge(contours, point_at(edge, part)), 2e-4);
    }
  }
}

TEST(crossing, the_area_of_a_scribble_is_what_it_runs_around) {
  Random random(61);
  std::size_t arcs = 0, edges = 0, crossed = 0;
  for (int i = 0; i < scaled(60, 20); ++i) {
    const Contour contour = scribble(random);
    if (contour_faults({contour}).empty()) continue;
    ++crossed;
    const SimpleContours simple = simple_contours({contour});
    EXPECT_TRUE(contour_faults(simple.contours).empty());
    expect_on(simple.contours, {contour});
    const int inside = signed_area(contour) < 0 ? -1 : 1;
    for (int k = 0; k < 30; ++k) {
      const Vec at = any_place(random);
      if (nearest_edge({contour}, at) < 0.01) continue;
      const int expected = turns_around({contour}, at) != 0 ? inside : 0;
      ASSERT_EQ(turns_around(simple.contours, at), expected) << i;
    }
    for (const Contour& part : simple.contours) {
      edges += part.edges.size();
      for (const Edge& edge : part.edges) arcs += edge.is_line() ? 0U : 1U;
    }
  }
  EXPECT_GT(crossed, 10u);
  EXPECT_LT(edges, 40 * crossed) << "lines and arcs, not chords";
  EXPECT_GT(arcs, 2 * crossed);
}

TEST(crossing, parts_are_united_and_holes_taken_away) {
  Random random(62);
  for (int i = 0; i < scaled(40, 10); ++i) {
    // The first one is the largest: a part or a hole.
    std::vector<Contour> contours{random_star(random, {0, 0}, 6, 9, 11)};
    for (auto count = 1 + random.next() % 3; count > 0; --count)
      contours.push_back(random_star(random, any_place(random), 2, 4, 8));
    for (Contour& contour : contours) {
      if (random.uniform() < 0.5) contour = reversed(contour);
    }
    const bool is_sheet = signed_area(contours.front()) < 0;
    const SimpleContours simple = simple_contours(contours);
    expect_on(simple.contours, contours);
    for (int k = 0; k < 30; ++k) {
      const Vec at = any_place(random);
      if (nearest_edge(contours, at) < 0.01) continue;
      const int turns = turns_around(contours, at);
      const int expected = is_sheet ? (turns < 0 ? -1 : 0) : (turns > 0 ? 1 : 0);
      ASSERT_EQ(turns_around(simple.contours, at), expected) << i;
    }
  }
}

double area_of_all(const std::vector<Polygon>& polygons) {
  double area = 0;
  for (const Polygon& polygon : polygons) area += area_of(polygon);
  return area;
}

TEST(crossing, compensation_agrees_with_polygon_offsets) {
  Random random(63);
  for (int i = 0; i < scaled(60, 10); ++i) {
    Contour contour = scribble(random);
    if (signed_area(contour) < 0) contour = reversed(contour);
    const double distance_mm = (i % 2 == 0 ? 1 : -1) * (0.05 + 0.3 * random.uniform());
    const OffsetContours moved = offset({contour}, {.distance_mm = distance_mm});
    constexpr double chords_mm = 1e-4;
    const std::vector<Polygon> ours = polygons_of(moved.contours, chords_mm);
    const std::vector<Polygon> expected =
        clipper_offset(clipper_simple(polygons_of({contour}, chords_mm)), distance_mm, chords_mm);
    EXPECT_NEAR(area_of_all(ours), area_of_all(expected), 0.02) << i;
    EXPECT_LE(std::max(furthest(ours, expected), furthest(expected, ours)), 0.02) << i;
    // Every crossing is reported.
    const std::vector<Fault> crossings = contour_faults({contour});
    for (const Fault& crossing : crossings) {
      EXPECT_TRUE(std::any_of(moved.faults.begin(), moved.faults.end(), [&](const Fault& fault) {
        return fault.kind == crossing.kind && distance(fault.at, crossing.at) < 1e-9;
      }));
    }
  }
}

TEST(crossing, a_hole_over_the_edge_of_a_part_leaves_a_bite) {
  const Contour square = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  const Contour far_hole = reversed(circle({2, 2}, 1)), bite = reversed(circle({10, 5}, 2));
  const OffsetContours moved = offset({square, far_hole, bite}, {.distance_mm = 0.1});
  ASSERT_EQ(moved.contours.size(), 2u);
  std::size_t crossings = 0;
  for (const Fault& fault : moved.faults) {
    EXPECT_EQ(fault.kind, FaultKind::crossing);
    EXPECT_NEAR(std::abs(fault.at.y - 5), 2, 1e-9);
    EXPECT_NEAR(fault.at.x, 10, 1e-9);
    EXPECT_EQ(fault.contour, 0u);
    EXPECT_EQ(fault.other, 2u);
    ++crossings;
  }
  EXPECT_EQ(crossings, 2u);
  const Contour& part = moved.contours[std::abs(signed_area(moved.contours[0])) > 50 ? 0 : 1];
  // Beyond the corner of the bite is an arc of the beam, inside of the bite one of radius 1.9.
  double radius = 0;
  for (const Edge& edge : part.edges) {
    if (!edge.is_line() && distance(edge.centre, {10, 5}) < 1e-6) radius = radius_of(edge);
  }
  EXPECT_NEAR(radius, 1.9, 1e-6);
  // A line forth and back has no area, and is cut around.
  const OffsetContours slot = offset({polygon({{0, 0}, {8, 0}})}, {.distance_mm = 0.5});
  ASSERT_EQ(slot.contours.size(), 1u);
  EXPECT_NEAR(std::abs(signed_area(slot.contours[0])), 8 + pi / 4, 1e-6);
  // A spur on a square is no part of its area.
  const Contour spur = polygon({{0, 0}, {10, 0}, {10, 10}, {5, 10}, {5, 14}, {5, 10}, {0, 10}});
  const OffsetContours without = offset({spur}, {.distance_mm = 0.5});
  ASSERT_EQ(without.contours.size(), 1u);
  EXPECT_NEAR(length_of(without.contours[0]), 40 + pi, 1e-5);
  EXPECT_FALSE(without.faults.empty());
  // Two bow ties, one drawn the other way round, whose signed areas are 0: the inside of the one is
  // on the left, that of the other on the right.
  const Contour bow = polygon({{0, 0}, {10, 10}, {10, 0}, {0, 10}});
  EXPECT_NE(is_counter_clockwise(bow), is_counter_clockwise(reversed(bow)));
  for (const Contour& tie : {bow, reversed(bow)}) {
    const double side = is_counter_clockwise(tie) ? 1 : -1;
    const OffsetContours grown = offset({tie}, {.distance_mm = 0.1 * side});
    ASSERT_EQ(grown.contours.size(), 1u);
    EXPECT_GT(signed_area(grown.contours[0]) * side, 50);
    EXPECT_EQ(offset({tie}, {.distance_mm = -0.1 * side}).contours.size(), 2u);
    ASSERT_EQ(grown.faults.size(), 3u);
    EXPECT_EQ(grown.faults.back().kind, FaultKind::self_intersection);
    EXPECT_NEAR(distance(grown.faults.back().at, {5, 5}), 0, 1e-9);
  }
}

}  // namespace
}  // namespace lamplock::cutting::crossing_test
