// Converts runs of axes to runs of motors, where two axes share two motors (shared/kinematics.hpp).
//
// In:  the runs of both axes, over ticks in which neither changes its acceleration.
// Out: the runs of both motors: sums and differences, which have constant acceleration as well.
// Who: the tick generator, in the fill interrupt. Budget: some 100 cycles a pair and piece; 600
//      more where a motor reverses inside a piece, which axes do not.
//
// Axes reverse between pieces, motors anywhere in them. A run must not reverse, so the piece is cut
// there; the tick is found by bisection, since this interrupt does not divide.
#pragma once

#include <cstdint>

#include "firmware/stepper/segment.hpp"
#include "firmware/stepper/tick_block.hpp"
#include "shared/kinematics.hpp"

namespace lamplock::stepper {

/// Run of the first or second motor of a pair. It rests in the middle of a step where both axes do.
AxisRun motor_run(const AxisPair& pair, const AxisRun& u, const AxisRun& v, bool second);

/// The runs of axes from which the runs of these motors were made.
struct AxisRuns {
  AxisRun first, second;
};
AxisRuns axis_runs(const AxisPair& pair, const AxisRun& first, const AxisRun& second);
/// The same for all axes of a block.
inline PerAxis<AxisRun> axis_runs(const Kinematics& kinematics, const PerAxis<AxisRun>& motors) {
  PerAxis<AxisRun> axes = motors;
  for (const AxisPair& pair : kinematics.pairs()) {
    const AxisRuns runs = axis_runs(pair, motors[pair.first], motors[pair.second]);
    axes[pair.first] = runs.first;
    axes[pair.second] = runs.second;
  }
  return axes;
}

/// Moves both axes of a pair to the whole steps of their motors; this is no motion. The axes of a
/// CoreXY are in the middle of a step, or both on the edge between two.
void snap_to_motors(const AxisPair& pair, Int128& first_q64, Int128& second_q64);
inline void snap_to_motors(const Kinematics& kinematics, MotionState& state) {
  for (const AxisPair& pair : kinematics.pairs())
    snap_to_motors(pair, state.axis[pair.first].position_q64, state.axis[pair.second].position_q64);
}

/// For how many of n ticks, at least one and fewer than 2^16, a run keeps its first direction.
std::uint32_t ticks_one_way(const AxisRun& run, std::uint32_t n);

}  // namespace lamplock::stepper
