// Joins short lines of a program to longer ones, as long as they differ by less than rounding.
//
// In:  where the last line begins, and the way from there to each place that it passes.
// Out: whether a line from that start to another place passes all of them closely enough.
// Who: the line planner, once per line pushed: some 500 cycles of the Cortex-M0+, and 40 per place
//      and axis that moves.
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

namespace lamplock::motion {

class LineJoin {
 public:
  /// Maximum lines that become one.
  static constexpr std::uint32_t max_lines = 16;

  /// A line begins at `from` and goes this way.
  void start(const LinePlace& from, const WayParts& way, const LineLimits& limits);
  /// Where the line begins.
  const LinePlace& from() const { return from_; }
  /// Whether the line may go this way instead, with this shape, past all places. `digit_um`: the
  /// last decimal of the numbers of the program.
  bool reaches(const WayParts& way, const LineShape& shape, std::uint8_t digit_um,
               const LineLimits& limits);
  /// It does: its previous end is a place that it passes.
  void extend();

 private:
  /// A way, per axis in steps of the coarsest axis, Q8.
  using WeightedWay = PerAxis<std::int32_t>;
  struct Direction;

  bool weigh(const WayParts& way, const LineLimits& limits, WeightedWay& out_q8);
  Direction direction_of(const LineShape& shape, std::uint8_t digit_um,
                         const LineLimits& limits) const;
  template <class Number>
  bool passes_all(const Direction& direction) const;

  LinePlace from_;
  std::array<WeightedWay, max_lines> passed_q8_{};  ///< the last one: the present end
  WeightedWay next_q8_{};                           ///< the end that reaches() was asked for
  std::uint32_t last_ = 0;                          ///< index of the present end
  PerAxis<std::uint32_t> size_q8_{};                ///< at least the largest part of these ways
  bool fits_ = false;                               ///< the way to the present end is known
};

}  // namespace lamplock::motion
