// Cutter compensation (G41, G42): the moves that wait for the next one.
//
// In:  programmed moves in the plane, one at a time.
// Out: the same moves for the centre of the cutter, whose ends are known when the next move is.
// Who: the interpreter (interpreter_compensation.cpp), main loop.
//
//   line of the program   actions that it releases
//   G41.1 D1
//   G1 X10 (entry)        -                            the entry waits
//   G4 P1                 -                            waits as well, up to three actions
//   Y10                   entry, dwell, [arc round the corner]       Y10 waits
//   G40                   Y10
//
// One move waits, with the actions of up to three lines after it that do not move in the plane. A
// corner is checked before the move that ends at it is released: the line that makes a corner into
// which the cutter does not fit is refused, and the move before it is not made.
//
// The object lives in the memory of rows and cycles, which are refused while it is in use.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/program/action.hpp"
#include "firmware/program/compensation_geometry.hpp"
#include "firmware/program/curves/arc.hpp"

namespace lamplock::program {

class Compensation {
 public:
  /// Actions that can wait between two moves in the plane.
  static constexpr std::uint32_t max_between = 3;

  /// A move that waits.
  struct Held {
    Action action;      ///< its target is programmed, not rotated
    Place start_e7;     ///< programmed
    PlanePoint centre;  ///< of an arc
    PlanePoint begin, end;
    bool arc, clockwise;
  };

  /// No move waits.
  void begin(std::int64_t radius_e7, bool left, const CurvePlane& plane) {
    offset_.begin(radius_e7, left);
    plane_ = plane;
    holds_ = arc_ = false;
    between_count_ = 0;
  }

  const CutterOffset& offset() const { return offset_; }
  const CurvePlane& plane() const { return plane_; }
  bool holds() const { return holds_; }
  const Held& held() const { return held_; }
  PlanePoint in_plane(const Place& place) const {
    return {place[plane_.first], place[plane_.second]};
  }
  /// A place with other coordinates in the plane.
  Place put(Place place, const PlanePoint& point) const {
    place[plane_.first] = point.first_e7;
    place[plane_.second] = point.second_e7;
    return place;
  }

  // Checks; false: the cutter does not fit. Both fix the end of the move that waits.
  bool join(const PlaneBlock& next);
  bool finish();
  /// The first move: from where the machine is. False if it is not longer than the radius.
  bool enter(const PlaneBlock& entry);

  // What was held is released: the move, as a line or the arc of `held_arc()`, then the actions.
  /// The move is an arc, and some of it is left.
  bool is_curve() const { return held_.arc && part_ != BlockPart::none; }
  ArcRequest held_arc(std::int64_t tolerance_e7) const;
  Place held_end() const { return put(held_.action.target_e7, held_.end); }
  std::uint32_t between_count() const { return between_count_; }
  const Action& between(std::uint32_t i) const { return between_[i]; }
  /// Room for one more action that waits.
  Action& add_between() { return between_[between_count_++]; }

  // The corner before the next move.
  bool has_corner() const { return arc_; }
  ArcRequest corner_arc(const Place& programmed, std::int64_t tolerance_e7) const;
  void end_corner() { arc_ = false; }

  /// Drops what was held and returns the place of the next move, which begins at the corner.
  Held& hold();
  /// Nothing is held any longer.
  void release() {
    holds_ = false;
    between_count_ = 0;
  }

 private:
  PlaneBlock block() const {
    return {in_plane(held_.start_e7), in_plane(held_.action.target_e7), held_.centre, held_.arc,
            held_.clockwise};
  }
  bool end_at(const PlanePoint& end);

  Held held_;
  std::array<Action, max_between> between_;
  PlanePoint begin_;  ///< of the next move
  CutterOffset offset_;
  CurvePlane plane_;
  std::uint8_t between_count_;
  BlockPart part_;
  bool holds_, arc_;
};

}  // namespace lamplock::program
