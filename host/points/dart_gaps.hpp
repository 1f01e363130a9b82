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

/// A Piece has measure() (area or volume), radius_mm, box(), and is_covered(darts). A Body gives
///   std::optional<Dart> dart_in(const Piece&, Random&)   empty outside the body,
///   void split(const Piece&, std::vector<Piece>&)        adds nothing if the piece is too small.
///
/// Darts near most parts of a divided piece cover them already. Such parts get no turn: that saves
/// sorting them and a search for darts near each. They still take their random number, so that the
/// points do not depend on when a covered part is found.
template <class Piece, class Body>
void fill_gaps(BlockDarts& block, std::vector<Piece> pieces, geometry::Random& random,
               const Body& body) {
  std::vector<Piece> smaller;
  std::vector<bool> covered(pieces.size(), false), smaller_covered;  // of each piece
  std::vector<std::pair<double, std::uint32_t>> turns;
  NearDarts near;
  while (!pieces.empty()) {
    turns.clear();
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
      const double uniform = random.uniform();
      if (covered[i]) continue;
      // Random times of the first of uniformly distributed darts: earlier for larger pieces.
      turns.emplace_back(-std::log(1 - uniform) / pieces[i].measure(), i);
    }
    std::sort(turns.begin(), turns.end());
    smaller.clear();
    smaller_covered.clear();
    for (const auto& turn : turns) {
      const Piece& piece = pieces[turn.second];
      if (piece.is_covered(block)) continue;
      const auto dart = body.dart_in(piece, random);
      if (dart && block.is_free(dart->place, dart->radius_mm)) {
        block.add(*dart);
        near.clear();
        near.add(dart->place, dart->radius_mm);
        if (piece.is_covered(near)) continue;  // no other dart covers it
      }
      body.split(piece, smaller);
      if (smaller.size() > smaller_covered.size())
        block.find_near(piece.box(), piece.radius_mm, near);
      for (std::size_t i = smaller_covered.size(); i < smaller.size(); ++i)
        smaller_covered.push_back(smaller[i].is_covered(near));
    }
    pieces.swap(smaller);
    covered.swap(smaller_covered);
  }
}

}  // namespace lamplock::points
