// A as a rotary axis ($967): its places are degrees.
//
// Feed (NIST, "The NIST RS274/NGC Interpreter - Version 3", section 2.1.2.5): F is the speed of X,
// Y and Z along their path if one of them moves; A then arrives at the same time. If A moves alone,
// F is degrees a minute. The planner knows one speed, along the path of all axes, so the feed of a
// move is converted before.
#pragma once

#include <cstdint>

#include "firmware/program/value.hpp"

namespace lamplock::program {

/// Speed along the path of all axes of a straight move, for a programmed feed of um/min. In inches
/// a feed of A alone was read as inches a minute and is degrees a minute.
[[gnu::cold]] std::uint32_t feed_of_all_axes(std::uint32_t feed_um_min, const Place& from,
                                             const Place& to, bool inches);

/// The place nearest to `from` that differs from `to` by whole turns; of two the upper one.
[[gnu::cold]] std::int64_t shortest_way_e7(std::int64_t from_e7, std::int64_t to_e7);

}  // namespace lamplock::program
