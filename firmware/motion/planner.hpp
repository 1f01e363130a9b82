// The planner: how many beats to each point, and at which speed through it.
//
// In:  a window of targets (up to `window_points`) and the state the machine starts from.
// Out: segments of whole beats that end exactly on the targets, the last one at rest.
// Called from the main loop by the job runner; nothing here runs in an interrupt.
//
// free mode: a beam search over beats. A label is a number of beats and, per axis, the interval of
// speeds the machine can have at the point (reach.hpp); the axes couple only through the common
// beats, so propagating intervals is exact. The window ends at rest. From the best chain of labels
// the speeds are chosen backwards, as near to the chord slope as the intervals allow.
//
// start-stop mode is the same search with every interval the single speed zero.
//
// Limits hold by construction: profiles are made for planning limits that leave room for rounding
// and are then checked against the true ones, work space included. A segment that leaves the work
// space makes both its ends points of rest and the window is planned again: between rests every
// axis moves monotonically between two points inside.
//
// Why a stop is always possible: the window ends at rest inside the limits, and braking every axis
// at its full acceleration from any state of the plan stops it no further out than the plan goes.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/point_queue.hpp"
#include "firmware/motion/reach.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

using stepper::AxisProfile;
using stepper::AxisState;
using stepper::MotionState;
using stepper::Segment;

inline constexpr std::uint32_t window_points = 16;
/// Labels kept per point; two are within 0.02 % of the exact optimum on walks.
inline constexpr std::size_t beam_width = 2;

/// What a window is planned for.
struct PlanRequest {
  const PointQueue* queue = nullptr;
  std::array<std::uint32_t, window_points> points{};  ///< indices into the queue, in order
  std::uint32_t count = 0;                            ///< 1..window_points
  JoinMode mode = JoinMode::free;
  std::int32_t least_beats = 1;  ///< between points, for a highest shot rate
  const Limits* limits = nullptr;
  MotionState start;  ///< on a lattice tick
};

/// Plans windows. Holds only scratch memory; a plan depends on the request alone.
class Planner {
 public:
  /// Plans the request; afterwards segment(i) is the way to points[i]. Error: unreachable, with
  /// the position in the window in `failed`; then nothing may be used.
  Result plan(const PlanRequest& request, std::uint32_t& failed);

  const Segment& segment(std::uint32_t i) const { return segments_[i]; }
  std::int32_t beats(std::uint32_t i) const { return beats_[i]; }

 private:
  struct Label {
    std::int32_t total = 0;  ///< beats from the start of the window
    std::int32_t beats = 0;  ///< beats of the last segment
    std::int32_t next = 0;   ///< least beats of the segment behind, for ranking
    std::uint8_t parent = 0;
    PerAxis<SpeedInterval> box{};
  };
  struct Stage {
    std::array<Label, beam_width> labels{};
    std::size_t count = 0;
    PerAxis<std::int64_t> displacement_q32{};  ///< normalised, to this point
    std::int32_t first_beats = 0;  ///< no fewer at full speed; 0 = more than there may be
    bool rest = false;             ///< every speed at this point is zero
  };

  Result set_up(const PlanRequest& request, std::uint32_t& failed);
  Result search(const PlanRequest& request, std::uint32_t& failed);
  bool extend(const PlanRequest& request, std::uint32_t i);
  bool step(const Label& from, const Stage& to, std::int32_t beats, Label& result) const;
  bool can_step(const Label& from, const Stage& to, std::int32_t beats) const;
  std::int32_t first_beats(const Stage& to) const;
  std::int32_t fewest_beats(const Label& from, const Stage& to) const;
  bool at_rest_possible(const Label& label) const;
  static bool too_late(const Stage& stage, std::int32_t total, const Stage* next);
  void keep(Stage& stage, Label& label, const Stage* next);
  void choose_speeds(const PlanRequest& request);
  std::int64_t wanted_speed_q32(const PlanRequest& request, std::uint32_t i, int axis) const;
  bool make_segments(const PlanRequest& request, bool& again);
  void make_segment(const PlanRequest& request, std::uint32_t i, const MotionState& from);
  bool inside(std::uint32_t i, const MotionState& from) const;
  std::uint32_t shot_window_ticks(std::uint32_t i) const;

  const Limits* limits_ = nullptr;
  std::int32_t least_beats_ = 1;
  std::int32_t most_beats_ = 1;   ///< so that the ticks of a segment stay in 31 bits
  std::int64_t extra_beats_ = 0;  ///< beyond the first ones, until a label is given up
  Label start_;
  std::array<Stage, window_points> stages_{};
  std::array<std::int32_t, window_points> beats_{};
  std::array<PerAxis<std::int64_t>, window_points> speed_q32_{};
  std::array<Segment, window_points> segments_{};
};

}  // namespace lamplock::motion
