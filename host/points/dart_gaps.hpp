// Fills the gaps between random darts: pieces that no single dart covers get a dart each in random
// order, and pieces that are still open are divided until they are small enough. Called by
// blue_noise() with triangles and by fill_solid() with cubes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/geometry/random.hpp"
#include "host/points/poisson_blocks.hpp"

namespace lamplock::points {

/// A Piece has measure() (area or volume) and is_covered(block). A Body gives
///   std::optional<Dart> dart_in(const Piece&, Random&)   empty outside the body,
///   void split(const Piece&, std::vector<Piece>&)        adds nothing if the piece is too small.
template <class Piece, class Body>
void fill_gaps(BlockDarts& block, std::vector<Piece> pieces, geometry::Random& random,
               const Body& body) {
  std::vector<Piece> smaller;
  std::vector<std::pair<double, std::uint32_t>> turns;
  while (!pieces.empty()) {
    turns.clear();
    for (const Piece& piece : pieces) {
      // Random times of the first of uniformly distributed darts: earlier for larger pieces.
      turns.emplace_back(-std::log(1 - random.uniform()) / piece.measure(),
                         static_cast<std::uint32_t>(turns.size()));
    }
    std::sort(turns.begin(), turns.end());
    smaller.clear();
    for (const auto& turn : turns) {
      const Piece& piece = pieces[turn.second];
      if (piece.is_covered(block)) continue;
      const auto dart = body.dart_in(piece, random);
      if (dart && block.is_free(dart->place, dart->radius_mm)) {
        block.add(*dart);
        if (piece.is_covered(block)) continue;
      }
      body.split(piece, smaller);
    }
    pieces.swap(smaller);
  }
}

}  // namespace lamplock::points
