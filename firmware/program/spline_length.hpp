// How long a cubic spline is, within 0.1 %.
//
// A Bezier curve is no shorter than its chord and no longer than its control polygon, and the mean
// of the two is much nearer than either where they are close. Where they are not the curve is
// halved; a cusp is halved until it is too short to matter. No stack: parts are known by their
// depth and number, and the control polygon of any part follows from that of the whole.
//
// 0.1 % needs few bits, so all of it is 32-bit arithmetic: edges of 13 bits, and no product that
// the Cortex-M0+ has no instruction for. Called when a spline begins; 17 parts on average and 50
// at most, each 36 short products and 4 roots of 32 bits, some 550 cycles.
#pragma once

#include <cstdint>

#include "firmware/program/spline.hpp"

namespace lamplock::program {

/// Length of a spline whose other axes move evenly by `other_way_e7`, 10^-7 mm.
std::int64_t spline_length(const SplineRequest& request, std::int64_t other_way_e7);

}  // namespace lamplock::program
