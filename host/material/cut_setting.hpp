// What a cut needs, found in the material library.
//
// In:  a library, a laser, a material, a thickness, an operation. Out: feed, power, passes, air,
//      kerf, frequency. Who: commands that make programs for a material.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/material/library.hpp"

namespace lamplock::material {

struct CutQuery {
  std::string material{};
  std::string laser{};  ///< empty: the only laser that has a setting for the operation
  std::optional<double> thickness_mm{};  ///< none: that of the material
  std::string operation = "cut";         ///< cut, score, engrave
};

struct CutSetting {
  std::string material{}, laser{};
  std::optional<double> thickness_mm{};  ///< of the material; none: not known
  double feed_mm_min = 0;
  double power_w = 0;      ///< of the beam
  double power_share = 0;  ///< the same in parts of the power of the laser
  int passes = 1;
  bool air = false;
  std::optional<double> kerf_mm{};       ///< width of the cut; none: not measured
  std::optional<double> frequency_hz{};  ///< pulses a second; none: the beam is continuous
  std::string operation{};
  std::int64_t number = 0;  ///< of the setting in the library
};

/// The setting for this thickness, else the one for any thickness. Throws Error(bad_input) that
/// names what the library lacks: the material, the laser, a setting for the operation, the
/// thickness (with those that have one), and for a cut of a material that cannot be cut.
CutSetting cut_setting(Library& library, const CutQuery& query);

}  // namespace lamplock::material
