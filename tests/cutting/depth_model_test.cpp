// Depth of cut: worked depths, fits and times of the source to the printed digit.
//
// Source of all tables: N. Ausmanas, "Analysis of nonmetallic materials cutting by low power diode
// laser", Kaunas University of Technology, 2017: a diode laser of 3 W with a square beam of 0.5 mm.
#include "host/cutting/depth_model.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/random.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::depth_model_test {
namespace {

const CutSetup pmma{{1.18, 2.0, 1}, 3, 0.5}, plywood{{0.524, 0.9, 1}, 3, 0.5},
    fibreboard{{0.67, 1.1, 1}, 3, 0.5};

/// Measured depth, and the printed minutes for 100 mm of one or two thicknesses.
struct Row {
  double feed_mm_s, depth_mm;
  std::vector<std::string> minutes;
};
// 6 and 12 mm. The source prints 0.22 and 0.12 mm for 10 mm/s, and times for the latter.
const std::vector<Row> pmma_rows{
    {0.5, 2.36, {"10.00", "16.00"}}, {0.75, 1.9, {"8.89", "15.56"}}, {1, 1.6, {"6.67", "13.33"}},
    {1.5, 1.2, {"5.56", "11.11"}},   {2, 0.9, {"5.83", "11.67"}},    {3, 0.56, {"6.11", "12.22"}},
    {4, 0.5, {"5.00", "10.00"}},     {5, 0.4, {"5.00", "10.00"}},    {6, 0.36, {"4.72", "9.44"}},
    {7, 0.28, {"5.24", "10.23"}},    {10, 0.12, {"8.33", "16.67"}}};
// 5 mm
const std::vector<Row> plywood_rows{{0.5, 1.2, {"16.67"}}, {1.5, 1.1, {"5.56"}},
                                    {2, 0.95, {"4.17"}},   {3, 0.8, {"3.88"}},
                                    {4, 0.4, {"5.42"}},    {6, 0.08, {"17.50"}}};
const std::vector<Row> fibreboard_rows{{0.5, 0.4, {"43.3"}},
                                       {1, 0.35, {"25.0"}},
                                       {1.5, 0.22, {"25.6"}},
                                       {2, 0.13, {"32.5"}},
                                       {3, 0.08, {"35.0"}}};

std::vector<MeasuredDepth> measured(const std::vector<Row>& rows) {
  std::vector<MeasuredDepth> depths;
  depths.reserve(rows.size());
  for (const Row& row : rows) depths.push_back({row.feed_mm_s, row.depth_mm});
  return depths;
}

std::string minutes(const Row& row, double thickness_mm, int digits) {
  const double time_s = cut_time_s(100, row.feed_mm_s, passes_through(thickness_mm, row.depth_mm));
  return fmt::format("{:.{}f}", time_s / 60, digits);
}

TEST(depth_model, worked_depths_of_four_beams) {
  const auto depth = [](const BeamShape& beam) {
    CutSetup setup = pmma;
    setup.beam_width_mm = effective_width_mm(beam);
    return fmt::format("{:.4f}", cut_depth_mm(setup, 1));
  };
  EXPECT_EQ(depth(RectangularBeam{0.5, 0.5}), "2.5424");
  EXPECT_EQ(depth(RectangularBeam{0.4, 0.6}), "2.5948");
  EXPECT_EQ(depth(EllipticBeam{0.25, 0.3}), "2.6188");
  EXPECT_EQ(depth(RoundBeam{0.25}), "2.8688");
}

TEST(depth_model, fits_of_the_measured_tables) {
  const auto text = [](const CutSetup& setup, const std::vector<MeasuredDepth>& depths) {
    const DepthFit fit = fit_depth(setup, depths);
    return fmt::format("{:.5f} {:.5f} {:.3f}{}", fit.correction.factor, fit.correction.exponent,
                       fit.rms, fit.is_poor() ? " poor" : "");
  };
  std::vector<MeasuredDepth> depths = measured(pmma_rows);
  EXPECT_EQ(text(pmma, depths), "0.67018 0.90940 0.177");
  depths.back().depth_mm = 0.22;
  EXPECT_EQ(text(pmma, depths), "0.71835 0.82350 0.068");
  EXPECT_EQ(text(plywood, measured(plywood_rows)), "0.09940 0.91338 0.600 poor");
  EXPECT_EQ(text(fibreboard, measured(fibreboard_rows)), "0.03511 0.92954 0.202");
  const DepthFit fit = fit_depth(plywood, measured(plywood_rows));
  EXPECT_EQ(fit.min_feed_mm_s, 0.5);
  EXPECT_EQ(fit.max_feed_mm_s, 6);
}

TEST(depth_model, printed_depths_of_the_corrected_model) {
  // With the printed constants for PMMA, B = 0.6709 and w = 0.9122.
  const std::vector<std::pair<double, std::string>> printed{
      {0.5, "2.91"}, {0.75, "2.01"}, {1, "1.55"}, {1.5, "1.07"}, {2, "0.82"}, {3, "0.57"},
      {4, "0.44"},   {5, "0.36"},    {6, "0.30"}, {7, "0.26"},   {10, "0.19"}};
  for (const auto& [feed_mm_s, depth] : printed)
    EXPECT_EQ(fmt::format("{:.2f}", cut_depth_mm(pmma, feed_mm_s, {0.6709, 0.9122})), depth);
}

TEST(depth_model, printed_times_except_errata) {
  for (const Row& row : pmma_rows) {
    EXPECT_EQ(minutes(row, 6, 2), row.minutes[0]) << row.feed_mm_s;
    // Six passes of 200 s, printed as 16 min; 10.238 min, printed without rounding.
    const std::string expected = row.feed_mm_s == 0.5 ? "20.00"
                                 : row.feed_mm_s == 7 ? "10.24"
                                                      : row.minutes[1];
    EXPECT_EQ(minutes(row, 12, 2), expected) << row.feed_mm_s;
  }
  for (const Row& row : plywood_rows) {
    // Six passes, printed as five; 3.889 min, printed without rounding.
    const std::string expected = row.feed_mm_s == 2   ? "5.00"
                                 : row.feed_mm_s == 3 ? "3.89"
                                                      : row.minutes[0];
    EXPECT_EQ(minutes(row, 5, 2), expected) << row.feed_mm_s;
  }
  for (const Row& row : fibreboard_rows)
    EXPECT_EQ(minutes(row, 5, 1), row.minutes[0]) << row.feed_mm_s;
}

TEST(depth_model, passes_are_whole_and_just_enough) {
  EXPECT_EQ(passes_through(3, 1.6), 2);
  EXPECT_EQ(passes_through(6, 0.36), 17);
  geometry::Random random(21);
  for (int i = 0; i < test::scaled(10000, 100); ++i) {
    // Depths with few digits that divide the thickness, as users write them.
    const double depth_mm = static_cast<double>(1 + random.next() % 300) / 100;
    const int wanted = 1 + static_cast<int>(random.next() % 60);
    EXPECT_EQ(passes_through(depth_mm * wanted, depth_mm), wanted);
    EXPECT_EQ(passes_through(depth_mm * wanted + 0.001, depth_mm), wanted + 1);
  }
}

/// So best_cut() chooses among measured feeds (tests/material/depth_fit_test.cpp).
TEST(depth_model, the_model_prefers_the_fastest_feed) {
  const DepthFit fit = fit_depth(pmma, measured(pmma_rows));
  EXPECT_LT(cut_time_s(100, 9.8, passes_through(6, cut_depth_mm(pmma, 9.8, fit.correction))),
            cut_time_s(100, 6, passes_through(6, cut_depth_mm(pmma, 6, fit.correction))));
}

TEST(depth_model, fit_finds_the_constants_of_exact_depths) {
  geometry::Random random(22);
  for (int i = 0; i < test::scaled(500, 20); ++i) {
    const auto any = [&](double low, double high) { return low + (high - low) * random.uniform(); };
    const CutSetup setup{{any(0.2, 3), any(0.5, 5), any(0.1, 1)}, any(0.5, 100), any(0.05, 1)};
    const DepthCorrection wanted{any(0.01, 2), any(0.3, 1.5)};
    std::vector<MeasuredDepth> depths;
    for (int k = 0; k < 6; ++k) {
      const double feed_mm_s = any(0.5, 50);
      depths.push_back({feed_mm_s, cut_depth_mm(setup, feed_mm_s, wanted)});
    }
    const DepthFit fit = fit_depth(setup, depths);
    EXPECT_NEAR(fit.correction.factor / wanted.factor, 1, 1e-9);
    EXPECT_NEAR(fit.correction.exponent, wanted.exponent, 1e-9);
    EXPECT_LT(fit.rms, 1e-9);
  }
}

TEST(depth_model, wrong_numbers_are_refused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(cut_depth_mm(pmma, bad), Error);
    EXPECT_THROW(effective_width_mm(RoundBeam{bad}), Error);
    EXPECT_THROW(effective_width_mm(RectangularBeam{0.5, bad}), Error);
    EXPECT_THROW(effective_width_mm(EllipticBeam{bad, 0.5}), Error);
    EXPECT_THROW(passes_through(3, bad), Error);
    EXPECT_THROW(passes_through(bad, 3), Error);
    EXPECT_THROW(fit_depth(pmma, {{1, 2}, {2, bad}}), Error);
    CutSetup setup = pmma;
    setup.material.density_g_cm3 = bad;
    EXPECT_THROW(cut_depth_mm(setup, 1), Error);
  }
  CutSetup shiny = pmma;
  shiny.material.absorption = 1.5;
  EXPECT_THROW(cut_depth_mm(shiny, 1), Error);
  EXPECT_THROW(passes_through(10, 1e-9), Error);
  EXPECT_THROW(fit_depth(pmma, {}), Error);
  EXPECT_THROW(fit_depth(pmma, {{1, 2}, {1, 2.1}}), Error);
}

}  // namespace
}  // namespace lamplock::cutting::depth_model_test
