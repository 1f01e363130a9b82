// Chains of edges joined at their ends, the nearest ends first.
//
// In:  open chains, the tolerance. Out: contours, and the gaps that were closed.
// Who: join_contours().
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

/// A contour with the number of its first chain.
using JoinedChain = std::pair<std::size_t, Contour>;

/// A chain shorter than so many gaps is a part of the gap: it is not closed over it, and the ends
/// at both sides of it are not at one place.
inline constexpr double min_loop_gaps = 4;

/// Joins open chains of one layer whose ends are nearer than the tolerance. A closed gap that is
/// more than the rounding of a file is added to the faults.
std::vector<JoinedChain> join_chains(std::vector<Contour> chains, double tolerance_mm,
                                     std::vector<Fault>& faults);

/// Removes edges without length and makes neighbours meet exactly.
void connect(Contour& contour);

}  // namespace lamplock::cutting
