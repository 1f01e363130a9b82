// Parallel loops. Called by the discretisers.
#pragma once

#include <cstddef>
#include <functional>

namespace lamplock::geometry {

/// Calls `work(i)` once for every i below `count`, on `threads` threads (0: as many as the
/// processor has), in any order. The first exception ends the work and is thrown again.
void for_each_index(std::size_t count, unsigned threads,
                    const std::function<void(std::size_t)>& work);

}  // namespace lamplock::geometry
