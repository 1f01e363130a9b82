// Depth of a laser cut by power, feed and material, passes and time, and the fit to test cuts.
//
// In:  power in W, feed in mm/s, constants of a material, the shape of the beam; measured depths.
// Out: depths in mm, numbers of passes, times in s, the constants of the corrected model.
// Who: the choice of passes and feed for a cut.
//
// The model is that of N. Ausmanas, "Analysis of nonmetallic materials cutting by low power diode
// laser", Kaunas University of Technology, 2017: the power of the beam evaporates the volume of the
// groove, heat that flows away is neglected. With the absorbed part a, specific energy Q, density
// rho and effective width s of the beam:
//
//   D = B a / (Q rho s) (P / v)^w        theory: B = w = 1
//
// B and w correct it to measured depths. They hold for the measured feeds only: since w is below 1
// for all materials of the source, the model always takes a faster cut for the better one, while
// measured depths fall off. So best_cut() (host/material/depth_fit.hpp) chooses among measured
// feeds.
#pragma once

#include <variant>
#include <vector>

namespace lamplock::cutting {

/// Shapes of the beam on the material, mm.
struct RoundBeam {
  double radius_mm = 0;  ///< where the intensity is 1/e of that in the middle (Gauss)
};
struct RectangularBeam {
  double width_mm = 0, height_mm = 0;
};
struct EllipticBeam {
  double semi_axis_a_mm = 0, semi_axis_b_mm = 0;
};
using BeamShape = std::variant<RoundBeam, RectangularBeam, EllipticBeam>;

/// The side of the square with the area of the beam: R sqrt(pi), sqrt(c d), sqrt(pi a b); mm.
/// Throws Error (bad_input) for sizes that are not positive.
double effective_width_mm(const BeamShape& beam);

/// What the model has to know of a material.
struct CutMaterial {
  double density_g_cm3 = 0;
  double specific_energy_kj_g = 0;  ///< to heat it from room temperature and evaporate it
  double absorption = 1;            ///< part of the power that it absorbs, 0..1
};
struct DepthCorrection {
  double factor = 1;    ///< B
  double exponent = 1;  ///< w
};
/// What is the same for all feeds of a test.
struct CutSetup {
  CutMaterial material;
  double power_w = 0;
  double beam_width_mm = 0;  ///< effective
};

/// mm in one pass. Throws Error (bad_input) for numbers that are not positive, an absorption
/// above 1.
double cut_depth_mm(const CutSetup& setup, double feed_mm_s,
                    const DepthCorrection& correction = {});

/// Passes through a thickness with this depth of each. Debris in the groove makes later passes less
/// deep, which the model omits. Throws Error (bad_input) for numbers that are not positive, and for
/// more than a million passes.
int passes_through(double thickness_mm, double depth_mm);

/// s. Throws Error (bad_input) for a feed that is not positive.
double cut_time_s(double length_mm, double feed_mm_s, int passes);

struct MeasuredDepth {
  double feed_mm_s = 0, depth_mm = 0;
};
struct DepthFit {
  DepthCorrection correction;
  /// Root of the mean square of ln(measured / model): 0.1 is a deviation of 10 %.
  double rms = 0;
  double min_feed_mm_s = 0, max_feed_mm_s = 0;  ///< of the measurements
  /// Depths deviate from the model by a third and more: more test cuts are needed. The fits of the
  /// source's tables have 0.07 to 0.2, except that of plywood with 0.6.
  bool is_poor() const { return rms > 0.3; }
};
/// Least squares of ln D over ln(P / v). Throws Error (bad_input) for less than two different feeds
/// and for numbers that are not positive.
DepthFit fit_depth(const CutSetup& setup, const std::vector<MeasuredDepth>& measured);

}  // namespace lamplock::cutting
