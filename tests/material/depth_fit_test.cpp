// Fits, best feeds and suitability of the delivered records, to the digits of their source, and of
// random measurements.
#include "host/material/depth_fit.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>

#include "host/geometry/random.hpp"
#include "host/material/library.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"

namespace lamplock::material::depth_fit_test {
namespace {

using testing::HasSubstr;

struct Delivered {
  Library library = Library::for_reading("");
  Laser laser = library.laser("diode-3w");

  MaterialFit fit(const std::string& name, Rejected rejected = Rejected::left_out) {
    return fit_material(laser, library.material(name), library.measurements_of(name), rejected);
  }
  std::string fit_text(const std::string& name, Rejected rejected = Rejected::left_out) {
    const MaterialFit result = fit(name, rejected);
    return fmt::format("{:.5f} {:.5f} {:.3f} of {}{}", result.fit.correction.factor,
                       result.fit.correction.exponent, result.fit.rms, result.measurements,
                       result.fit.is_poor() ? " poor" : "");
  }
  BestCut best(const std::string& name, double thickness_mm,
               Rejected rejected = Rejected::left_out) {
    return best_cut(library.material(name), library.measurements_of(name), thickness_mm, 100,
                    rejected);
  }
  std::string best_text(const std::string& name, double thickness_mm,
                        Rejected rejected = Rejected::left_out) {
    const BestCut best_one = best(name, thickness_mm, rejected);
    return fmt::format("{:g} mm/min {} passes {:.2f} min", best_one.feed_mm_min, best_one.passes,
                       best_one.time_s / 60);
  }
  Verdict verdict(const std::string& name, double thickness_mm) {
    return judge(trial_of(library.material(name), library.measurements_of(name), thickness_mm))
        .verdict;
  }
};

TEST(depth_fit, constants_of_the_source) {
  Delivered delivered;
  EXPECT_EQ(delivered.fit_text("pmma-black"), "0.71835 0.82350 0.068 of 11");
  EXPECT_EQ(delivered.fit_text("pmma-black", Rejected::swapped_in), "0.67018 0.90940 0.177 of 11");
  EXPECT_EQ(delivered.fit_text("plywood"), "0.09940 0.91338 0.600 of 6 poor");
  EXPECT_EQ(delivered.fit_text("fibreboard"), "0.03511 0.92954 0.202 of 5");
  EXPECT_EQ(delivered.fit_text("fibreboard", Rejected::swapped_in), "0.03511 0.92954 0.202 of 5");
  EXPECT_EQ(delivered.fit("plywood").feed_mm_min.max, 360);
}

TEST(depth_fit, best_feeds_of_the_source) {
  Delivered delivered;
  // The times of the source are those of the depth 0.12 mm at 600 mm/min, which the fit rejects.
  EXPECT_EQ(delivered.best_text("pmma-black", 6, Rejected::swapped_in),
            "360 mm/min 17 passes 4.72 min");
  EXPECT_EQ(delivered.best_text("pmma-black", 6), "600 mm/min 28 passes 4.67 min");
  EXPECT_EQ(delivered.best("pmma-black", 6).rejected_depth_mm, 0.12);
  EXPECT_FALSE(delivered.best("pmma-black", 6, Rejected::swapped_in).rejected_depth_mm);
  EXPECT_FALSE(delivered.best("plywood", 5).rejected_depth_mm);
  EXPECT_EQ(delivered.best_text("plywood", 5), "180 mm/min 7 passes 3.89 min");
  EXPECT_EQ(delivered.best_text("fibreboard", 5), "60 mm/min 15 passes 25.00 min");
  EXPECT_EQ(delivered.best_text("cotton-denim", 1), "120 mm/min 1 passes 0.83 min");
  EXPECT_EQ(delivered.best_text("wool", 1.5), "200 mm/min 1 passes 0.50 min");
  EXPECT_EQ(delivered.best_text("pig-leather", 1.2), "45 mm/min 3 passes 6.67 min");
  EXPECT_EQ(delivered.best("pmma-black", 6).measured_feed_mm_min.max, 600);
  EXPECT_THAT(test::error_of([&] { delivered.best("wool", 1.6); }),
              HasSubstr("material wool: there is no measurement for 1.6 mm"));
  EXPECT_THAT(test::error_of([&] { delivered.best("pmma-yellow", 3); }),
              HasSubstr("cannot be cut"));
}

TEST(depth_fit, settings_delivered_agree_with_the_best_cuts) {
  Delivered delivered;
  for (const Setting& setting : delivered.library.all<Setting>()) {
    const BestCut best =
        delivered.best(setting.material, setting.thickness_mm.value_or(1), Rejected::swapped_in);
    EXPECT_EQ(setting.feed_mm_min, best.feed_mm_min) << setting.material;
    EXPECT_EQ(setting.passes, best.passes) << setting.material;
  }
}

TEST(depth_fit, what_a_material_lacks_is_named) {
  Delivered delivered;
  EXPECT_THAT(test::error_of([&] { delivered.fit("rubber"); }),
              HasSubstr("material rubber: 'absorption' is missing"));
  EXPECT_THAT(test::error_of([&] { delivered.fit("wool"); }),
              HasSubstr("'density_g_cm3' is missing"));
  std::vector<Measurement> one = delivered.library.measurements_of("plywood");
  one.resize(1);
  EXPECT_THAT(test::error_of([&] {
                fit_material(delivered.laser, delivered.library.material("plywood"), one,
                             Rejected::left_out);
              }),
              HasSubstr("depths at two ratios of power to feed with diode-3w, and has one"));
}

TEST(depth_fit, the_procedure_of_the_source) {
  EXPECT_EQ(judge({3, {}}).verdict, Verdict::cutting);
  EXPECT_EQ(judge({4, 0.5}).verdict, Verdict::engraving);
  EXPECT_EQ(judge({{}, 0.49}).verdict, Verdict::unfit);
  EXPECT_EQ(judge({}).verdict, Verdict::unfit);
  Delivered delivered;
  EXPECT_EQ(delivered.verdict("pmma-black", 6), Verdict::cutting);  // 3 x 2.36 mm
  EXPECT_EQ(delivered.verdict("pmma-black", 12), Verdict::engraving);
  EXPECT_EQ(delivered.verdict("fibreboard", 5), Verdict::unfit);  // 0.4 mm
  EXPECT_EQ(delivered.verdict("ox-leather", 3), Verdict::cutting);
  EXPECT_EQ(delivered.verdict("pmma-grey", 3), Verdict::unfit);
  EXPECT_THROW(delivered.verdict("rubber", 3), Error);
}

/// Depths of the model at random feeds and powers give its constants; the best cut is the fastest
/// of all measured pairs, and none outside of them.
TEST(depth_fit, random_measurements) {
  Delivered delivered;
  const Material material = delivered.library.material("plywood");
  geometry::Random random(31);
  const auto any = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  for (int i = 0; i < test::scaled(300, 20); ++i) {
    cutting::CutSetup setup = setup_of(delivered.laser, material);
    const cutting::DepthCorrection wanted{any(0.05, 1), any(0.4, 1.2)};
    std::vector<Measurement> measured;
    for (int k = 0; k < 8; ++k) {
      Measurement one;
      one.feed_mm_min = any(10, 2000);
      one.power_w = setup.power_w = any(0.5, 3);
      one.depth_mm = cutting::cut_depth_mm(setup, one.feed_mm_min / 60, wanted);
      measured.push_back(one);
      one.depth_mm = *one.depth_mm * 3;  // neither wrong depths nor further passes count
      one.rejected = k % 2 == 0;
      one.passes = one.rejected ? 1 : 4;
      measured.push_back(one);
    }
    const MaterialFit fit = fit_material(delivered.laser, material, measured, Rejected::left_out);
    EXPECT_NEAR(fit.fit.correction.factor / wanted.factor, 1, 1e-9);
    EXPECT_NEAR(fit.fit.correction.exponent, wanted.exponent, 1e-9);
    EXPECT_NEAR(fit.depth_mm(measured[2].feed_mm_min, measured[2].power_w), *measured[2].depth_mm,
                1e-9);
    const double thickness_mm = any(0.5, 10);
    const BestCut best = best_cut(material, measured, thickness_mm, 250, Rejected::left_out);
    double min_s = std::numeric_limits<double>::infinity();
    bool is_measured = false;
    for (const Measurement& one : measured) {
      if (one.rejected || one.passes != 1) continue;
      const int passes = cutting::passes_through(thickness_mm, *one.depth_mm);
      min_s = std::min(min_s, 250 / (one.feed_mm_min / 60) * passes);
      is_measured |= best.feed_mm_min == one.feed_mm_min && best.power_w == one.power_w;
    }
    EXPECT_NEAR(best.time_s, min_s, 1e-9 * min_s);
    EXPECT_TRUE(is_measured);
  }
}

}  // namespace
}  // namespace lamplock::material::depth_fit_test
