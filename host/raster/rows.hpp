// Pixels to rows: which lines the machine runs, with which cells on them.
//
//        overscan   pixels   overscan
//   row 2  |--------######----------|>      one way or back and forth, from the lowest row up
//   row 1 <|--------------####------|       blank rows and margins are left out
//   row 0  |-----##########---------|>
//
// In:  powers of pixels, where they lie, feed and overscan; a machine profile.
// Out: a job of rows. Each row is one line or several in a row, cut where the board's table of runs
//      wants it; overscan and gaps are dark cells of them, so that the feed never changes.
// Who: `lamplock raster`.
#pragma once

#include "host/job/job.hpp"
#include "host/points/point.hpp"
#include "host/raster/pixels.hpp"

namespace lamplock::raster {

/// How pixels are burnt.
struct RowOptions {
  points::Point corner{};  ///< lower left one of the picture, machine coordinates
  double pitch_mm = 0.1;   ///< of pixels, and of rows
  double feed_mm_min = 0;
  double overscan_mm = 0;  ///< dark way before and behind a row: run_up_mm(); whole pixels are made
  bool one_way = false;    ///< all rows to the right
  bool dry = false;        ///< move, never shine
};

/// Makes a job. Edges of pixels lie within half a step of their place, and on the step where the
/// pitch is whole steps. Throws Error(bad_input) for pixels finer than a step, a feed beyond the
/// machine's, a picture without light, or rows outside the work space.
job::Job make_rows(const Pixels& pixels, const RowOptions& options, const job::Profile& profile);

}  // namespace lamplock::raster
