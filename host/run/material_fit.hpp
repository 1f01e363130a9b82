// Measured test cuts in the material library, and what follows from them.
//
// In:  a material and a laser of the library, a measured depth, a thickness. Out: the stored
//      measurement, the fit of the depth model, the best feed, the suitability.
// Who: `material measure|fit|best|suitable`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/material/depth_fit.hpp"
#include "host/material/library.hpp"
#include "host/material/records.hpp"

namespace lamplock::run {

/// A material with the measurements that one laser made.
struct CutChoice {
  std::string library{};  ///< file; empty: the user's own
  std::string material{};
  std::string laser{};  ///< empty: the laser of its measurements, or the only one of the library
};

struct MeasureRequest : CutChoice {
  std::string power{};  ///< W, or percent of the laser's power: "50%"; empty: full power
  std::optional<double> feed_mm_min{}, depth_mm{}, thickness_mm{};
  int passes = 1;
  std::string result{}, note{};
};

/// Stores a measurement. Throws Error(bad_input), and then nothing is stored.
material::Measurement measure(const MeasureRequest& request);

struct FitResult {
  material::Laser laser;
  material::Material material;
  material::MaterialFit fit;
};
/// Throws Error(bad_input).
FitResult fit_material(const CutChoice& choice, material::Rejected rejected);

struct BestResult {
  material::Laser laser;
  material::Material material;
  double thickness_mm = 0;
  material::BestCut best;
};
/// Without a thickness, that of the material. Throws Error(bad_input).
BestResult best_cut(const CutChoice& choice, std::optional<double> thickness_mm, double length_mm,
                    material::Rejected rejected);

struct SuitableResult {
  material::Laser laser;
  material::Material material;
  std::optional<double> thickness_mm{};
  material::Suitability suitability{};
  bool is_by_trial = false;                    ///< the user gave its passes or groove
  std::optional<material::MaterialFit> fit{};  ///< second stage, if there are measurements
  std::optional<material::BestCut> best{};
};
/// Judges a trial of the user, or that of the library's measurements; then, for a laser that is fit
/// for cutting, the fit and the best feed as far as there are measurements. Throws
/// Error(bad_input).
SuitableResult judge_material(const CutChoice& choice, const material::Trial& trial,
                              std::optional<double> thickness_mm, double length_mm);

/// W. "50%" is a part of the laser's power, "" all of it. Throws Error(bad_input), at `where`, for
/// a text that is no power, and for more power than the laser has.
double power_w_of(const std::string& text, const material::Laser& laser, const std::string& where);

/// The laser of a choice. Throws Error(bad_input) if it is not clear which.
material::Laser laser_of(material::Library& library, const CutChoice& choice);

}  // namespace lamplock::run
