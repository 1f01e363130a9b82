#include "host/cutting/chain_joiner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "host/cutting/place_grid.hpp"
#include "host/geometry/union_find.hpp"

namespace lamplock::cutting {
namespace {

// Larger differences of ends are reported: smaller ones are the rounding of the file.
constexpr double rounding_mm = model::flat_mm;
// Edges below this length have no direction.
constexpr double min_edge_mm = 1e-9;
// An end with more ends near it is the centre of a star; each is joined with one other anyway.
constexpr std::size_t max_candidates = 64;
// Where the tolerance is so large that more ends are near, those are joined that are found first.
constexpr std::size_t max_visited = 1024;

bool is_nothing(const Edge& edge) {
  return distance(edge.from, edge.to) < min_edge_mm && length_of(edge) < 2 * min_edge_mm;
}

/// Moves the end of `a` and the start of `b` to one point: that of the arc if the other is a line.
void weld(Edge& a, Edge& b) {
  Vec meet = (a.to + b.from) * 0.5;
  if (a.to == b.from) return;
  if (a.is_line() && !b.is_line()) meet = b.from;
  if (b.is_line() && !a.is_line()) meet = a.to;
  a = with_ends(a, a.from, meet);
  b = with_ends(b, meet, b.to);
}

/// Joins open chains. Ends are numbered: 2 i is the start of chain i, 2 i + 1 its end. Where more
/// than two ends meet, a way that comes to the same place again is divided there: two squares that
/// touch at a corner, or a square with a line at a corner, are contours by themselves.
///
/// The tolerance may be larger than the chains. So the nearest ends are joined first, and ends are
/// at one place only if their distance is small against the chains.
class Joiner {
 public:
  Joiner(std::vector<Contour> chains, double tolerance_mm, std::vector<Fault>& faults)
      : chains_(std::move(chains)),
        lengths_(lengths_of(chains_)),
        ways_(chains_.size()),
        way_lengths_(lengths_),
        tolerance_(tolerance_mm),
        faults_(faults),
        partner_(2 * chains_.size(), none),
        places_(2 * chains_.size()),
        ends_at_(2 * chains_.size(), 0),
        visit_(2 * chains_.size(), none) {}

  /// Contours with the number of their first chain.
  std::vector<JoinedChain> joined() {
    // Within the whole tolerance, the nearest of very many ends would not be found.
    double reach_mm = JoinOptions{}.tolerance_mm;
    while (reach_mm < tolerance_) {
      choose_partners(reach_mm);
      reach_mm *= reach_step;
    }
    choose_partners(tolerance_);
    for (std::size_t end = 0; end < partner_.size(); ++end) ++ends_at_[places_.find(end)];
    std::vector<bool> used(chains_.size(), false);
    std::vector<JoinedChain> contours;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
      if (used[i]) continue;
      divide(way_with(i, used), contours);
    }
    return contours;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  static constexpr double reach_step = 8;

  struct Candidate {
    std::uint32_t a, b;
    double turn;
    int size;  ///< of the gap
  };

  static std::vector<double> lengths_of(const std::vector<Contour>& chains) {
    std::vector<double> lengths;
    lengths.reserve(chains.size());
    for (const Contour& chain : chains) lengths.push_back(length_of(chain));
    return lengths;
  }
  /// Gaps of one size differ by at most a factor of 2; all that are the rounding of the file are of
  /// one size.
  static int size_of_gap(double gap_mm) {
    return gap_mm <= rounding_mm ? 0 : 1 + std::ilogb(gap_mm / rounding_mm);
  }

  Vec place(std::size_t end) const {
    const std::vector<Edge>& edges = chains_[end / 2].edges;
    return end % 2 == 0 ? edges.front().from : edges.back().to;
  }
  /// The direction out of the chain at this end.
  Vec outwards(std::size_t end) const {
    const std::vector<Edge>& edges = chains_[end / 2].edges;
    return end % 2 == 0 ? direction_at(edges.front(), 0) * -1 : direction_at(edges.back(), 1);
  }
  bool may_join(std::size_t a, std::size_t b, double gap_mm) const {
    if (chains_[a / 2].layer != chains_[b / 2].layer) return false;
    return a / 2 != b / 2 ||
           (chains_[a / 2].edges.size() > 1 && lengths_[a / 2] > min_loop_gaps * gap_mm);
  }
  bool are_at_one_place(std::size_t a, std::size_t b, double gap_mm) const {
    return chains_[a / 2].layer == chains_[b / 2].layer &&
           min_loop_gaps * gap_mm <= std::min(lengths_[a / 2], lengths_[b / 2]);
  }

  /// Joins ends without a partner that are nearer than `reach_mm`, and finds which ends are at one
  /// place with them.
  void choose_partners(double reach_mm) {
    PlaceGrid grid(reach_mm, partner_.size());
    std::size_t free_ends = partner_.size();
    for (std::size_t end = 0; end < partner_.size(); ++end) {
      if (partner_[end] == none) continue;
      grid.add(place(end), end);
      --free_ends;
    }
    std::vector<Candidate> candidates;
    candidates.reserve(free_ends / 2);
    for (std::size_t end = 0; end < partner_.size(); ++end) {
      if (partner_[end] != none) continue;
      const Vec at = place(end);
      std::size_t count = 0, visited = 0;
      grid.any(at, [&](std::size_t other) {
        const double gap = distance(at, place(other));
        if (gap > reach_mm) return false;
        if (are_at_one_place(other, end, gap)) places_.join(other, end);
        if (partner_[other] == none && may_join(other, end, gap)) {
          candidates.push_back({static_cast<std::uint32_t>(other), static_cast<std::uint32_t>(end),
                                1 + dot(outwards(end), outwards(other)), size_of_gap(gap)});
          ++count;
        }
        return count >= max_candidates || ++visited >= max_visited;
      });
      grid.add(at, end);
    }
    join_nearest(candidates);
  }

  /// Of ends at about the same distance those that continue most straightly are joined.
  void join_nearest(std::vector<Candidate>& candidates) {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& p, const Candidate& q) {
                       return p.size != q.size ? p.size < q.size : p.turn < q.turn;
                     });
    for (const Candidate& pair : candidates) {
      if (partner_[pair.a] != none || partner_[pair.b] != none || !join_ways(pair.a, pair.b))
        continue;
      partner_[pair.a] = pair.b;
      partner_[pair.b] = pair.a;
    }
  }

  /// The ways of two chains become one. False if they are one already that is a part of the gap
  /// between its ends.
  bool join_ways(std::size_t a, std::size_t b) {
    const std::size_t first = ways_.find(a / 2), second = ways_.find(b / 2);
    if (first == second) return way_lengths_[first] > min_loop_gaps * distance(place(a), place(b));
    const double length = way_lengths_[first] + way_lengths_[second];
    ways_.join(first, second);
    way_lengths_[ways_.find(first)] = length;
    return true;
  }

  /// Joined chains, by the ends at which they begin.
  struct Way {
    std::vector<std::size_t> starts;
    bool closed;
  };

  /// The way that contains this chain, in its direction.
  Way way_with(std::size_t first, std::vector<bool>& used) {
    std::size_t begin = 2 * first;
    while (partner_[begin] != none) {
      begin = partner_[begin] ^ 1;
      if (begin == 2 * first) break;
    }
    Way way{{}, partner_[begin] != none};
    for (std::size_t end = begin;;) {
      way.starts.push_back(end);
      used[end / 2] = true;
      const std::size_t next = partner_[end ^ 1];
      if (next == none || next == begin) break;
      end = next;
    }
    return way;
  }

  /// Where more than two ends meet, the place that they have in common; `none` elsewhere.
  std::size_t crossing(std::size_t end) {
    const std::size_t at = places_.find(end);
    return ends_at_[at] > 2 ? at : none;
  }

  /// Appends the contours of a way: its loops, and what is left.
  void divide(const Way& way, std::vector<JoinedChain>& contours) {
    std::vector<std::size_t> open;
    for (const std::size_t start : way.starts) {
      if (const std::size_t at = crossing(start); at != none && visit_[at] == none)
        visit_[at] = open.size();
      open.push_back(start);
      const std::size_t at = crossing(start ^ 1);
      if (at == none || visit_[at] == none) continue;
      const auto from = open.begin() + static_cast<std::ptrdiff_t>(visit_[at]);
      const std::vector<std::size_t> loop(from, open.end());
      if (!may_close(loop)) continue;
      contours.push_back(contour_of(loop, true));
      for (const std::size_t inner : loop)
        if (crossing(inner) != none && crossing(inner) != at) visit_[crossing(inner)] = none;
      open.erase(from, open.end());
    }
    if (!open.empty()) contours.push_back(contour_of(open, way.closed));
    for (const std::size_t start : way.starts)
      for (const std::size_t at : {crossing(start), crossing(start ^ 1)})
        if (at != none) visit_[at] = none;
  }

  /// A loop of several edges that is more than its gap.
  bool may_close(const std::vector<std::size_t>& loop) const {
    double length = 0;
    std::size_t edges = 0;
    for (const std::size_t start : loop) {
      length += lengths_[start / 2];
      edges += chains_[start / 2].edges.size();
    }
    return edges > 1 &&
           length > min_loop_gaps * distance(place(loop.back() ^ 1), place(loop.front()));
  }

  /// With the number of its first chain.
  JoinedChain contour_of(const std::vector<std::size_t>& starts, bool closed) {
    Contour contour;
    std::size_t first = starts.front() / 2;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      append(contour, starts[i]);
      first = std::min(first, starts[i] / 2);
      const bool is_last = i + 1 == starts.size();
      if (!is_last || closed) report_bridge(starts[i] ^ 1, starts[is_last ? 0 : i + 1]);
    }
    contour.layer = chains_[first].layer;
    contour.colour = chains_[first].colour;
    contour.area = chains_[first].area;
    contour.fill_rule = chains_[first].fill_rule;
    contour.covers = chains_[first].covers;
    contour.closed = closed;
    connect(contour);
    return {first, std::move(contour)};
  }

  void append(Contour& contour, std::size_t start) const {
    const Contour& chain = chains_[start / 2];
    const Contour along = start % 2 == 0 ? chain : reversed(chain);
    contour.edges.insert(contour.edges.end(), along.edges.begin(), along.edges.end());
  }

  void report_bridge(std::size_t end, std::size_t next) {
    const double gap = distance(place(end), place(next));
    if (gap > rounding_mm)
      faults_.push_back({FaultKind::bridged_gap, (place(end) + place(next)) * 0.5, gap, {}});
  }

  std::vector<Contour> chains_;
  std::vector<double> lengths_;
  geometry::UnionFind ways_;         ///< of chains that are joined
  std::vector<double> way_lengths_;  ///< of each way, by its root
  double tolerance_;
  std::vector<Fault>& faults_;
  std::vector<std::size_t> partner_;
  geometry::UnionFind places_;          ///< of ends
  std::vector<std::uint32_t> ends_at_;  ///< of each place, by its first end
  std::vector<std::size_t> visit_;      ///< of each place: the position in the way that is divided
};

}  // namespace

void connect(Contour& contour) {
  std::vector<Edge>& edges = contour.edges;
  std::erase_if(edges, is_nothing);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) weld(edges[i], edges[i + 1]);
  if (contour.closed && edges.size() > 1) weld(edges.back(), edges.front());
  // A dot that the reader took for a closed path.
  if (edges.size() == 1 && edges.front().from != edges.front().to) contour.closed = false;
  std::erase_if(edges, [](const Edge& edge) { return edge.from == edge.to && is_nothing(edge); });
}

std::vector<JoinedChain> join_chains(std::vector<Contour> chains, double tolerance_mm,
                                     std::vector<Fault>& faults) {
  return Joiner(std::move(chains), tolerance_mm, faults).joined();
}

}  // namespace lamplock::cutting
