// Permutes a range in place, given the new order of its indices: a second cloud of millions of
// points would double the memory. Called after every search for an order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lamplock::order {

/// Numbers of points, each once.
using Indices = std::vector<std::uint32_t>;

/// The new i-th element is the old `order[i]`-th. Time linear.
template <class Thing>
void permute(std::span<Thing> things, Indices order) {
  for (std::uint32_t first = 0; first < order.size(); ++first) {
    if (order[first] == first) continue;
    // Follows one cycle of the permutation.
    Thing moved = std::move(things[first]);
    std::uint32_t to = first;
    for (std::uint32_t from = order[to]; from != first; from = order[to]) {
      things[to] = std::move(things[from]);
      order[to] = to;
      to = from;
    }
    things[to] = std::move(moved);
    order[to] = to;
  }
}

}  // namespace lamplock::order
