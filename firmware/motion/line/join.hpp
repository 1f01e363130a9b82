// Joins short lines of a program to longer ones, as long as they differ by less than rounding.
//
// In:  where the last line begins, and each place that it passes.
// Out: whether a line from that start to another place passes all of them closely enough.
// Who: the line planner, once per line pushed.
//
// Programs divide curves, and straight runs too, into lines far shorter than the look-ahead needs:
// 128 lines of 0.02 mm are 2.6 mm, in which a machine cannot brake from its speed; and between
// lines of a few steps a turn cannot be distinguished from the rounding of their numbers. So lines
// become one that passes their places in order, each as close as their rounding explains: a place
// and the ends of the line are off by half the last decimal, and the resolution of places comes on
// top.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/line/geometry.hpp"
#include "firmware/motion/line/place.hpp"
#include "firmware/motion/line/ring.hpp"

namespace lamplock::motion {

class LineJoin {
 public:
  /// Maximum lines that become one.
  static constexpr std::uint32_t max_lines = 16;

  /// A line begins here.
  void start(const LinePlace& from) {
    from_ = from;
    count_ = 0;
  }
  /// Where the line begins.
  const LinePlace& from() const { return from_; }
  /// Whether the line may end at `to`, with this shape, instead of at `end`, where it ends now.
  bool reaches(const LinePlace& end, const LineTarget& to, const LineShape& shape,
               const LineLimits& limits) const;
  /// The line ends further on: it passes this place.
  void pass(const LinePlace& place) { passed_[count_++] = place; }

 private:
  LinePlace from_;
  std::array<LinePlace, max_lines - 1> passed_{};
  std::uint32_t count_ = 0;
};

}  // namespace lamplock::motion
