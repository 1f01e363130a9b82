#include "host/cutting/offset_loops.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/cutting/place_grid.hpp"

namespace lamplock::cutting {
namespace {

// Ends of pieces this near are one point: the sum of a few offset_end_mm.
constexpr double joint_mm = 2e-6;
// Loops of smaller mean width are the two sides of a slot just as wide as the beam.
constexpr double min_width_mm = 1e-5;

constexpr std::size_t no_piece = std::numeric_limits<std::size_t>::max();

/// Joins pieces to loops and chains.
class LoopBuilder {
 public:
  LoopBuilder(const std::vector<Contour>& contours, const std::vector<RawEdge>& raw,
              std::vector<OffsetPiece> pieces, double width_mm)
      : contours_(contours),
        raw_(raw),
        pieces_(std::move(pieces)),
        width_(width_mm),
        starts_(joint_mm, pieces_.size()),
        ends_(joint_mm, pieces_.size()) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      starts_.add(pieces_[i].edge.from, i);
      ends_.add(pieces_[i].edge.to, i);
    }
  }

  OffsetContours build() {
    remove_loose();
    std::vector<bool> used(contours_.size(), false);
    // Chains begin at pieces without one before them, loops anywhere.
    for (const bool is_chain : {true, false}) {
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        if (pieces_[i].is_gone || (is_chain && before(i) != no_piece)) continue;
        walk(i, used);
      }
    }
    for (std::size_t i = 0; i < contours_.size(); ++i) {
      if (used[i]) continue;
      result_.faults.push_back(
          {FaultKind::vanished, contours_[i].edges.front().from, length_of(contours_[i]), i});
    }
    return std::move(result_);
  }

 private:
  /// Of the pieces that continue at the end of this one, that with the least change of direction.
  std::size_t after(std::size_t piece) const {
    return nearest_direction(starts_, pieces_[piece].edge.to, direction_at(pieces_[piece].edge, 1),
                             0, piece);
  }
  std::size_t before(std::size_t piece) const {
    return nearest_direction(ends_, pieces_[piece].edge.from, direction_at(pieces_[piece].edge, 0),
                             1, piece);
  }
  std::size_t nearest_direction(const PlaceGrid& places, const Vec& at, const Vec& direction,
                                double part, std::size_t self) const {
    std::size_t best = no_piece;
    double straightest = -2;
    places.visit(at, [&](std::size_t i) {
      const Edge& edge = pieces_[i].edge;
      if (pieces_[i].is_gone || distance(point_at(edge, part), at) > joint_mm) return;
      // A piece by itself is a loop if it is a full turn only.
      if (i == self && length_of(edge) <= 2 * joint_mm) return;
      const double along = dot(direction, direction_at(edge, part));
      if (along <= straightest) return;
      straightest = along;
      best = i;
    });
    return best;
  }

  bool is_begin_of_open(std::size_t piece) const {
    const RawEdge& raw = raw_[pieces_[piece].raw];
    return !contours_[raw.contour].closed && raw.place == 0 && pieces_[piece].begin == 0;
  }
  bool is_end_of_open(std::size_t piece) const {
    const RawEdge& raw = raw_[pieces_[piece].raw];
    const Contour& contour = contours_[raw.contour];
    return !contour.closed && raw.place + 2 == 2 * contour.edges.size() && pieces_[piece].end == 1;
  }

  /// Removes pieces that end nowhere: too short for the clearance to see that they are too near.
  void remove_loose() {
    std::vector<std::size_t> check(pieces_.size());
    for (std::size_t i = 0; i < check.size(); ++i) check[i] = i;
    while (!check.empty()) {
      const std::size_t i = check.back();
      check.pop_back();
      if (pieces_[i].is_gone) continue;
      const bool is_fast = (before(i) != no_piece || is_begin_of_open(i)) &&
                           (after(i) != no_piece || is_end_of_open(i));
      if (is_fast) continue;
      pieces_[i].is_gone = true;
      starts_.visit(pieces_[i].edge.to, [&](std::size_t next) { check.push_back(next); });
      ends_.visit(pieces_[i].edge.from, [&](std::size_t last) { check.push_back(last); });
    }
  }

  void walk(std::size_t first, std::vector<bool>& used) {
    std::vector<std::size_t> chain;
    bool closed = false;
    for (std::size_t piece = first; piece != no_piece;) {
      chain.push_back(piece);
      // Gone now: a loop ends when nothing but its first piece continues it.
      const Vec end = pieces_[piece].edge.to;
      const Vec direction = direction_at(pieces_[piece].edge, 1);
      pieces_[piece].is_gone = true;
      piece = nearest_direction(starts_, end, direction, 0, no_piece);
      closed = distance(end, pieces_[first].edge.from) <= joint_mm;
      if (closed && (piece == no_piece || dot(direction, direction_at(pieces_[piece].edge, 0)) <=
                                              dot(direction, direction_at(pieces_[first].edge, 0))))
        break;
      closed = false;
    }
    finish(chain, closed, used);
  }

  void finish(const std::vector<std::size_t>& chain, bool closed, std::vector<bool>& used) {
    Contour contour;
    contour.closed = closed;
    const std::size_t source = raw_[pieces_[chain.front()].raw].contour;
    contour.layer = contours_[source].layer;
    double length = 0;
    for (const std::size_t piece : chain) length += length_of(pieces_[piece].edge);
    append_edges(chain, contour);
    const bool is_open_source = std::any_of(chain.begin(), chain.end(), [&](std::size_t piece) {
      return !contours_[raw_[pieces_[piece].raw].contour].closed;
    });
    if (!closed && !is_open_source) return;
    if (closed && std::abs(signed_area(contour)) <= min_width_mm * length) {
      if (length > min_width_mm)
        result_.faults.push_back({FaultKind::narrow, contour.edges.front().from, width_, source});
      return;
    }
    for (std::size_t i = 0; i < chain.size(); ++i) {
      used[raw_[pieces_[chain[i]].raw].contour] = true;
      if (i + 1 < chain.size() || closed)
        report_narrow(pieces_[chain[i]], pieces_[chain[(i + 1) % chain.size()]]);
    }
    result_.contours.push_back(std::move(contour));
    result_.from.push_back(source);
  }

  /// Edges that meet exactly; pieces of one raw edge are one edge again.
  void append_edges(const std::vector<std::size_t>& chain, Contour& contour) const {
    struct Run {
      std::size_t raw;
      double begin, end;
      Vec from, to;
    };
    std::vector<Run> runs;
    for (const std::size_t number : chain) {
      const OffsetPiece& piece = pieces_[number];
      if (!runs.empty() && runs.back().raw == piece.raw && runs.back().end == piece.begin) {
        runs.back().end = piece.end;
        runs.back().to = piece.edge.to;
      } else {
        runs.push_back({piece.raw, piece.begin, piece.end, piece.edge.from, piece.edge.to});
      }
    }
    if (contour.closed && runs.size() > 1 && runs.front().raw == runs.back().raw &&
        runs.back().end == runs.front().begin) {
      runs.front().begin = runs.back().begin;
      runs.front().from = runs.back().from;
      runs.pop_back();
    }
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const Run& run = runs[i];
      const bool is_last = i + 1 == runs.size();
      const Vec end = !is_last ? runs[i + 1].from : contour.closed ? runs.front().from : run.to;
      const Edge edge = cut_out(raw_[run.raw].edge, run.begin, run.end, run.from, run.to);
      contour.edges.push_back(with_ends(edge, run.from, end));
    }
  }

  /// A joint of edges whose originals do not follow each other: between them is no room.
  void report_narrow(const OffsetPiece& piece, const OffsetPiece& next) {
    const RawEdge &a = raw_[piece.raw], &b = raw_[next.raw];
    const std::size_t places = 2 * contours_[a.contour].edges.size();
    if (a.contour == b.contour) {
      const std::size_t step = (b.place + places - a.place) % places;
      if (step <= 1 || (step == 2 && a.place % 2 == 0)) return;
    }
    const Vec& at = piece.edge.to;
    const double width = distance(touched_by(a, at), touched_by(b, at));
    result_.faults.push_back({FaultKind::narrow, at, width, a.contour});
  }

  /// The point of the contour that a beam at a point of its raw edge touches.
  Vec touched_by(const RawEdge& raw, const Vec& at) const {
    const Edge& edge = contours_[raw.contour].edges[raw.place / 2];
    return raw.place % 2 == 0 ? nearest_on(edge, at) : edge.to;
  }

  const std::vector<Contour>& contours_;
  const std::vector<RawEdge>& raw_;
  std::vector<OffsetPiece> pieces_;
  double width_;
  PlaceGrid starts_, ends_;
  OffsetContours result_;
};

}  // namespace

OffsetContours loops_of(const std::vector<Contour>& contours, const std::vector<RawEdge>& raw,
                        std::vector<OffsetPiece> pieces, double width_mm) {
  return LoopBuilder(contours, raw, std::move(pieces), width_mm).build();
}

}  // namespace lamplock::cutting
