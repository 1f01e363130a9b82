// Lines that fill contours: against the parity of contours around sampled points.
#include "host/cutting/hatch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "host/error.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::hatch_test {
namespace {

using geometry::Random;
using namespace lamplock::test;

double length_of_rows(const std::vector<HatchRow>& rows) {
  double length = 0;
  for (const HatchRow& row : rows)
    for (const HatchPiece& piece : row) length += distance(piece.from, piece.to);
  return length;
}

bool is_filled(const std::vector<Contour>& contours, const Vec& at) {
  std::size_t around = 0;
  for (const Contour& contour : contours) around += is_inside(contour, at) ? 1U : 0U;
  return around % 2 == 1;
}

TEST(hatch, square_with_a_hole) {
  const std::vector<Contour> contours{polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}}),
                                      polygon({{4, 4}, {6, 4}, {6, 6}, {4, 6}})};
  const std::vector<HatchRow> rows = hatch(contours, {1, 0});
  ASSERT_EQ(rows.size(), 10u);
  EXPECT_EQ(rows[0].size(), 1u);
  EXPECT_EQ(rows[0][0].from, (Vec{0, 0.5}));
  EXPECT_EQ(rows[0][0].to, (Vec{10, 0.5}));
  ASSERT_EQ(rows[4].size(), 2u);
  EXPECT_EQ(rows[4][0].to, (Vec{4, 4.5}));
  EXPECT_EQ(rows[4][1].from, (Vec{6, 4.5}));
  EXPECT_DOUBLE_EQ(length_of_rows(rows), 96);
}

TEST(hatch, lines_are_where_an_odd_number_of_contours_is_around) {
  Random random(91);
  for (int i = 0; i < scaled(60, 12); ++i) {
    std::vector<Contour> contours{random_star(random, {0, 0}, 8, 20, 11),
                                  reversed(random_star(random, {1, 1}, 2, 6, 7)),
                                  circle({30, 5}, 1 + 6 * random.uniform())};
    const HatchOptions options{0.05 + random.uniform(), 360 * (random.uniform() - 0.5)};
    const std::vector<HatchRow> rows = hatch(contours, options);
    const double angle = options.angle_deg * std::numbers::pi / 180;
    const Vec along{std::cos(angle), std::sin(angle)};
    double area = 0;
    for (const Contour& contour : contours) area += signed_area(contour);
    EXPECT_NEAR(length_of_rows(rows) * options.distance_mm, area, 20 * options.distance_mm);
    for (const HatchRow& row : rows) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        const Vec piece = row[k].to - row[k].from;
        EXPECT_NEAR(cross(piece, along), 0, 1e-9);
        EXPECT_GT(dot(piece, along), 0);
        EXPECT_TRUE(is_filled(contours, row[k].from + piece * (0.01 + 0.98 * random.uniform())));
        if (k > 0) {
          EXPECT_FALSE(is_filled(contours, (row[k - 1].to + row[k].from) * 0.5));
        }
      }
    }
  }
}

/// What a picture shows: each area by its rule over those before it; where there is none, the
/// other contours by the even-odd rule.
bool is_painted(const std::vector<Contour>& contours, const Vec& at) {
  std::optional<bool> painted;
  for (std::uint32_t area = 1; area <= 3; ++area) {
    std::vector<Contour> outline;
    for (const Contour& contour : contours)
      if (contour.area == area) outline.push_back(contour);
    if (outline.empty()) continue;
    const int turns = turns_around(outline, at);
    const bool is_even_odd = outline.front().fill_rule == model::FillRule::even_odd;
    if (is_even_odd ? turns % 2 != 0 : turns != 0) painted = !outline.front().covers;
  }
  if (painted) return *painted;
  bool is_odd = false;
  for (const Contour& contour : contours)
    if (contour.area == 0 && turns_around({contour}, at) % 2 != 0) is_odd = !is_odd;
  return is_odd;
}

TEST(hatch, the_area_painted_last_decides) {
  Random random(92);
  for (int i = 0; i < scaled(80, 15); ++i) {
    std::array<model::FillRule, 4> rules{};
    for (model::FillRule& rule : rules)
      rule = random.uniform() < 0.5 ? model::FillRule::even_odd : model::FillRule::non_zero;
    const std::uint64_t cover = 1 + random.next() % 5;  // also none
    std::vector<Contour> contours;
    for (int k = 0; k < 6; ++k) {
      const Vec centre{12 * random.uniform(), 12 * random.uniform()};
      Contour star = random_star(random, centre, 3, 9, 7);
      if (random.uniform() < 0.3)  // crosses itself
        star = polygon({centre, centre + Vec{8, 5}, centre + Vec{8, 0}, centre + Vec{0, 5}});
      if (random.uniform() < 0.5) star = reversed(star);
      star.area = static_cast<std::uint32_t>(random.next() % 4);
      star.fill_rule = rules[star.area];
      star.covers = star.area == cover;
      contours.push_back(star);
    }
    const HatchOptions options{0.3, 360 * random.uniform()};
    const double angle = options.angle_deg * std::numbers::pi / 180;
    const Vec along{std::cos(angle), std::sin(angle)};
    for (const HatchRow& row : hatch(contours, options)) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        const Vec piece = row[k].to - row[k].from;
        if (norm(piece) > 0.01) {
          const double part = 0.3 + 0.4 * random.uniform();
          ASSERT_TRUE(is_painted(contours, row[k].from + piece * part)) << i;
        }
        const Vec before = k > 0 ? row[k - 1].to : row[k].from - along * 5;
        const Vec gap = row[k].from - before;
        if (norm(gap) > 0.01) {
          ASSERT_FALSE(is_painted(contours, before + gap * (k > 0 ? 0.5 : 0.999))) << i;
        }
      }
    }
  }
}

TEST(hatch, corners_on_a_line_and_circles_are_filled_once) {
  // Corners at the heights of lines: 0.5, 1.5, ...
  const std::vector<Contour> zigzag{
      polygon({{0, 0}, {8, 0}, {8, 1.5}, {6, 2.5}, {4, 1.5}, {2, 2.5}, {0, 1.5}})};
  const std::vector<HatchRow> rows = hatch(zigzag, {1, 0});
  ASSERT_EQ(rows.size(), 2u) << "tips at the height of a line are nothing";
  for (const HatchRow& row : rows) {
    ASSERT_FALSE(row.empty());
    EXPECT_EQ(row.front().from.x, 0);
    EXPECT_EQ(row.back().to.x, 8);
  }
  for (const double angle : {0.0, 30.0, 90.0, 180.0}) {
    const std::vector<HatchRow> disc = hatch({circle({3, 4}, 5)}, {0.01, angle});
    EXPECT_EQ(disc.size(), 1000u);
    EXPECT_NEAR(length_of_rows(disc) * 0.01, 25 * std::numbers::pi, 0.01);
  }
}

TEST(hatch, refuses_distances_and_skips_open_contours) {
  const Contour square = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
  EXPECT_THROW(hatch({square}, {0, 0}), Error);
  EXPECT_THROW(hatch({square}, {-1, 0}), Error);
  EXPECT_THROW(hatch({square}, {std::nan(""), 0}), Error);
  EXPECT_THROW(hatch({square}, {1e-9, 0}), Error);
  Contour open = square;
  open.closed = false;
  EXPECT_TRUE(hatch({open}, {1, 0}).empty());
  EXPECT_TRUE(hatch({}, {1, 0}).empty());
}

}  // namespace
}  // namespace lamplock::cutting::hatch_test
