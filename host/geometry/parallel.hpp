// Parallel loops. Called by the discretisers.
#pragma once

#include <cstddef>
#include <functional>

namespace lamplock::geometry {

/// Calls `work(i)` once for every i below `count`, on `threads` threads (0: as many as the
/// processor has), in any order. An exception ends the work; that of the lowest i is thrown
/// again, which does not depend on the number of threads.
void for_each_index(std::size_t count, unsigned threads,
                    const std::function<void(std::size_t)>& work);

}  // namespace lamplock::geometry
