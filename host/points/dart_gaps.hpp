// Fills the gaps between random darts: pieces that no single dart covers get a dart each in random
// order, and pieces that are still open are divided until they are small enough. In: pieces of a
// body and the darts of a block. Out: more darts. Called by blue_noise() with triangles and by
// fill_solid() with cubes.
//
// A dart covers a piece if it excludes other darts from all corners. So each corner has the set of
// darts that exclude others from it, and a piece is covered if a dart is in all of its sets. Parts
// of a piece share most corners: only new corners need a comparison with the darts near the piece.
//
// Every piece refers to a list of the darts near it; its parts use the same list. Darts that are
// added later are found by their number when it is the turn of the piece. A list has room for 64
// darts, and darts of other radii exclude others within another distance: where a list may lack
// darts, the piece gets a list of its own when it is its turn.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <boost/sort/pdqsort/pdqsort.hpp>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/random.hpp"
#include "host/points/near_darts.hpp"
#include "host/points/poisson_blocks.hpp"

namespace lamplock::points {

/// A ball.
struct Ball {
  geometry::Point centre;
  double radius_mm = 0;
};

/// A piece and, for each corner, the darts that exclude others from it. A Piece has corner_count,
/// corner(i), ball() (one that contains the piece), measure() (area or volume) and radius_mm (of
/// darts in it).
template <class Piece>
struct SeenPiece {
  Piece piece;
  std::array<DartSet, Piece::corner_count> at_corner{};

  /// Compares all corners with the darts from number `first`; those before it have been compared.
  void look(const NearDarts& near, std::size_t first = 0) {
    for (std::size_t i = 0; i < at_corner.size(); ++i)
      at_corner[i] |= near.excluding(piece.corner(i), piece.radius_mm, first);
  }
  bool is_covered() const { return have_common_dart(at_corner); }
};

/// A Body gives
///   Dart dart_in(const Piece&, Random&)            a random one,
///   bool contains(const Piece&, const Point&)      a place in the piece is in the body too,
///   void split(const SeenPiece<Piece>&, const NearDarts&, found)
///       calls found(const SeenPiece<Piece>&) with each part that is not covered; does nothing if
///       the piece is too small.
template <class Piece, class Body>
class GapFiller {
 public:
  GapFiller(BlockDarts& block, const Body& body, geometry::Random& random)
      : block_(block), body_(body), random_(random), near_(block.units()) {}

  /// Finds the darts near a piece, for add() with its parts.
  const NearDarts& look_round(const Piece& piece) {
    // The last list may have got no piece.
    indices_.resize(open_.empty() ? 0 : open_.back().list.first + open_.back().list.count);
    list_all(piece);
    return near_;
  }

  /// Adds a piece that is not covered by the darts that look_round() has found near it.
  void add(const SeenPiece<Piece>& seen) { open_.push_back({seen, list_}); }

  /// Fills the gaps in all pieces.
  void fill() {
    constexpr std::size_t turns_ahead = 8;  // of the piece that the processor loads
    while (!open_.empty()) {
      choose_turns();
      for (std::size_t i = 0; i < turns_.size(); ++i) {
        if (i + turns_ahead < turns_.size()) __builtin_prefetch(&open_at(turns_[i + turns_ahead]));
        fill(open_at(turns_[i]));
      }
      open_.swap(smaller_);
      smaller_.clear();
    }
  }

 private:
  /// Darts near a piece: a range of `indices_`.
  struct List {
    std::uint32_t first = 0, count = 0;
    BlockDarts::Index compared = 0;  // darts of the block up to now
    double reach_mm = 0;             // the darts that exclude one of this radius are in the list
  };
  struct Open {
    SeenPiece<Piece> seen;  // compared with the darts of the list
    List list;
  };

  Open& open_at(std::uint64_t turn) { return open_[turn & 0xFFFFFFFF]; }

  /// Random times of the first of uniformly distributed darts: earlier for larger pieces. A turn is
  /// the time, whose bits as a float without sign have its order, and the number of the piece.
  void choose_turns() {
    turns_.clear();
    turns_.reserve(open_.size());
    for (std::uint32_t i = 0; i < open_.size(); ++i) {
      const auto time = static_cast<float>(std::abs(std::log(1 - random_.uniform())) /
                                           open_[i].seen.piece.measure());
      turns_.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(time)} << 32 | i);
    }
    boost::sort::pdqsort_branchless(turns_.begin(), turns_.end());
  }

  void fill(Open& open) {
    SeenPiece<Piece>& seen = open.seen;
    load(open.list);
    if (may_lack_darts(seen.piece)) {
      list_all(seen.piece);
      seen.at_corner = {};
      if (is_covered(seen, 0)) return;
    } else if (find_new(seen.piece) && is_covered(seen, open.list.count)) {
      return;
    }
    const Dart dart = body_.dart_in(seen.piece, random_);
    if (is_free(dart) && body_.contains(seen.piece, dart.place)) {
      new_indices_.push_back(block_.size());
      block_.add(dart);
      near_.add(block_.place(new_indices_.back()), block_.radius_mm(new_indices_.back()));
      if (is_covered(seen, near_.size() - 1)) return;
    }
    bool listed = false;
    body_.split(seen, near_, [&](const SeenPiece<Piece>& part) {
      if (!listed) list_new();
      listed = true;
      smaller_.push_back({part, list_});
    });
  }

  void load(const List& list) {
    list_ = list;
    near_.clear();
    new_indices_.clear();
    for (const BlockDarts::Index i : std::span(indices_).subspan(list.first, list.count))
      near_.add(block_.place(i), block_.radius_mm(i));
  }

  /// The list of a piece is full, or has been made for smaller radii than its own.
  bool may_lack_darts(const Piece& piece) const {
    return near_.is_full() || piece.radius_mm > list_.reach_mm;
  }

  /// Makes a list of all darts near a piece.
  void list_all(const Piece& piece) {
    list_ = {static_cast<std::uint32_t>(indices_.size()), 0, 0, piece.radius_mm};
    near_.clear();
    new_indices_.clear();
    find_new(piece);
    list_new();
  }

  /// Finds the darts near a piece that were added after its list. Returns whether there are any for
  /// which it has room.
  bool find_new(const Piece& piece) {
    if (list_.compared == block_.size()) return false;
    const Ball ball = piece.ball();
    block_.find_near(list_.compared, ball.centre, ball.radius_mm + list_.reach_mm, new_indices_);
    if (near_.size() + new_indices_.size() > max_set_size) {
      std::erase_if(new_indices_, [&](BlockDarts::Index i) {
        return !block_.reaches(i, ball.centre, ball.radius_mm);
      });
    }
    for (const BlockDarts::Index i : new_indices_) near_.add(block_.place(i), block_.radius_mm(i));
    return near_.size() != list_.count;
  }

  /// One of the darts covers the piece, which has not yet been compared with those from `first`.
  bool is_covered(SeenPiece<Piece>& seen, std::size_t first) const {
    seen.look(near_, first);
    return seen.is_covered();
  }

  bool is_free(const Dart& dart) const {
    const auto is_excluded = [&](Doubt doubt) {
      return near_.excluding(dart.place, dart.radius_mm, 0, doubt) != 0;
    };
    if (is_excluded(Doubt::is_outside)) return false;
    // A full list may lack darts.
    const bool has_all = !near_.is_full() && dart.radius_mm <= list_.reach_mm;
    if (has_all && !is_excluded(Doubt::is_within)) return true;
    return block_.is_free(dart.place, dart.radius_mm);
  }

  /// Makes the list for the parts of a piece: that of the piece and the new darts.
  void list_new() {
    list_.compared = block_.size();
    if (new_indices_.empty()) return;
    const std::uint32_t old = list_.first;
    list_.first = static_cast<std::uint32_t>(indices_.size());
    for (std::uint32_t i = old; i < old + list_.count; ++i) indices_.push_back(indices_[i]);
    indices_.insert(indices_.end(), new_indices_.begin(), new_indices_.end());
    list_.count = static_cast<std::uint32_t>(near_.size());
    indices_.resize(list_.first + list_.count);
    new_indices_.clear();
  }

  BlockDarts& block_;
  const Body& body_;
  geometry::Random& random_;
  std::vector<Open> open_, smaller_;
  std::vector<std::uint64_t> turns_;
  BlockDarts::List indices_, new_indices_;
  NearDarts near_;
  List list_;  // of the darts in `near_`, without those of `new_indices_`
};

}  // namespace lamplock::points
