#include "host/cutting/depth_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::cutting {
namespace {

using geometry::require_positive;

constexpr const char* depth_model_place = "depth model";

// 1 g/cm3 = 0.001 g/mm3, 1 kJ/g = 1000 J/g.
constexpr double j_mm3_in_kj_cm3 = 1;

/// a / (Q rho s), the depth in mm by theory for 1 W at 1 mm/s.
double depth_constant(const CutSetup& setup) {
  const CutMaterial& material = setup.material;
  require_positive(material.density_g_cm3, depth_model_place, "density");
  require_positive(material.specific_energy_kj_g, depth_model_place, "specific energy");
  require_positive(material.absorption, depth_model_place, "absorption");
  require_positive(setup.power_w, depth_model_place, "power");
  require_positive(setup.beam_width_mm, depth_model_place, "beam width");
  if (material.absorption > 1)
    throw Error(Exit::bad_input, depth_model_place,
                fmt::format("the absorption is {:g}", material.absorption),
                "give the absorbed part of the power, at most 1");
  const double energy_j_mm3 =
      material.density_g_cm3 * material.specific_energy_kj_g * j_mm3_in_kj_cm3;
  return material.absorption / (energy_j_mm3 * setup.beam_width_mm);
}

double model_depth_mm(const CutSetup& setup, double feed_mm_s, const DepthCorrection& correction) {
  return correction.factor * depth_constant(setup) *
         std::pow(setup.power_w / feed_mm_s, correction.exponent);
}

struct WidthOfBeam {
  double operator()(const RoundBeam& beam) const {
    require_positive(beam.radius_mm, depth_model_place, "beam radius");
    return beam.radius_mm * std::sqrt(std::numbers::pi);
  }
  double operator()(const RectangularBeam& beam) const {
    require_positive(beam.width_mm, depth_model_place, "beam width");
    require_positive(beam.height_mm, depth_model_place, "beam height");
    return std::sqrt(beam.width_mm * beam.height_mm);
  }
  double operator()(const EllipticBeam& beam) const {
    require_positive(beam.semi_axis_a_mm, depth_model_place, "semi-axis of the beam");
    require_positive(beam.semi_axis_b_mm, depth_model_place, "semi-axis of the beam");
    return std::sqrt(std::numbers::pi * beam.semi_axis_a_mm * beam.semi_axis_b_mm);
  }
};

}  // namespace

double effective_width_mm(const BeamShape& beam) { return std::visit(WidthOfBeam{}, beam); }

double cut_depth_mm(const CutSetup& setup, double feed_mm_s, const DepthCorrection& correction) {
  require_positive(feed_mm_s, depth_model_place, "feed");
  require_positive(correction.factor, depth_model_place, "factor B");
  require_positive(correction.exponent, depth_model_place, "exponent w");
  return model_depth_mm(setup, feed_mm_s, correction);
}

int passes_through(double thickness_mm, double depth_mm) {
  require_positive(thickness_mm, depth_model_place, "thickness");
  require_positive(depth_mm, depth_model_place, "depth of a pass");
  // 6 mm in passes of 0.4 mm are 15 passes, although 6 / 0.4 may be rounded up.
  constexpr double rounding = 1e-9;
  constexpr double max_passes = 1e6;
  const double passes = std::ceil(thickness_mm / depth_mm * (1 - rounding));
  if (passes > max_passes)
    throw Error(Exit::bad_input, depth_model_place,
                fmt::format("{:g} mm in passes of {:g} mm are more than {:g} passes", thickness_mm,
                            depth_mm, max_passes),
                "use more power, a slower feed or a greater infeed");
  return static_cast<int>(passes);
}

double cut_time_s(double length_mm, double feed_mm_s, int passes) {
  require_positive(feed_mm_s, depth_model_place, "feed");
  return length_mm / feed_mm_s * passes;
}

DepthFit fit_depth(const CutSetup& setup, const std::vector<MeasuredDepth>& measured) {
  const double constant = std::log(depth_constant(setup));
  double sum_x = 0, sum_y = 0;
  DepthFit fit;
  for (const MeasuredDepth& one : measured) {
    require_positive(one.feed_mm_s, depth_model_place, "feed");
    require_positive(one.depth_mm, depth_model_place, "measured depth");
    sum_x += std::log(setup.power_w / one.feed_mm_s);
    sum_y += std::log(one.depth_mm);
    const bool is_first = &one == &measured.front();
    fit.min_feed_mm_s = is_first ? one.feed_mm_s : std::min(fit.min_feed_mm_s, one.feed_mm_s);
    fit.max_feed_mm_s = std::max(fit.max_feed_mm_s, one.feed_mm_s);
  }
  if (fit.min_feed_mm_s >= fit.max_feed_mm_s)
    throw Error(Exit::bad_input, depth_model_place, "the fit needs depths at two different feeds",
                "measure cuts at more feeds");
  // About the means: the sums of the source's normal equations lose digits where feeds are close.
  const auto count = static_cast<double>(measured.size());
  const double mean_x = sum_x / count, mean_y = sum_y / count;
  double xx = 0, xy = 0;
  for (const MeasuredDepth& one : measured) {
    const double x = std::log(setup.power_w / one.feed_mm_s) - mean_x;
    xx += x * x;
    xy += x * (std::log(one.depth_mm) - mean_y);
  }
  fit.correction.exponent = xy / xx;
  fit.correction.factor = std::exp(mean_y - constant - fit.correction.exponent * mean_x);
  double squares = 0;
  for (const MeasuredDepth& one : measured) {
    const double off =
        std::log(one.depth_mm / model_depth_mm(setup, one.feed_mm_s, fit.correction));
    squares += off * off;
  }
  fit.rms = std::sqrt(squares / count);
  return fit;
}

}  // namespace lamplock::cutting
