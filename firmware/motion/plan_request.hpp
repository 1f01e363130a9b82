// What a window of targets is planned for.
//
// In:  filled by the job runner (main loop), before each plan.
// Out: read by the planners (planner.hpp, path_planner.hpp), which find everything they need in it.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/point_queue.hpp"
#include "firmware/motion/way.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

using stepper::AxisProfile;
using stepper::AxisState;
using stepper::MotionState;
using stepper::Segment;

/// Segments made of a window, at most; the points behind them are what the plan looks ahead. Four
/// are enough: with more of them the plans are no shorter.
inline constexpr std::uint32_t commit_points = window_points - 4;

/// Points behind a window that are looked at for the length of a row (run_up.hpp).
inline constexpr std::uint32_t run_horizon = 256;

/// What a window is planned for.
struct PlanRequest {
  const PointQueue* queue = nullptr;
  /// Indices into the queue, in order; one several times for as many flashes.
  std::array<std::uint32_t, window_points> points{};
  std::uint32_t count = 0;  ///< 1..window_points
  /// Targets before this index may be looked at: the window's and those behind it. The same points
  /// must always give the same plan: up to the horizon or the end of the job.
  std::uint32_t known_end = 0;
  JoinMode mode = JoinMode::free;
  bool follows = false;          ///< the start is where the plan before ended, on the same way
  bool rest_at_end = true;       ///< no point is known behind the last one
  std::int32_t least_beats = 1;  ///< between points, for a highest shot rate
  /// At rest at points[i], whatever the mode.
  std::array<bool, window_points> rest{};
  /// 0: the beats of the target hold. Else the planner chooses, but no fewer than these.
  std::array<std::uint16_t, window_points> at_least{};
  const Limits* limits = nullptr;
  MotionState start;  ///< on a lattice tick

  /// Points of the window that become segments.
  std::uint32_t commits() const { return count < commit_points ? count : commit_points; }
};

}  // namespace lamplock::motion
