// The length of a cubic spline, within 0.1 %.
//
// A Bezier curve is at least as long as its chord and at most as long as its control polygon, and
// the mean of the two is a much better estimate where they are close. Elsewhere the curve is
// halved; a cusp is halved until its parts are negligible. No stack: a part is identified by its
// depth and number, and its control polygon follows from that of the whole.
//
// 0.1 % needs few bits, so all of it is 32-bit arithmetic: edges of 13 bits, and only products for
// which the Cortex-M0+ has an instruction. Called when a spline begins; 17 parts on average and 50
// at most, each 36 short products and 4 roots of 32 bits, some 550 cycles.
#pragma once

#include <cstdint>

#include "firmware/program/curves/spline.hpp"

namespace lamplock::program {

/// Length of a spline whose other axes move evenly by `other_way_e7`, 10^-7 mm.
std::int64_t spline_length(const SplineRequest& request, std::int64_t other_way_e7);

}  // namespace lamplock::program
