// Dashes of a curve (W3C, "Scalable Vector Graphics (SVG) 2", 13.5.6 "Controlling dashing").
//
// In:  a path, the lengths of dashes and gaps. Out: the dashes as open paths, exact parts of it.
// Who: read_svg().
#pragma once

#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::model {

/// Lengths in the units of the path.
struct DashPattern {
  std::vector<double> lengths;  ///< dash, gap, dash, ...; an even number, none negative
  double offset = 0;            ///< where in the pattern the path starts
  bool draws_dots = false;      ///< dashes of length 0 are dots, by round or square line ends

  double period() const;
};

/// The number of dashes, about, of a path of this length: what dashes() will cost.
double dash_count(const DashPattern& pattern, double length);

/// The period must be positive.
std::vector<Path> dashes(const Path& path, const DashPattern& pattern);

}  // namespace lamplock::model
