// Converts programmed moves to machine moves: millimetres to steps, S words to power.
//
// In:  moves of the interpreter, the settings. Out: lines for the planner, in steps.
// Who: the code that runs a program, once a move; main loop, two products of 32 bits an axis in
//      place of divisions.
//
// A programmed position is rounded only here, once: to the nearest step, where the machine stops,
// and within that to 1/256 step, for the direction of the line (motion/line/place.hpp).
#pragma once

#include <cstdint>

#include "firmware/motion/line/ring.hpp"
#include "firmware/program/action.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

/// A place in steps: the nearest ones, half away from zero, and the offset from their middle, at
/// most motion::max_off_q8; axes that the machine lacks stay at 0.
void find_place(const program::Place& place_e7, const settings::Values& values,
                motion::LinePlace& place);
/// Only its steps.
StepPosition steps_of(const program::Place& place_e7, const settings::Values& values);

/// Position of an axis at a step, 10^-7 mm.
std::int64_t place_of(std::int32_t step, const settings::Values& values, int axis);

/// The same for an axis at its position, 10^-7 mm: the axes of a CoreXY may rest on the edge
/// between two steps, half a step from the middle of either.
std::int64_t place_of(const stepper::AxisState& axis, const settings::Values& values, int a);

/// First axis on which a position is outside the work space; -1 if it is inside.
int axis_outside(const StepPosition& steps, const StepLimits& space, int axes);

/// Power for an S word in thousandths, 0..motion::full_power; values above $30 are full power.
std::uint16_t power_of(std::uint32_t speed_milli, const settings::Values& values);

/// The line for a move, every member of it.
void find_target(const program::Action& move, const settings::Values& values,
                 motion::LineTarget& line);

}  // namespace lamplock::machine
