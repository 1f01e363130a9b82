// A picture of a traced run: position, speed and acceleration of each axis over beats, as SVG.
//
// In:  the series of a run, a title. Out: text of an SVG file, some ten kilobytes, for two
//      thousand beats some hundred.
// Who: `--plot` of the command line.
//
// On top a mark for every beat: fired, not fired, or without a flash. Limits are dashed where the
// curves come near them, else told in words. The length of ticks is drawn where it changes, the way
// in the plane where X and Y move. Colours are those of Okabe and Ito, which colour-blind people
// can tell apart.
#pragma once

#include <string>

#include "host/report/motion_series.hpp"

namespace lamplock::report {

/// The picture. `title` is plain text.
std::string motion_svg(const MotionSeries& series, const std::string& title);

}  // namespace lamplock::report
