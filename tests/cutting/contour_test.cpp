// Contours: joined from curves in any order and direction; duplicates, gaps, crossings; the tree.
#include "host/cutting/contour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "host/error.hpp"
#include "host/model/spline.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::contour_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

void expect_connected(const Contour& contour) {
  for (std::size_t i = 0; i < contour.edges.size(); ++i) {
    const bool is_last = i + 1 == contour.edges.size();
    if (is_last && !contour.closed) continue;
    EXPECT_EQ(contour.edges[i].to, contour.edges[is_last ? 0 : i + 1].from);
  }
  for (const Edge& edge : contour.edges) {
    if (edge.is_line()) continue;
    EXPECT_NEAR(distance(edge.to, edge.centre), radius_of(edge), 1e-9);
    EXPECT_NEAR(distance(arc_from(edge.centre, edge.from, edge.sweep).to, edge.to), 0, 1e-9);
  }
}

TEST(contour, length_and_area_of_lines_and_arcs) {
  // N. Ausmanas, "Analysis of nonmetallic materials cutting by low power diode laser", 2017: the
  // rounded rectangle of its test cuts, 60 x 20 mm, corner radius 3 mm.
  const Contour rectangle = rounded_rectangle({-1e4, 7}, 60, 20, 3);
  EXPECT_NEAR(length_of(rectangle), 154.8496, 0.00005);
  EXPECT_NEAR(signed_area(rectangle), 1200 - (4 - pi) * 9, 1e-9);
  EXPECT_NEAR(signed_area(reversed(rectangle)), -(1200 - (4 - pi) * 9), 1e-9);
  EXPECT_NEAR(length_of(circle({3, 4}, 3.75)), 23.5619, 0.00005);
  EXPECT_NEAR(signed_area(circle({3, 4}, 2)), 4 * pi, 1e-12);
}

TEST(contour, area_and_length_agree_with_fine_polylines) {
  Random random(1);
  for (int i = 0; i < scaled(100, 10); ++i) {
    const Contour star = random_star(random, {5, -3}, 4, 20, 12);
    double length = 0, area = 0;
    constexpr int parts = 2000;
    for (const Edge& edge : star.edges) {
      for (int k = 0; k < parts; ++k) {
        const Vec p = point_at(edge, double(k) / parts), q = point_at(edge, double(k + 1) / parts);
        length += distance(p, q);
        area += cross(p, q) / 2;
      }
    }
    EXPECT_NEAR(length_of(star), length, 1e-4);
    EXPECT_NEAR(signed_area(star), area, 1e-3);
    EXPECT_TRUE(contour_faults({star}).empty());
  }
}

TEST(contour, scattered_edges_become_the_same_contours) {
  Random random(2);
  for (int i = 0; i < scaled(100, 10); ++i) {
    std::vector<Contour> parts;
    parts.reserve(6);
    for (int k = 0; k < 6; ++k) parts.push_back(random_star(random, {50.0 * k, 0}, 5, 20, 5 + k));
    const double noise = i % 2 == 0 ? 0 : 0.002;
    const JoinedContours joined = join_contours(scattered(parts, random, noise), {});
    ASSERT_EQ(joined.contours.size(), parts.size());
    for (const Contour& contour : joined.contours) {
      expect_connected(contour);
      ASSERT_TRUE(contour.closed);
      const auto part = static_cast<std::size_t>(
          std::lround((box_of(contour).low.x + box_of(contour).high.x) / 100));
      EXPECT_EQ(contour.edges.size(), parts[part].edges.size());
      EXPECT_NEAR(std::abs(signed_area(contour)), signed_area(parts[part]), 1e-6 + noise * 200);
      EXPECT_NEAR(length_of(contour), length_of(parts[part]), 1e-6 + noise * 40);
    }
    EXPECT_EQ(count_of(joined.faults, FaultKind::gap), 0u);
    for (const Fault& fault : joined.faults) EXPECT_LE(fault.size_mm, 2 * noise);
  }
}

TEST(contour, gaps_beyond_the_tolerance_are_reported_with_place_and_size) {
  const model::Curves curves =
      of_one_layer({line_path({0, 0}, {10, 0}), line_path({10, 0.004}, {10, 10}),
                    line_path({0.3, 10}, {0, 0}), line_path({10, 10}, {0.5, 10})});
  const JoinedContours joined = join_contours(curves, {});
  ASSERT_EQ(joined.contours.size(), 1u);
  EXPECT_FALSE(joined.contours[0].closed);
  EXPECT_EQ(joined.contours[0].edges.size(), 4u);
  ASSERT_EQ(count_of(joined.faults, FaultKind::bridged_gap), 1u);
  ASSERT_EQ(count_of(joined.faults, FaultKind::gap), 2u);
  for (const Fault& fault : joined.faults) {
    if (fault.kind == FaultKind::bridged_gap) {
      EXPECT_NEAR(fault.size_mm, 0.004, 1e-12);
      EXPECT_NEAR(distance(fault.at, {10, 0.002}), 0, 1e-9);
    } else {
      EXPECT_NEAR(fault.size_mm, 0.2, 1e-12);
      EXPECT_NEAR(fault.at.y, 10, 1e-9);
      EXPECT_EQ(fault.contour, 0u);
    }
  }
  JoinOptions wide;
  wide.tolerance_mm = 0.25;
  EXPECT_TRUE(join_contours(curves, wide).contours.at(0).closed);
  wide.tolerance_mm = 0;
  EXPECT_THROW(join_contours(curves, wide), Error);
}

TEST(contour, curves_of_different_layers_are_not_joined) {
  model::Curves curves;
  curves.layers = {"cut", "score"};
  curves.paths = {line_path({0, 0}, {1, 0}), line_path({1, 0}, {2, 0}), line_path({2, 0}, {3, 0})};
  curves.paths[2].layer = 1;
  EXPECT_EQ(join_contours(curves, {}).contours.size(), 2u);
}

TEST(contour, a_joint_of_many_curves_continues_straight) {
  model::Curves curves = of_one_layer({});
  for (int i = 0; i < 8; ++i)
    curves.paths.push_back(line_path({0, 0}, {std::cos(pi * i / 4), std::sin(pi * i / 4)}));
  const JoinedContours joined = join_contours(curves, {});
  ASSERT_EQ(joined.contours.size(), 4u);
  for (const Contour& contour : joined.contours)
    EXPECT_NEAR(distance(contour.edges.front().from, contour.edges.back().to), 2, 1e-9);
}

// Where squares touch at corners four ends meet, where a line begins at a corner three.
TEST(contour, squares_that_touch_and_lines_from_corners_leave_closed_contours) {
  Random random(36);
  for (int round = 0; round < scaled(200); ++round) {
    std::vector<Contour> drawn;
    Vec low{0, 0};
    for (int i = 0; i < 4; ++i) {
      const double width = 2 + 8 * random.uniform(), height = 2 + 8 * random.uniform();
      drawn.push_back(
          polygon({low, low + Vec{width, 0}, low + Vec{width, height}, low + Vec{0, height}}));
      low = low + Vec{width, height};
    }
    const bool has_line = random.uniform() < 0.5;
    if (has_line) {
      // Away from the first square, in any direction.
      const double turn = pi + pi / 2 * random.uniform();
      drawn.push_back({{Edge{{0, 0}, {3 * std::cos(turn), 3 * std::sin(turn)}, {}, 0}}, false});
    }
    const JoinedContours joined = join_contours(scattered(drawn, random, 0), {});
    ASSERT_EQ(joined.contours.size(), drawn.size()) << round;
    double area = 0, wanted = 0;
    for (const Contour& contour : joined.contours) area += std::abs(signed_area(contour));
    for (const Contour& contour : drawn) wanted += std::abs(signed_area(contour));
    EXPECT_NEAR(area, wanted, 1e-9);
    EXPECT_EQ(std::count_if(joined.contours.begin(), joined.contours.end(),
                            [](const Contour& contour) { return contour.closed; }),
              4);
  }
}

TEST(contour, duplicates_are_removed_however_they_are_drawn) {
  const model::Curves curves = of_one_layer(
      {circle_path({0, 0}, 5), arc_path({0, 0}, 5, 1, 1 + pi), arc_path({0, 0}, 5, 1, 1 - pi),
       line_path({9, 9}, {12, 9}), line_path({12, 9}, {9, 9}), circle_path({0.5, 0}, 5),
       line_path({20, 20}, {20, 20})});
  const JoinedContours joined = join_contours(curves, {});
  EXPECT_EQ(joined.contours.size(), 3u);
  EXPECT_EQ(count_of(joined.faults, FaultKind::duplicate), 2u);
  EXPECT_EQ(count_of(joined.faults, FaultKind::dot), 1u);
  for (const Fault& fault : joined.faults) {
    if (fault.kind != FaultKind::duplicate) continue;
    ASSERT_TRUE(fault.contour.has_value());
    EXPECT_NEAR(fault.size_mm, *fault.contour == 0 ? 10 * pi : 3, 1e-9);
  }
}

TEST(contour, ellipses_and_splines_become_arcs_within_the_tolerance) {
  Random random(3);
  for (int i = 0; i < scaled(60, 6); ++i) {
    const auto any = [&] { return 40 * random.uniform() - 20; };
    model::Path path;
    if (i % 2 == 0) {
      path.pieces = {
          model::Arc{{any(), any(), 3}, {any(), any(), 1}, {any(), any(), 0}, 0, 2 * pi}};
      path.closed = true;
    } else {
      std::vector<geometry::Point> poles;
      poles.reserve(4);
      for (int k = 0; k < 4; ++k) poles.push_back({any(), any(), 0});
      path.pieces = {model::bezier(std::move(poles))};
    }
    const std::vector<Edge> edges = edges_of(path, 0.001);
    EXPECT_LT(edges.size(), 400u);
    double max_sweep_rad = 0;
    for (const Edge& edge : edges) max_sweep_rad = std::max(max_sweep_rad, std::abs(edge.sweep));
    EXPECT_GT(max_sweep_rad, 0.01);
    // Both ways: each point of the curve is near an edge, each point of an edge near the curve.
    geometry::PointCloud vertices = model::flattened(path, 0.0002);
    for (std::size_t k = 0; k < vertices.size(); k += 5) {
      double nearest = 1e9;
      for (const Edge& edge : edges)
        nearest = std::min(nearest, distance_to(edge, {vertices[k].x, vertices[k].y}));
      EXPECT_LE(nearest, 0.0013);
    }
    for (const Edge& edge : edges) {
      double nearest = 1e9;
      for (std::size_t k = 0; k + 1 < vertices.size(); ++k)
        nearest = std::min(
            nearest,
            distance_to(
                {{vertices[k].x, vertices[k].y}, {vertices[k + 1].x, vertices[k + 1].y}, {}, 0},
                point_at(edge, 0.37)));
      EXPECT_LE(nearest, 0.0013);
    }
  }
}

/// An arc of an ellipse that runs backwards (SVG: sweep flag 0) is its mirror image's equal.
TEST(contour, arcs_of_ellipses_have_as_many_edges_in_both_directions) {
  Random random(4);
  for (int i = 0; i < scaled(100, 10); ++i) {
    const auto any = [&] { return 40 * random.uniform() - 20; };
    model::Arc forwards{{any(), any(), 0}, {any(), any(), 0}, {any(), any(), 0}, any() / 10, 0};
    forwards.end = forwards.start + 2 * pi * random.uniform();
    model::Arc backwards = forwards;
    std::swap(backwards.start, backwards.end);
    model::Path path, reversed_path;
    path.pieces = {forwards};
    reversed_path.pieces = {backwards};
    const std::vector<Edge> edges = edges_of(path, 0.001), back = edges_of(reversed_path, 0.001);
    EXPECT_LT(back.size(), 2 * edges.size() + 4) << i;
    double length = 0, back_length = 0;
    for (const Edge& edge : edges) length += length_of(edge);
    for (const Edge& edge : back) back_length += length_of(edge);
    EXPECT_NEAR(back_length, length, 1e-5 * length + 1e-5) << i;
    EXPECT_NEAR(distance(back.front().from, edges.back().to), 0, 1e-9);
    EXPECT_NEAR(distance(back.back().to, edges.front().from), 0, 1e-9);
  }
}

TEST(contour, crossings_are_reported_and_touches_are_not) {
  // A bow tie: its crossing cuts off a loop of half the length.
  const Contour bow = polygon({{0, 0}, {10, 10}, {10, 0}, {0, 10}});
  std::vector<Fault> faults = contour_faults({bow});
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, FaultKind::self_intersection);
  EXPECT_NEAR(distance(faults[0].at, {5, 5}), 0, 1e-9);
  EXPECT_NEAR(faults[0].size_mm, length_of(bow) / 2, 1e-9);

  const Contour square = polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  EXPECT_EQ(contour_faults({square, circle({4, 2}, 1)}).size(), 2u);
  EXPECT_TRUE(contour_faults({square, circle({5, 2}, 1)}).empty()) << "touches from outside";
  EXPECT_TRUE(contour_faults({square, circle({3, 2}, 1)}).empty()) << "touches from inside";
  EXPECT_TRUE(contour_faults({square, polygon({{4, 4}, {8, 4}, {8, 8}, {4, 8}})}).empty());
  // A crossing exactly at a corner of both is one fault.
  const Contour diamond = polygon({{4, 0}, {8, 4}, {4, 4}, {2, 2}});
  const Contour through = {{{{0, 8}, {4, 4}, {}, 0}, {{4, 4}, {7, 1}, {}, 0}}, false};
  EXPECT_EQ(contour_faults({square, through}).size(), 0u) << "runs past a corner";
  EXPECT_EQ(contour_faults({diamond, through}).size(), 2u);

  faults = contour_faults({square, polygon({{4, 1}, {8, 1}, {8, 3}, {4, 3}})});
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, FaultKind::overlap);
  EXPECT_NEAR(faults[0].size_mm, 2, 1e-9);
  EXPECT_NEAR(distance(faults[0].at, {4, 2}), 0, 1e-9);
}

TEST(contour, closed_curves_of_no_size_are_left_out) {
  const std::vector<double> radii_mm{1e-9, 1e-6, 1e-5, 0.001, 0.002, 0.01, 1};
  std::vector<model::Path> paths;
  for (std::size_t i = 0; i < radii_mm.size(); ++i)
    paths.push_back(circle_path({5.0 * double(i), 0}, radii_mm[i]));
  const JoinedContours joined = join_contours(of_one_layer(paths), {});
  ASSERT_EQ(joined.contours.size(), 3u) << "those of more than 0.01 mm";
  EXPECT_EQ(count_of(joined.faults, FaultKind::dot), 4u);
}

TEST(contour, number_of_faults_is_limited) {
  std::vector<Contour> grid;
  for (int i = 0; i < 60; ++i) {
    grid.push_back({{{{0.0, i + 0.5}, {60.0, i + 0.5}, {}, 0}}, false});
    grid.push_back({{{{i + 0.5, 0.0}, {i + 0.5, 60.0}, {}, 0}}, false});
  }
  EXPECT_EQ(contour_faults(grid, 5000).size(), 3600u);
  EXPECT_EQ(contour_faults(grid, 100).size(), 100u);
}

/// Rings of stars in each other, with several children each; the expected parent of each.
void nest(Random& random, Vec centre, double radius, int levels, std::optional<std::size_t> parent,
          std::vector<Contour>& contours, std::vector<std::optional<std::size_t>>& parents) {
  const std::size_t number = contours.size();
  Contour star = random_star(random, centre, 0.9 * radius, radius, 9 + int(random.next() % 9));
  contours.push_back(random.uniform() < 0.5 ? star : reversed(star));
  parents.push_back(parent);
  if (levels == 0) return;
  const auto children = random.next() % 4;
  for (std::size_t i = 0; i < children; ++i) {
    const double turn = 2 * pi * (double(i) + 0.2 * random.uniform()) / double(children);
    const double away = children == 1 ? 0 : 0.45 * radius;
    nest(random, centre + Vec{away * std::cos(turn), away * std::sin(turn)},
         radius * (children == 1 ? 0.6 : 0.25), levels - 1, number, contours, parents);
  }
}

TEST(contour, tree_has_the_parents_of_random_nests) {
  Random random(4);
  for (int i = 0; i < scaled(200, 10); ++i) {
    std::vector<Contour> contours;
    std::vector<std::optional<std::size_t>> parents;
    for (int part = 0; part < 4; ++part)
      nest(random, {100.0 * part, 0}, 40, 4, std::nullopt, contours, parents);
    const std::vector<ContourPlace> places = contour_tree(contours);
    for (std::size_t k = 0; k < contours.size(); ++k) {
      ASSERT_EQ(places[k].parent, parents[k]);
      const std::size_t depth = parents[k] ? places[*parents[k]].depth + 1 : 0;
      EXPECT_EQ(places[k].depth, depth);
      EXPECT_EQ(places[k].kind, depth == 0       ? ContourKind::outside
                                : depth % 2 == 1 ? ContourKind::hole
                                                 : ContourKind::island);
    }
  }
}

/// The corners of a polygon moved and turned, from any of them on, in any direction.
Contour drawn_anyhow(std::vector<Vec> corners, double turn, const Vec& to, Random& random) {
  for (Vec& corner : corners) corner = to + turned(corner, turn);
  const auto first = static_cast<std::ptrdiff_t>(random.next() % corners.size());
  std::rotate(corners.begin(), corners.begin() + first, corners.end());
  const Contour contour = polygon(corners);
  return random.uniform() < 0.5 ? contour : reversed(contour);
}

/// The side of the beam follows from the place, so it may not depend on the begin of a curve.
TEST(contour, tree_of_contours_that_touch_along_their_sides) {
  const std::vector<Vec> square{{0, 0}, {50, 0}, {50, 50}, {0, 50}};
  const std::vector<Vec> mouth{{50, 0},  {0, 0},  {0, 10}, {30, 10},
                               {30, 40}, {0, 40}, {0, 50}, {50, 50}};
  struct Pair {
    std::vector<Vec> outer, inner;
    ContourKind kind;
  };
  const std::vector<Pair> pairs{
      {square, {{40, 0}, {50, 0}, {50, 10}, {40, 10}}, ContourKind::hole},
      {square, {{0, 20}, {50, 20}, {50, 20.5}, {0, 20.5}}, ContourKind::hole},
      {square, {{0, 0}, {50, 0}, {50, 49.9}, {0, 49.9}}, ContourKind::hole},
      {square, {{50, 0}, {100, 0}, {100, 50}, {50, 49}}, ContourKind::outside},
      {mouth, {{0, 10}, {30, 10}, {30, 40}, {0, 40}}, ContourKind::outside},
      {mouth, {{0, 10}, {30, 10}, {30, 10.2}, {0, 10.2}}, ContourKind::outside},
      {mouth, {{30, 10}, {50, 10}, {50, 40}, {30, 40}}, ContourKind::hole}};
  Random random(11);
  for (int i = 0; i < scaled(300, 30); ++i) {
    const double turn = 2 * pi * random.uniform();
    const Vec to{1000 * random.uniform(), 1000 * random.uniform()};
    for (const Pair& pair : pairs) {
      const std::vector<ContourPlace> places = contour_tree(
          {drawn_anyhow(pair.outer, turn, to, random), drawn_anyhow(pair.inner, turn, to, random)});
      ASSERT_EQ(places[0].kind, ContourKind::outside) << i;
      ASSERT_EQ(places[1].kind, pair.kind) << i << ", pair " << &pair - pairs.data();
    }
  }
}

TEST(contour, tree_of_parts_that_share_a_side_and_of_open_lines) {
  const Contour square = polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  const Contour neighbour = polygon({{4, 0}, {8, 0}, {8, 4}, {4, 4}});
  const Contour mark = {{{{1, 1}, {2, 1}, {}, 0}}, false};
  const std::vector<ContourPlace> places = contour_tree({square, neighbour, mark});
  EXPECT_EQ(places[0].kind, ContourKind::outside);
  EXPECT_EQ(places[1].kind, ContourKind::outside);
  EXPECT_EQ(places[2].kind, ContourKind::open);
  EXPECT_EQ(places[2].parent, 0u);
}

}  // namespace
}  // namespace lamplock::cutting::contour_test
