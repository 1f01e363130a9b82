// Puts things into an order that is known by their numbers, in the place where they are: a second
// cloud of millions of points would take as much memory again. Called wherever an order has been
// found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lamplock::order {

/// Numbers of points, each once.
using Indices = std::vector<std::uint32_t>;

/// Afterwards the i-th is the one that was `order[i]`-th. Time linear.
template <class Thing>
void permute(std::span<Thing> things, Indices order) {
  for (std::uint32_t first = 0; first < order.size(); ++first) {
    if (order[first] == first) continue;
    // Round the circle of those that take each other's place.
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
