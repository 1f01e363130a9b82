// The three planners. The image of a board with little memory has room for one of them at a time.
//
// In:  what is about to run: lines of a program, or points with a way to join them.
// Out: the planner that it needs.
// Who: planning.hpp asks for a planner; the board loads it.
#pragma once

#include <cstdint>

#include "shared/wire/target.hpp"

namespace lamplock::machine {

/// A planner; start-stop is a case of the free one.
enum class PlannerKind : std::uint8_t { none, lines, path, free };

inline PlannerKind planner_of(wire::JoinMode mode) {
  return mode == wire::JoinMode::path ? PlannerKind::path : PlannerKind::free;
}

}  // namespace lamplock::machine
