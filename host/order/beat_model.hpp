// Predicts the beats that the planner will need for points in a given order. In: limits of the
// machine, points. Out: beats. Called by the search for an order with few beats, from several
// threads: tens of nanoseconds a point. All axes are computed at once, as floats (lanes.hpp).
//
// In free mode each axis moves on its own with |a| <= A and |v| <= V, and axes meet at the points
// only. For a displacement in k beats the speeds reachable from an interval of speeds are an
// interval, in closed form (docs/planning.md, section 2). So the reachable speeds at a point are a
// box; the model steps from box to box with the minimum number of beats for a box that is not
// empty. Not in the model: the planner's look-ahead, which may spend a beat early to save two
// later, the work space, and rounding to steps.
#pragma once

#include <array>
#include <span>

#include "host/geometry/point.hpp"
#include "host/order/lanes.hpp"
#include "host/order/motion.hpp"

namespace lamplock::order {

/// The reachable speeds at a point, per axis, in units of A * beat.
struct SpeedBox {
  Lanes low, high;
  friend bool operator==(const SpeedBox&, const SpeedBox&) = default;
};

/// The reachable speeds at a point of a plan with the fewest beats, and those of a plan with one
/// more beat, which often saves it again later.
struct PlanState {
  SpeedBox least{}, late{};
  bool has_late = false;
  friend bool operator==(const PlanState&, const PlanState&) = default;
};

class BeatModel {
 public:
  /// Throws Error (bad_input) for a limit or a beat that is not positive.
  explicit BeatModel(const Motion& motion);

  /// Beats from a point to the next, at least 1; advances `state` from the first to the next.
  int step(PlanState& state, const geometry::Point& from, const geometry::Point& to) const;

  /// Beats of a whole order that begins at rest in its first point.
  long beats(std::span<const geometry::Point> order) const;

  /// A * beat^2 of an axis, mm: the unit for displacements.
  double unit_mm(std::size_t axis) const { return unit_mm_[axis]; }
  /// A state with all speeds that the axes may have.
  PlanState any_speed() const;

 private:
  int feasible_beats(const SpeedBox& speeds, const Lanes& way, int first, SpeedBox& to) const;
  int min_beats(const SpeedBox& speeds, const Lanes& way) const;
  bool reach(const SpeedBox& from, const Lanes& way, int beats, SpeedBox& to) const;

  std::array<double, 3> unit_mm_{};
  Lanes per_mm_, limit_;
};

}  // namespace lamplock::order
