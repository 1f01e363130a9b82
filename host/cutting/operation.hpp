// What is done along the contours of a layer or colour: the plain values of one operation.
//
// In:  a description of a job, or a library of materials. Out: values for plan_cuts().
// Who: the preparation of a cut.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "host/cutting/leads.hpp"
#include "host/cutting/tabs.hpp"

namespace lamplock::cutting {

enum class OperationKind : std::uint8_t {
  cut,      ///< through the sheet; inner contours before outer ones
  score,    ///< a line on the surface, before all cuts
  engrave,  ///< the area of closed contours, filled with parallel lines, before all others
  ignore
};

/// The side of the contour on which the beam runs.
enum class Compensation : std::uint8_t {
  automatic,  ///< outside of parts, inside of holes; on the line of open contours
  none,
  left,  ///< of the direction in which the contour is cut (G41)
  right,
  inside,
  outside,
  controller  ///< as automatic, by G41 and G42 of the machine along the drawn contour
};

enum class Direction : std::uint8_t {
  automatic,  ///< parts counter-clockwise, holes clockwise, open contours as drawn
  drawn,
  reversed,
  clockwise,
  counter_clockwise
};

/// A slower beam or tool is a slip of units: test cuts of lasers begin at 30 mm/min, and at 1
/// mm/min a part of 100 mm already needs 100 min.
inline constexpr double min_feed_mm_min = 1;
/// Closer lines are a slip, too: 2540 lines per inch, a tenth of the beam of a focused laser.
inline constexpr double min_hatch_mm = 0.01;

struct Operation {
  std::string name;
  OperationKind kind = OperationKind::cut;
  double power = 1;  ///< in parts of the maximum
  double feed_mm_min = 0;
  /// Of the focus or tool in each pass, mm; empty: `passes` at the present height.
  std::vector<double> z_mm;
  int passes = 1;
  Compensation compensation = Compensation::automatic;
  double kerf_mm = 0;  ///< width of the beam; 0: no compensation
  Direction direction = Direction::automatic;
  Lead lead_in, lead_out;  ///< of closed contours
  double overcut_mm = 0;
  TabOptions tabs;      ///< of closed contours
  double pierce_s = 0;  ///< with the laser on before the beam moves
  /// Time of motion without light after the begin and before the end of each contour.
  double on_late_s = 0, off_early_s = 0;
  bool has_air = false;
  double hatch_mm = 0, hatch_deg = 0;  ///< distance and angle of the lines of an engraving
  double overscan_mm = 0;              ///< before and after each line, dark
  /// Longer gaps in the lines of an engraving are crossed by rapids.
  double max_gap_mm = std::numeric_limits<double>::infinity();
};

}  // namespace lamplock::cutting
