// Gaps narrower than the beam, and contours that have one direction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "host/cutting/cut_plan.hpp"
#include "host/error.hpp"
#include "tests/cutting/plans.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::neighbours_test {
namespace {

using geometry::Random;
using namespace lamplock::test;

Contour square(double low, double side) {
  return polygon({{low, low}, {low + side, low}, {low + side, low + side}, {low, low + side}});
}

std::vector<Fault> near_faults(const CutPlan& plan) {
  std::vector<Fault> faults;
  for (const Fault& fault : plan.faults)
    if (fault.kind == FaultKind::near) faults.push_back(fault);
  return faults;
}

bool has_crossing_beams(const CutPlan& plan) {
  return std::any_of(plan.faults.begin(), plan.faults.end(),
                     [](const Fault& fault) { return fault.kind == FaultKind::beams; });
}

/// The nearest of points on two edges.
double sampled_distance(const Edge& a, const Edge& b) {
  double nearest = 1e9;
  for (int i = 0; i <= 200; ++i)
    nearest = std::min(nearest, distance_to(b, point_at(a, i / 200.0)));
  return nearest;
}

TEST(neighbours, edges_are_nearest_where_points_on_them_are) {
  Random random(61);
  const auto any = [&] { return Vec{10 * random.uniform(), 10 * random.uniform()}; };
  for (int i = 0; i < scaled(400, 60); ++i) {
    const Edge a = i % 3 == 0 ? Edge{any(), any(), {}, 0}
                              : arc_from(any(), any(), 6.2 * (random.uniform() * 2 - 1));
    const Edge b = i % 4 == 0 ? Edge{any(), any(), {}, 0}
                              : arc_from(any(), any(), 6.2 * (random.uniform() * 2 - 1));
    const Approach approach = approach_of(a, b);
    const double sampled = sampled_distance(a, b);
    EXPECT_LE(approach.distance_mm, sampled + 1e-9);
    EXPECT_GE(approach.distance_mm, sampled - length_of(a) / 200);
    EXPECT_NEAR(distance_to(b, approach.at), 0, 1e-6);
    EXPECT_NEAR(distance_to(a, approach.at), approach.distance_mm, 1e-6);
  }
}

// Plate, hole and an island in the hole; the beams change their places without crossing.
TEST(neighbours, a_gap_around_an_island_that_is_narrower_than_the_kerf_is_named) {
  const Contour plate = square(0, 40), hole = square(10, 20);
  for (const double gap : {0.05, 0.1, 0.2, 0.29}) {
    const std::vector<Contour> squares{plate, hole, square(10 + gap, 20 - 2 * gap)};
    const std::vector<Contour> rings{plate, circle({20, 20}, 10), circle({20, 20}, 10 - gap)};
    for (const std::vector<Contour>* drawing : {&squares, &rings}) {
      for (const Compensation side : {Compensation::automatic, Compensation::controller}) {
        Operation one = operation(0.3);
        one.compensation = side;
        const CutPlan plan = plan_of(*drawing, one);
        // Of squares with wide gaps the round corner of one beam crosses the sharp one of the
        // other.
        if (has_crossing_beams(plan)) {
          EXPECT_TRUE(drawing == &squares && gap > 0.15) << gap;
          continue;
        }
        const std::vector<Fault> faults = near_faults(plan);
        ASSERT_EQ(faults.size(), 1u) << gap;
        EXPECT_NEAR(faults[0].size_mm, gap, 1e-6);
      }
    }
  }
  EXPECT_TRUE(plan_of({plate, hole, square(10.31, 19.38)}, operation(0.3)).faults.empty());
  EXPECT_TRUE(plan_of({plate, hole, square(10.1, 19.8)}, operation(0)).faults.empty());
}

TEST(neighbours, random_islands_in_holes) {
  Random random(62);
  for (int i = 0; i < scaled(60, 12); ++i) {
    const Contour island = random_star(random, {20, 20}, 3, 6, 5 + static_cast<int>(i) % 9);
    const double gap = 0.05 + 0.5 * random.uniform();
    const Contour hole = circle({20, 20}, std::max(box_of(island).high.x - 20, 6.0) + gap);
    double nearest = 1e9;
    for (const Edge& edge : island.edges)
      for (const Edge& other : hole.edges)
        nearest = std::min(nearest, approach_of(edge, other).distance_mm);
    const double kerf = 0.3;
    if (nearest < 0.002 || std::abs(nearest - kerf) < 0.01) continue;
    const CutPlan plan = plan_of({square(0, 40), hole, island}, operation(kerf));
    const bool is_named = std::any_of(plan.faults.begin(), plan.faults.end(), [](const Fault& f) {
      return f.kind == FaultKind::near || f.kind == FaultKind::beams ||
             f.kind == FaultKind::overlap;
    });
    EXPECT_EQ(is_named, nearest < kerf) << nearest;
  }
}

TEST(neighbours, leads_do_not_pierce_in_another_part) {
  const std::vector<Contour> ring{square(0, 40), square(10, 20), square(10.1, 19.8)};
  Operation one = operation(0.3);
  one.lead_in = {LeadShape::line, 0.3, 0, 90};
  EXPECT_THROW(plan_of(ring, one), Error);
  one.lead_in = {LeadShape::arc, 0, 0.3, 90};
  EXPECT_THROW(plan_of(ring, one), Error);
  one.lead_in = {LeadShape::line, 0.3, 0, 90};
  EXPECT_NO_THROW(plan_of({square(0, 40), square(10, 20), square(11, 18)}, one));
}

TEST(neighbours, open_contours_run_in_the_direction_that_is_asked_for) {
  Random random(63);
  for (const OrderSearch search :
       {OrderSearch::improved, OrderSearch::nearest, OrderSearch::genetic}) {
    for (const std::size_t count : {1u, 6u, 30u}) {
      std::vector<Shape> shapes;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec from{100 * random.uniform(), 100 * random.uniform()};
        const Contour line{{{from, from + Vec{1 + 9 * random.uniform(), 5}, {}, 0}}};
        shapes.push_back({line, {}, 0});
        if (i % 3 == 2) shapes.push_back({circle(from + Vec{200, 0}, 2), {}, 0});
      }
      const auto run = [&](Direction direction, Compensation side) {
        Operation one = operation(1);
        one.direction = direction;
        one.compensation = side;
        place_shapes(shapes, {one});
        return plan_cuts(shapes, {one}, {0, 0}, {search, 10});
      };
      const auto is_along = [&](const PlannedCut& cut, double sign) {
        const Edge& drawn = shapes[cut.shape].contour.edges.front();
        const Edge& beam = cut.strokes.front().front().edge;
        return shapes[cut.shape].contour.closed ||
               dot(drawn.to - drawn.from, beam.to - beam.from) * sign > 0;
      };
      for (const PlannedCut& cut : run(Direction::drawn, Compensation::none).cuts)
        EXPECT_TRUE(is_along(cut, 1));
      for (const PlannedCut& cut : run(Direction::reversed, Compensation::none).cuts)
        EXPECT_TRUE(is_along(cut, -1));
      for (const PlannedCut& cut : run(Direction::automatic, Compensation::left).cuts)
        EXPECT_TRUE(is_along(cut, 1)) << "left of the direction of the cut";
      const auto back = run(Direction::reversed, Compensation::left);
      for (const PlannedCut& cut : back.cuts) EXPECT_TRUE(is_along(cut, -1));
    }
  }
}

TEST(neighbours, engravings_do_not_cross_wide_gaps_at_the_feed) {
  const Contour frame = square(-100, 800), window = square(-90, 780);
  const std::vector<Contour> drawing{square(0, 10), square(500, 10), square(3, 4), frame, window};
  Operation one = operation(0);
  one.kind = OperationKind::engrave;
  one.hatch_mm = 1;
  one.overscan_mm = 2;
  const auto measure = [&](double max_gap_mm) {
    one.max_gap_mm = max_gap_mm;
    double lit = 0, max_gap_travel_mm = 0;
    for (const PlannedCut& cut : plan_of(drawing, one).cuts)
      for (const Stroke& stroke : cut.strokes)
        for (const CutMove& move : stroke) {
          if (move.power > 0)
            lit += length_of(move.edge);
          else
            max_gap_travel_mm = std::max(max_gap_travel_mm, length_of(move.edge));
        }
    return std::pair(lit, max_gap_travel_mm);
  };
  const auto whole = measure(std::numeric_limits<double>::infinity()), divided = measure(40);
  EXPECT_NEAR(divided.first, whole.first, 1e-6);
  EXPECT_GT(whole.second, 250);
  EXPECT_LE(divided.second, 40);
}

TEST(neighbours, distant_engravings_are_filled_one_after_the_other) {
  Operation one = operation(0);
  one.kind = OperationKind::engrave;
  one.hatch_mm = 0.1;
  one.overscan_mm = 2;
  one.max_gap_mm = 40;
  const Contour right = polygon({{500, 0}, {510, 0}, {510, 10}, {500, 10}});
  EXPECT_LT(plan_of({square(0, 10), right}, one).rapid_mm, 2000);
}

}  // namespace
}  // namespace lamplock::cutting::neighbours_test
