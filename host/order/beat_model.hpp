// How many beats the planner will spend on points in a given order. Comes in: what the machine can
// do, points. Goes out: beats. Called by the search for an order with few beats, from several
// threads: tens of nanoseconds a point.
//
// In free mode each axis moves on its own with |a| <= A and |v| <= V, and axes meet at the points
// only. For a displacement in k beats the speeds that can be reached from an interval of speeds are
// an interval, in closed form (docs/planning.md, section 2). So the speeds possible at a point are
// a box; the model goes from box to box with the fewest beats that leave any speed at all. The
// planner looks ahead and may spend a beat early to save two later; work space and rounding to
// steps are left out.
#pragma once

#include <array>
#include <span>

#include "host/order/motion.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// The speeds that are possible at a point, per axis, in units of A * beat.
struct SpeedBox {
  std::array<double, 3> low{}, high{};
  friend bool operator==(const SpeedBox&, const SpeedBox&) = default;
};

/// What a plan may have come to at a point: the speeds of a plan with the fewest beats, and those
/// of one that has spent a beat more, which often saves it again later.
struct PlanState {
  SpeedBox least{}, late{};
  bool has_late = false;
  friend bool operator==(const PlanState&, const PlanState&) = default;
};

class BeatModel {
 public:
  /// Throws Error (bad_input) for a limit or a beat that is not positive.
  explicit BeatModel(const Motion& motion);

  /// By how much the fewest beats grow from a point to the next, at least 1; `state` at the first
  /// becomes that at the next.
  int step(PlanState& state, const points::Point& from, const points::Point& to) const;

  /// Beats of a whole order that begins at rest in its first point.
  long beats(std::span<const points::Point> order) const;

  /// A * beat^2 of an axis, mm: the way that counts as long.
  double unit_mm(std::size_t axis) const { return unit_mm_[axis]; }
  /// Any speed that the axes may have.
  PlanState any_speed() const;

 private:
  using Way = std::array<double, 3>;
  int feasible_beats(const SpeedBox& speeds, const Way& way, int first, SpeedBox& to) const;
  int least_beats(const SpeedBox& speeds, const Way& way) const;
  bool reach(const SpeedBox& from, const Way& way, double beats, SpeedBox& to) const;

  std::array<double, 3> unit_mm_{}, per_mm_{}, limit_{};
};

}  // namespace lamplock::order
