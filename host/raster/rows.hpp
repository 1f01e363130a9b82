// Converts pixels to rows: lines of the machine with their cells.
//
//        overscan   pixels   overscan
//   row 2  |--------######----------|>      one way or back and forth, from the lowest row up
//   row 1 <|--------------####------|       blank rows and margins are left out
//   row 0  |-----##########---------|>
//
// In:  powers and positions of pixels, feed and overscan; a machine profile.
// Out: a job of rows. Each row is one line or several consecutive ones, cut to suit the board's run
//      table; overscan and gaps are dark cells of them, so that the feed never changes.
// Who: `lamplock raster`.
#pragma once

#include "host/geometry/point.hpp"
#include "host/job/job.hpp"
#include "host/raster/pixels.hpp"

namespace lamplock::raster {

/// Options for engraving pixels.
struct RowOptions {
  geometry::Point corner{};  ///< lower left one of the picture, machine coordinates
  double pitch_mm = 0.1;     ///< of pixels, and of rows
  double feed_mm_min = 0;
  double overscan_mm = 0;  ///< dark distance before and after a row: run_up_mm(); whole pixels
  bool one_way = false;    ///< all rows to the right
  bool dry = false;        ///< move with the laser off
  /// What to do if rows lie outside the work space, for the error.
  std::string remedy_outside = "move it, make it smaller, or use a lower feed rate";
};

/// Overscan in whole pixels, rounded up.
std::uint32_t overscan_pixels(double overscan_mm, double pitch_mm);

/// Makes a job. Edges of pixels are within half a step of their position, and exact if the pitch is
/// a whole number of steps. Throws Error(bad_input) for pixels finer than a step, a feed above the
/// machine's maximum, a picture without power, or rows outside the work space.
job::Job make_rows(const Pixels& pixels, const RowOptions& options, const job::Profile& profile);

}  // namespace lamplock::raster
