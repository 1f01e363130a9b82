// The most points a discretiser makes. Called by the discretisers while they run, so that a spacing
// given in the wrong unit ends in one line and not in exhausted memory.
#pragma once

#include <cstddef>
#include <string>

namespace lamplock::points {

/// Ten times the largest object that "Mechatronic positioning of a pulsed laser beam in devices
/// forming 3-D objects in glass" claims (2 000 000 points).
inline constexpr std::size_t most_points = 20'000'000;

/// Throws Error (bad_input) if `count` is more than most_points. A double so that an estimate
/// cannot overflow.
void require_count(double count, const std::string& where);

/// No quantity of a machine or a model is greater, in any unit: more has been typed by mistake.
inline constexpr double max_value = 1e15;

/// Throws Error (bad_input) unless `value` is greater than 0 and at most max_value.
void require_positive(double value, const std::string& where, const std::string& name);

}  // namespace lamplock::points
