// The request to plan a window of targets.
//
// In:  filled by the job runner (main loop), before each plan.
// Out: read by the planners (planner.hpp, path/planner.hpp), which need no other data.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/point_queue.hpp"
#include "firmware/motion/profile/limits.hpp"
#include "firmware/motion/profile/window.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

using stepper::AxisProfile;
using stepper::AxisState;
using stepper::MotionState;
using stepper::Segment;

/// What a window is planned for.
struct PlanRequest {
  const PointQueue* queue = nullptr;
  /// Indices into the queue, in order; repeated once per flash.
  std::array<std::uint32_t, window_points> points{};
  std::uint32_t count = 0;  ///< 1..window_points
  /// Targets before this index may be read: the window's and those after it. The same points must
  /// always give the same plan: up to the horizon or the end of the job.
  std::uint32_t known_end = 0;
  wire::JoinMode mode = wire::JoinMode::free;
  bool follows = false;        ///< the start is where the previous plan ended, on the same way
  bool rest_at_end = true;     ///< no point is known after the last one
  std::int32_t min_beats = 1;  ///< between points, from the maximum shot rate
  /// Rest at points[i], in every mode.
  std::array<bool, window_points> rest{};
  /// 0: the beats of the target hold. Otherwise the planner chooses at least this many.
  std::array<std::uint16_t, window_points> at_least{};
  const Limits* limits = nullptr;
  MotionState start;  ///< on a lattice tick

  /// Points of the window that become segments.
  std::uint32_t commits() const { return count < commit_points ? count : commit_points; }
};

}  // namespace lamplock::motion
