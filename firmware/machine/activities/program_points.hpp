// Converts a move of a program to a point on the beat: where, how soon, and whether to fire there.
//
// In:  moves of the interpreter while beat lock is on, the settings. Out: targets of a job.
// Who: the program reader, once a move; main loop, some 64-bit divisions and a root.
//
// A feed move fires once at its programmed end; rapids, and all pieces of a curve but the last,
// pass without a shot. M130 itself orders the shots, so the words of a spindle do not affect them.
// Where the spindle is a laser ($32) they do: M5 and S0 suppress the shot, and S is the value of
// the attenuator.
#pragma once

#include <cstdint>

#include "firmware/program/action.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/target.hpp"

namespace lamplock::machine {

/// Ends of a move, steps.
struct MoveEnds {
  StepPosition from{}, to{};
};

/// The target for a move, fired through `channel`. Its beats are the minimum at which the feed
/// rate, or for a rapid the maximum speed of every axis, is not exceeded.
wire::Target point_target(const program::Action& move, const MoveEnds& ends, std::uint8_t channel,
                          const settings::Values& values);

}  // namespace lamplock::machine
