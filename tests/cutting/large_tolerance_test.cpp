// Curves that are shorter than the tolerance of joining: outlines stay closed, and no piece is
// lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host/cutting/contour.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::large_tolerance_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

JoinedContours joined_within(const model::Curves& curves, double tolerance_mm) {
  JoinOptions options;
  options.tolerance_mm = tolerance_mm;
  return join_contours(curves, options);
}

double total_length(const std::vector<Contour>& contours) {
  double length = 0;
  for (const Contour& contour : contours) length += length_of(contour);
  return length;
}

/// Two lines that are as short as their distance: they are a part of the gap, and stay open.
TEST(large_tolerance, ends_that_no_tolerance_joins_have_no_distance) {
  const Contour low{{{{0, 0}, {0.3, 0}, {}, 0}}, false},
      high{{{{0, 0.2}, {0.3, 0.2}, {}, 0}}, false};
  Random random(62);
  for (const double tolerance_mm : {0.05, 0.5, 2.0}) {
    const JoinedContours joined = joined_within(scattered({low, high}, random, 0), tolerance_mm);
    for (const Fault& fault : joined.faults) {
      if (fault.kind != FaultKind::gap) continue;
      EXPECT_EQ(fault.size_mm > 0, tolerance_mm < 0.2) << tolerance_mm;
    }
    EXPECT_EQ(count_of(joined.faults, FaultKind::gap), tolerance_mm < 0.2 ? 4u : 2u);
  }
}

TEST(large_tolerance, outlines_of_short_pieces_are_joined_with_their_neighbours) {
  Random random(61);
  for (int i = 0; i < scaled(150, 30); ++i) {
    const int corners = 20 + static_cast<int>(random.next() % 200);
    std::vector<Contour> parts;
    parts.reserve(3);
    for (int k = 0; k < 3; ++k)
      parts.push_back(random_star(random, {45.0 * k, 0}, 17, 20, corners));
    double shortest = 1e9;
    for (const Contour& part : parts)
      for (const Edge& edge : part.edges)
        shortest = std::min(shortest, distance(edge.from, edge.to));
    // Gaps are far smaller than the pieces, the tolerance may be far larger.
    const double noise_mm = i % 2 == 0 ? 0 : 0.05 * shortest;
    const double tolerance_mm = 0.01 + 2 * noise_mm + 10 * random.uniform();
    const JoinedContours joined =
        joined_within(scattered(parts, random, noise_mm), std::min(10.0, tolerance_mm));
    ASSERT_EQ(joined.contours.size(), parts.size()) << i;
    for (const Contour& contour : joined.contours) EXPECT_TRUE(contour.closed) << i;
    EXPECT_EQ(count_of(joined.faults, FaultKind::duplicate), 0u) << i;
    EXPECT_EQ(count_of(joined.faults, FaultKind::dot), 0u) << i;
    double area = 0, wanted = 0;
    for (const Contour& contour : joined.contours) area += std::abs(signed_area(contour));
    for (const Contour& part : parts) wanted += std::abs(signed_area(part));
    EXPECT_NEAR(area, wanted, 1e-6 + noise_mm * 400) << i;
    EXPECT_NEAR(total_length(joined.contours), total_length(parts), 1e-6 + noise_mm * 6 * corners);
  }
}

TEST(large_tolerance, small_outlines_keep_their_shape) {
  Random random(62);
  std::vector<Contour> parts;
  for (int i = 0; i < 30; ++i) {
    const Vec low{2.0 * i, 3.0 * (i % 7)};
    const double side = 0.05 + 0.5 * random.uniform();
    parts.push_back(polygon({low, low + Vec{side, 0}, low + Vec{side, side}, low + Vec{0, side}}));
  }
  // Squares in a square, each thinner than the tolerance and wider than a beam.
  for (const double inset : {0.0, 0.2, 0.4, 0.6})
    parts.push_back(polygon({{inset, 40 + inset},
                             {9 - inset, 40 + inset},
                             {9 - inset, 49 - inset},
                             {inset, 49 - inset}}));
  for (const double tolerance_mm : {0.01, 0.1, 0.5, 1.0, 1.9}) {
    const JoinedContours joined = joined_within(scattered(parts, random, 0), tolerance_mm);
    EXPECT_EQ(joined.contours.size(), parts.size()) << tolerance_mm;
    EXPECT_TRUE(joined.faults.empty()) << tolerance_mm;
    EXPECT_NEAR(total_length(joined.contours), total_length(parts), 1e-9) << tolerance_mm;
  }
}

TEST(large_tolerance, the_ends_of_a_star_of_short_lines_are_found_among_many) {
  // More ends than are compared with each other lie within the tolerance.
  std::vector<Contour> parts;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 40; ++k) {
      const Vec low{0.2 * i, 0.2 * k};
      parts.push_back(polygon({low, low + Vec{0.1, 0}, low + Vec{0.05, 0.1}}));
    }
  }
  Random random(63);
  const JoinedContours joined = joined_within(scattered(parts, random, 0), 10);
  EXPECT_EQ(joined.contours.size(), parts.size());
  EXPECT_EQ(std::count_if(joined.contours.begin(), joined.contours.end(),
                          [](const Contour& contour) { return contour.closed; }),
            1600);
  EXPECT_TRUE(joined.faults.empty());
}

TEST(large_tolerance, duplicates_have_the_same_ends_and_the_same_way) {
  // Neighbours whose outer ends are within the tolerance, two arcs with common ends, a line and its
  // copy; a short line by itself.
  const model::Curves curves = of_one_layer(
      {line_path({0, 0}, {1, 0}), line_path({1, 0}, {2, 0}), arc_path({10, 0}, 1, 0, pi),
       arc_path({10, 0}, 1, 0, -pi), line_path({20, 0}, {21, 0}), line_path({21, 0.02}, {20, 0.02}),
       line_path({30, 0}, {30, 0.5}), line_path({40, 0}, {40, 0.001})});
  const JoinedContours joined = joined_within(curves, 2);
  EXPECT_EQ(count_of(joined.faults, FaultKind::duplicate), 1u);
  EXPECT_EQ(count_of(joined.faults, FaultKind::dot), 1u) << "0.001 mm";
  EXPECT_NEAR(total_length(joined.contours), 2 + 2 * pi + 1 + 0.5, 1e-9);
  EXPECT_EQ(joined.contours.size(), 4u);
}

}  // namespace
}  // namespace lamplock::cutting::large_tolerance_test
