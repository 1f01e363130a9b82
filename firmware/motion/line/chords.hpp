// The curvature of a path of short lines, measured over a chord of many of them.
//
// In:  every line pushed. Out: now and then, a speed limit for the joints of the last ones.
// Who: the line planner, once per line pushed; a chord is measured once per window.
//
// Between two lines of a few steps a turn cannot be distinguished from the rounding of their
// numbers (line/geometry.hpp), so a curve of a small radius, or a corner of tiny lines, would be
// passed at any speed. Over a chord of `window` roundings these are less than 2/window of a turn:
// the chord is compared with the previous one, and all joints within both get the speed of the
// circle that touches the two. The possible rounding is subtracted from the turn, so a turn that is
// not much more passes too fast: longer chords measure it better, but measure a small circle as a
// smaller one; so the longest count for gentle turns only. With chords of 12, 128 and 512 roundings
// no axis has more than 1.15 of its acceleration on circles of 1 to 10 mm (1.25 at 80 steps/mm),
// and a path of 0.1 mm lines that bends at a tenth of what the machine can do keeps its speed. The
// limit is late: the machine may be at a joint already, and then brakes as fast as it can. It is
// for curves and not for hard corners. A line as long as the window is a chord by itself: short
// lines before it that do not fill a chord are left out, or the corner at its far end, a run of a
// raster away, would count as their bend.
#pragma once

#include <cstdint>

#include "firmware/motion/line/geometry.hpp"

namespace lamplock::motion {

/// A limit for the joints at the starts of the lines `first` to `last`.
struct LineCap {
  std::uint32_t first = 0, last = 0;
  UFloat speed_2;
};

class LineChords {
 public:
  /// The window is counted in LineLimits::rounding; `bends` selects the turns between chords that
  /// count.
  LineChords(std::uint32_t window, LineBends bends) : window_(window), bends_(bends) {}

  /// Starts again at a position; the next line is `line`.
  void reset(const LinePlace& at, std::uint32_t line, const LineLimits& limits);
  /// Line number `line`, which ends at `end`. True if a limit follows.
  bool add(std::uint32_t line, const LinePlace& end, const LineShape& shape,
           const LineLimits& limits, LineCap& cap);

 private:
  std::uint32_t window_;
  UFloat min_way_;  ///< the window as a length
  LineBends bends_;
  LinePlace mark_;               ///< where the present chord starts
  std::uint32_t mark_line_ = 0;  ///< its first line
  UFloat way_;                   ///< along the path since the mark
  LineShape before_;             ///< the previous chord
  std::uint32_t before_line_ = 0;
  bool before_single_ = false;  ///< the previous chord is a single line
};

}  // namespace lamplock::motion
