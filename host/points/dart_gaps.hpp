// The gaps that random darts leave: pieces that no single dart covers are hit in random order, and
// what is still open is cut smaller until it is too small to matter. Called by blue_noise() with
// triangles and by fill_solid() with cubes.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/points/dart_blocks.hpp"
#include "host/points/random.hpp"

namespace lamplock::points {

/// A Piece has `corners` (of a convex body), `radius_mm` (of a dart in it), `turn` (set here) and
/// measure() (area or volume). A Body gives
///   std::optional<Dart> dart_in(const Piece&, Random&)   nothing where the body is not,
///   void split(const Piece&, std::vector<Piece>&)        adds nothing if the piece is too small.
template <class Piece, class Body>
void fill_gaps(BlockDarts& block, std::vector<Piece> pieces, Random& random, const Body& body) {
  std::vector<Piece> smaller;
  while (!pieces.empty()) {
    // First arrivals of darts that fall everywhere alike: the larger a piece, the sooner.
    for (Piece& piece : pieces) piece.turn = -std::log(1 - random.uniform()) / piece.measure();
    std::sort(pieces.begin(), pieces.end(),
              [](const Piece& p, const Piece& q) { return p.turn < q.turn; });
    smaller.clear();
    for (const Piece& piece : pieces) {
      if (block.is_covered(piece.corners, piece.radius_mm)) continue;
      const auto dart = body.dart_in(piece, random);
      if (dart && block.is_free(dart->place, dart->radius_mm)) {
        block.add(*dart);
        if (block.is_covered(piece.corners, piece.radius_mm)) continue;
      }
      body.split(piece, smaller);
    }
    pieces.swap(smaller);
  }
}

}  // namespace lamplock::points
