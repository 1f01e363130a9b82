// A picture of a traced run: position, speed and acceleration of each axis over beats, as SVG.
//
// In:  the series of a run, a title. Out: text of an SVG file, some 10 KB, for 2000 beats some
//      100 KB.
// Who: `--plot` of the command line.
//
// On top is a mark for every beat: fired, not fired, or without a flash. Limits are dashed lines if
// the curves come near them, otherwise text. The length of ticks is drawn if it changes, the path
// in the plane if X and Y move. Colours are those of Okabe and Ito, which colour-blind people can
// distinguish.
#pragma once

#include <string>

#include "host/report/motion_series.hpp"

namespace lamplock::report {

/// The picture. `title` is plain text.
std::string motion_svg(const MotionSeries& series, const std::string& title);

}  // namespace lamplock::report
