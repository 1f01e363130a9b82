// From what a program asks for to what the machine does: millimetres become steps, S words power.
//
// In:  moves of the interpreter, the settings. Out: lines for the planner, in steps.
// Who: whoever runs a program, once a move; main loop, four divisions of 64 bits and as many of 32.
//
// This is the one place where a programmed position is rounded, once: to the nearest step, where
// the machine stands at the end, and inside of that to 1/256 step, where the line leads
// (motion/line_place.hpp).
#pragma once

#include <cstdint>

#include "firmware/motion/line_ring.hpp"
#include "firmware/program/action.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

/// A place in steps: the nearest ones, half away from zero, and how far beside their middle, at
/// most motion::most_off_q8; axes that the machine does not have stay at 0.
motion::LinePlace line_place(const program::Place& place_e7, const settings::Values& values);
/// Its steps alone.
StepPosition steps_of(const program::Place& place_e7, const settings::Values& values);

/// Where an axis is at a step, 10^-7 mm.
std::int64_t place_of(std::int32_t step, const settings::Values& values, int axis);

/// The same for an axis at its position, 10^-7 mm: the axes of a CoreXY may rest on the edge
/// between two steps, half a step from the middle of either.
std::int64_t place_of(const stepper::AxisState& axis, const settings::Values& values, int a);

/// First axis on which a position is outside the work space; -1 if it is inside.
int axis_outside(const StepPosition& steps, const StepLimits& space, int axes);

/// Power for an S word in thousandths, 0..motion::full_power; more than $30 is full power.
std::uint16_t power_of(std::uint32_t speed_milli, const settings::Values& values);

/// The line for a move.
motion::LineTarget line_target(const program::Action& move, const settings::Values& values);

}  // namespace lamplock::machine
