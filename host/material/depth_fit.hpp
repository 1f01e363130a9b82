// Evaluation of measured test cuts of a laser and a material: the fit of the depth model, the best
// feed, the suitability.
//
// In:  a laser, a material, its measurements. Out: constants, a feed with its passes and time, a
//      verdict. Who: `lamplock material fit`, `best` and `suitable`; `lamplock cut`.
//
// The procedure and the model are those of N. Ausmanas, "Analysis of nonmetallic materials cutting
// by low power diode laser", Kaunas University of Technology, 2017 (host/cutting/depth_model.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/depth_model.hpp"
#include "host/material/records.hpp"

namespace lamplock::material {

/// Use of measurements that are marked as wrong.
enum class Rejected : std::uint8_t {
  left_out,
  swapped_in  ///< used in place of the accepted ones at the same feed and power
};

struct Extent {
  double min = 0, max = 0;
};

struct MaterialFit {
  cutting::CutSetup setup;  ///< at full power
  cutting::DepthFit fit;
  std::size_t measurements = 0;
  Extent feed_mm_min, power_w;  ///< measured

  /// mm in one pass. Beyond the measured feeds and powers this is an extrapolation.
  double depth_mm(double at_feed_mm_min, double at_power_w) const;
};

/// The constants of the depth model. Throws Error(bad_input) that names what the material lacks,
/// and for measured depths at less than two ratios of power and feed.
cutting::CutSetup setup_of(const Laser& laser, const Material& material);

/// Fits the model to depths of one pass; later passes are less deep because of debris, which the
/// model omits. Throws Error(bad_input) as setup_of(), and for depths at fewer than two ratios of
/// power to feed.
MaterialFit fit_material(const Laser& laser, const Material& material,
                         const std::vector<Measurement>& measurements, Rejected rejected);

struct BestCut {
  double feed_mm_min = 0, power_w = 0;
  std::optional<double> depth_mm{};  ///< of a pass; none: known from a cut that came through
  int passes = 0;
  double time_s = 0;            ///< of a cut of this length
  bool burns = false;           ///< the edges of this material burn at this feed
  std::size_t candidates = 0;   ///< measured pairs of feed and power
  int max_measured_passes = 0;  ///< of all measurements; more passes are computed from the depth
  Extent measured_feed_mm_min, measured_power_w;
  /// A smaller depth at this feed and power that is marked as wrong and was not used.
  std::optional<double> rejected_depth_mm{};
};

/// The measured pair of feed and power with the shortest time for a cut of this length through a
/// thickness. Of several measurements at one pair the smallest depth counts, so that the passes
/// come through. The fitted model is not used: beyond the measured range it prefers any faster
/// feed. Throws Error(bad_input) for a material that cannot be cut, and without measurements for
/// this thickness.
BestCut best_cut(const Material& material, const std::vector<Measurement>& measurements,
                 double thickness_mm, double length_mm, Rejected rejected);

/// First stage of the procedure: a trial at the slowest feed.
struct Trial {
  std::optional<int> passes{};        ///< after which the cut came through
  std::optional<double> groove_mm{};  ///< depth of the groove if it did not
};
enum class Verdict : std::uint8_t { cutting, engraving, unfit };
struct Suitability {
  Verdict verdict = Verdict::unfit;
  std::string reason;
};

/// Limits of the procedure "is this laser fit for the material" (docs/materials.md).
inline constexpr int max_passes_of_trial = 3;
inline constexpr double min_groove_mm = 0.5;

/// Cut through within 3 passes: fit for cutting; else a groove of at least 0.5 mm: fit for
/// engraving; else unfit.
Suitability judge(const Trial& trial);

/// The trial that equals the measurements for a thickness: the deepest groove of one pass, or a cut
/// that came through. Throws Error(bad_input) if there is no measurement.
Trial trial_of(const Material& material, const std::vector<Measurement>& measurements,
               double thickness_mm);

}  // namespace lamplock::material
