// The maximum number of points of a discretiser. Called by the discretisers while they run, so that
// a spacing in the wrong unit ends with an error and not with exhausted memory.
#pragma once

#include <cstddef>
#include <string>

namespace lamplock::geometry {

/// Ten times the largest object in "Mechatronic positioning of a pulsed laser beam in devices
/// forming 3-D objects in glass" (2 000 000 points).
inline constexpr std::size_t max_points = 20'000'000;

/// Throws Error (bad_input) if `count` is more than max_points. A double so that an estimate
/// cannot overflow.
void require_count(double count, const std::string& where);

/// Larger than any quantity of a machine or a model, in any unit: a larger value is a mistake.
inline constexpr double max_value = 1e15;

/// Throws Error (bad_input) unless `value` is greater than 0 and at most max_value.
void require_positive(double value, const std::string& where, const std::string& name);

}  // namespace lamplock::geometry
