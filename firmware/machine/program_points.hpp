// From a move of a program to a point on the beat: where, how soon, and whether to fire there.
//
// In:  moves of the interpreter while beat lock is on, the settings. Out: targets of a job.
// Who: the program reader, once a move; main loop, some 64-bit divisions and a root.
//
// A feed move that ends where the program says so fires there once; rapids and the pieces of a
// curve but for the last pass without a shot. What no word forbids is the order of M130 itself: the
// words of a spindle mean nothing to a shot. Where the spindle is a laser ($32) they do: M5 and S0
// pass without a shot, and S is the value of the attenuator.
#pragma once

#include <cstdint>

#include "firmware/motion/target.hpp"
#include "firmware/program/action.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

/// Ends of a move, steps.
struct MoveEnds {
  StepPosition from{}, to{};
};

/// The target for a move, fired through `channel`. Its beats are the fewest for which the feed, or
/// of a rapid the highest speed of every axis, is not exceeded.
motion::Target point_target(const program::Action& move, const MoveEnds& ends, std::uint8_t channel,
                            const settings::Values& values);

}  // namespace lamplock::machine
