// What is near in a drawing: places, rectangles, groups of contours, compared with all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour_groups.hpp"
#include "host/cutting/offset.hpp"
#include "host/cutting/place_grid.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::near_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

Vec any_place(Random& random, double side_mm) {
  return {side_mm * (random.uniform() - 0.5), side_mm * (random.uniform() - 0.5)};
}

/// An arc of up to a full turn, or a line.
Edge any_edge(Random& random) {
  const Vec centre = any_place(random, 20), from = centre + any_place(random, 6);
  if (random.uniform() < 0.3) return {from, centre, {}, 0};
  return arc_from(centre, from, 4 * pi * (random.uniform() - 0.5));
}

TEST(near, a_grid_finds_each_place_within_reach_once) {
  Random random(51);
  for (int i = 0; i < scaled(40, 4); ++i) {
    const double reach = std::pow(10.0, -9 + i % 12), side = reach * (1 + 60 * random.uniform());
    const Vec middle = i % 3 == 0 ? Vec{} : Vec{1e6 * reach, -3e5 * reach};
    std::vector<Vec> places;
    PlaceGrid grid(reach, random.next() % 300);
    for (std::size_t k = 0; k < 300; ++k) {
      // Some are the same, some are exactly at the reach.
      const Vec at = k % 10 == 9   ? places[random.next() % k]
                     : k % 10 == 8 ? places[random.next() % k] + Vec{reach, 0}
                                   : middle + any_place(random, side);
      places.push_back(at);
      grid.add(at, k);
    }
    for (std::size_t k = 0; k < places.size(); ++k) {
      std::multiset<std::size_t> found, expected;
      grid.visit(places[k], [&](std::size_t number) { found.insert(number); });
      for (std::size_t j = 0; j < places.size(); ++j) {
        if (std::abs(places[j].x - places[k].x) <= reach &&
            std::abs(places[j].y - places[k].y) <= reach)
          expected.insert(j);
      }
      ASSERT_EQ(found, expected);
      ASSERT_TRUE(grid.any(places[k], [&](std::size_t number) { return number == k; }));
      ASSERT_FALSE(grid.any(places[k], [](std::size_t) { return false; }));
    }
  }
}

TEST(near, a_tree_finds_the_boxes_that_meet_another_or_a_circle) {
  Random random(52);
  for (int i = 0; i < scaled(20, 3); ++i) {
    std::vector<Edge> edges;
    for (auto k = random.next() % 200; k > 0; --k) edges.push_back(any_edge(random));
    const BoxTree tree = tree_of(edges);
    for (int k = 0; k < 50; ++k) {
      const Vec at = any_place(random, 24);
      const double reach = 3 * random.uniform();
      const Box box = Box{at, at}.grown(reach);
      std::set<std::size_t> found, expected, near, expected_near;
      tree.visit(box, [&](std::size_t number) { found.insert(number); });
      tree.any_near(at, reach, [&](std::size_t number) {
        near.insert(number);
        return false;
      });
      for (std::size_t j = 0; j < edges.size(); ++j) {
        const Box other = box_of(edges[j]);
        if (other.meets(box)) expected.insert(j);
        const Vec nearest{std::clamp(at.x, other.low.x, other.high.x),
                          std::clamp(at.y, other.low.y, other.high.y)};
        if (distance(nearest, at) <= reach) expected_near.insert(j);
      }
      ASSERT_EQ(found, expected);
      ASSERT_EQ(near, expected_near);
    }
  }
}

TEST(near, boxes_of_edges_are_those_of_their_points) {
  Random random(53);
  for (int i = 0; i < scaled(400, 40); ++i) {
    Edge edge = any_edge(random);
    if (i % 7 == 0) edge = arc_from({1, 2}, {4, 2}, (i % 2 == 0 ? 2 : -2) * pi);
    if (i % 7 == 1) edge = arc_from({1, 2}, {1, 5}, (i % 2 == 0 ? 1 : -1) * pi);
    constexpr int parts = 720;
    Box sampled;
    for (int k = 0; k <= parts; ++k) sampled.add(point_at(edge, double(k) / parts));
    const Box box = box_of(edge);
    // Between two samples an arc rises by up to its sagitta.
    const double slack = 1e-9 + (edge.is_line() ? 0 : radius_of(edge) * 1e-4);
    EXPECT_TRUE(box.grown(1e-9).contains(sampled));
    EXPECT_TRUE(sampled.grown(slack).contains(box));
  }
}

/// The smallest distance of points on `a` from `b`.
double apart(const Contour& a, const Contour& b) {
  double nearest = 1e9;
  for (const Edge& edge : a.edges) {
    for (const double part : {0.0, 0.2, 0.4, 0.6, 0.8}) {
      for (const Edge& other : b.edges)
        nearest = std::min(nearest, distance_to(other, point_at(edge, part)));
    }
  }
  return nearest;
}

TEST(near, groups_of_contours_are_apart) {
  Random random(54);
  std::size_t groups_in_all = 0, contours_in_all = 0;
  for (int i = 0; i < scaled(16, 4); ++i) {
    std::vector<Contour> contours{rounded_rectangle({-70, -70}, 140, 140, 3)};
    for (int k = 0; k < 25; ++k)
      contours.push_back(random_star(random, any_place(random, 120), 1, 2 + 6 * random.uniform(),
                                     5 + int(random.next() % 20)));
    const double reach = 3 * random.uniform();
    std::vector<std::size_t> group(contours.size(), contours.size());
    const auto groups = contour_groups(contours, reach);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      EXPECT_TRUE(std::is_sorted(groups[g].begin(), groups[g].end()));
      for (const std::size_t number : groups[g]) {
        EXPECT_EQ(group[number], contours.size()) << "in one group only";
        group[number] = g;
      }
    }
    for (std::size_t a = 0; a < contours.size(); ++a) {
      ASSERT_LT(group[a], groups.size());
      for (std::size_t b = 0; b < contours.size(); ++b) {
        if (group[a] != group[b]) {
          ASSERT_GT(apart(contours[a], contours[b]), reach);
        }
      }
    }
    groups_in_all += groups.size();
    contours_in_all += contours.size();
  }
  EXPECT_GT(groups_in_all, contours_in_all / 4) << "the frame is around all, but near few";
}

TEST(near, a_sheet_is_compensated_as_its_parts) {
  Random random(55);
  std::vector<Contour> sheet{rounded_rectangle({-20, -20}, 440, 240, 2)};
  std::vector<std::size_t> expected_from;
  std::vector<Contour> expected;
  const OffsetOptions options{.distance_mm = 0.7};
  const auto add = [&](const std::vector<Contour>& part, std::size_t first) {
    const OffsetContours moved = offset(part, options);
    for (std::size_t k = 0; k < moved.contours.size(); ++k) {
      expected.push_back(moved.contours[k]);
      expected_from.push_back(first + moved.from[k]);
    }
  };
  add(sheet, 0);
  for (int i = 0; i < scaled(40, 8); ++i) {
    const Vec centre{40.0 * (i % 10), 40.0 * (i / 10)};
    const std::vector<Contour> part{random_star(random, centre, 9, 18, 12),
                                    reversed(random_star(random, centre, 2, 7, 9))};
    add(part, sheet.size());
    sheet.insert(sheet.end(), part.begin(), part.end());
  }
  const OffsetContours moved = offset(sheet, options);
  ASSERT_EQ(moved.from, expected_from);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(signed_area(moved.contours[i]), signed_area(expected[i]), 1e-9);
    EXPECT_NEAR(length_of(moved.contours[i]), length_of(expected[i]), 1e-9);
  }
}

}  // namespace
}  // namespace lamplock::cutting::near_test
