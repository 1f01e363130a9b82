// join_contours(): chains of edges from paths, joined at their ends, the nearest ends first.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"
#include "host/cutting/duplicate_filter.hpp"
#include "host/cutting/place_grid.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::cutting {
namespace {

// Larger differences of ends are reported: smaller ones are the rounding of the file.
constexpr double rounding_mm = model::flat_mm;
// Edges below this length have no direction.
constexpr double min_edge_mm = 1e-9;
// An end with more ends near it is the centre of a star; each is joined with one other anyway.
constexpr std::size_t max_candidates = 64;

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

/// Removes edges without length and makes neighbours meet exactly.
void connect(Contour& contour) {
  std::vector<Edge>& edges = contour.edges;
  std::erase_if(edges, is_nothing);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) weld(edges[i], edges[i + 1]);
  if (contour.closed && edges.size() > 1) weld(edges.back(), edges.front());
  // A dot that the reader took for a closed path.
  if (edges.size() == 1 && edges.front().from != edges.front().to) contour.closed = false;
  std::erase_if(edges, [](const Edge& edge) { return edge.from == edge.to && is_nothing(edge); });
}

/// Joins open chains. Ends are numbered: 2 i is the start of chain i, 2 i + 1 its end. Where more
/// than two ends meet, a way that comes to the same place again is divided there: two squares that
/// touch at a corner, or a square with a line at a corner, are contours by themselves.
class Joiner {
 public:
  Joiner(std::vector<Contour> chains, double tolerance_mm, std::vector<Fault>& faults)
      : chains_(std::move(chains)),
        tolerance_(tolerance_mm),
        faults_(faults),
        partner_(2 * chains_.size(), none),
        meeting_(2 * chains_.size()),
        ends_at_(2 * chains_.size(), 0),
        visit_(2 * chains_.size(), none) {}

  /// Contours with the number of their first chain.
  std::vector<std::pair<std::size_t, Contour>> joined() {
    choose_partners();
    std::vector<bool> used(chains_.size(), false);
    std::vector<std::pair<std::size_t, Contour>> contours;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
      if (used[i]) continue;
      divide(way_with(i, used), contours);
    }
    return contours;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  /// A chain shorter than so many tolerances would close upon itself.
  static constexpr double min_loop = 4;

  struct Candidate {
    std::uint32_t a, b;
    double distance_mm, turn;
  };

  Vec place(std::size_t end) const {
    const std::vector<Edge>& edges = chains_[end / 2].edges;
    return end % 2 == 0 ? edges.front().from : edges.back().to;
  }
  /// The direction out of the chain at this end.
  Vec outwards(std::size_t end) const {
    const std::vector<Edge>& edges = chains_[end / 2].edges;
    return end % 2 == 0 ? direction_at(edges.front(), 0) * -1 : direction_at(edges.back(), 1);
  }
  bool may_join(std::size_t a, std::size_t b) const {
    if (chains_[a / 2].layer != chains_[b / 2].layer) return false;
    const Contour& chain = chains_[a / 2];
    return a / 2 != b / 2 || (chain.edges.size() > 1 && length_of(chain) > min_loop * tolerance_);
  }

  void choose_partners() {
    PlaceGrid grid(tolerance_, partner_.size());
    std::vector<Candidate> candidates;
    candidates.reserve(partner_.size() / 2);
    for (std::size_t end = 0; end < partner_.size(); ++end) {
      const Vec at = place(end);
      std::size_t count = 0;
      meeting_[end] = end;
      grid.any(at, [&](std::size_t other) {
        const double gap = distance(at, place(other));
        if (gap > tolerance_ || !may_join(other, end)) return false;
        meeting_[end] = meeting_[other];
        candidates.push_back({static_cast<std::uint32_t>(other), static_cast<std::uint32_t>(end),
                              gap, 1 + dot(outwards(end), outwards(other))});
        return ++count >= max_candidates;
      });
      ++ends_at_[meeting_[end]];
      grid.add(at, end);
    }
    // Of ends at about the same distance those that continue most straightly are joined.
    const double step = tolerance_ / 8;
    std::stable_sort(candidates.begin(), candidates.end(),
                     [step](const Candidate& p, const Candidate& q) {
                       const double p_step = std::floor(p.distance_mm / step),
                                    q_step = std::floor(q.distance_mm / step);
                       return p_step != q_step ? p_step < q_step : p.turn < q.turn;
                     });
    for (const Candidate& pair : candidates) {
      if (partner_[pair.a] != none || partner_[pair.b] != none) continue;
      partner_[pair.a] = pair.b;
      partner_[pair.b] = pair.a;
    }
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
  std::size_t crossing(std::size_t end) const {
    return ends_at_[meeting_[end]] > 2 ? meeting_[end] : none;
  }

  /// Appends the contours of a way: its loops, and what is left.
  void divide(const Way& way, std::vector<std::pair<std::size_t, Contour>>& contours) {
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

  /// A loop of several edges that is more than a gap.
  bool may_close(const std::vector<std::size_t>& loop) const {
    double length = 0;
    std::size_t edges = 0;
    for (const std::size_t start : loop) {
      length += length_of(chains_[start / 2]);
      edges += chains_[start / 2].edges.size();
    }
    return edges > 1 && length > min_loop * tolerance_;
  }

  /// With the number of its first chain.
  std::pair<std::size_t, Contour> contour_of(const std::vector<std::size_t>& starts, bool closed) {
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
  double tolerance_;
  std::vector<Fault>& faults_;
  std::vector<std::size_t> partner_;
  std::vector<std::size_t> meeting_;    ///< of each end: the first end at its place
  std::vector<std::uint32_t> ends_at_;  ///< of each place, by its first end
  std::vector<std::size_t> visit_;      ///< of each place: the position in the way that is divided
};

/// One fault for each end of an open contour, with the distance to the nearest other end of its
/// layer.
void report_gaps(const std::vector<Contour>& contours, double tolerance_mm,
                 std::vector<Fault>& faults) {
  std::vector<std::pair<Vec, std::size_t>> ends;
  Box all;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (contours[i].closed) continue;
    for (const Vec& end : {contours[i].edges.front().from, contours[i].edges.back().to}) {
      ends.emplace_back(end, i);
      all.add(end);
    }
  }
  std::vector<Box> boxes;
  boxes.reserve(ends.size());
  for (const auto& [at, number] : ends) boxes.push_back({at, at});
  const BoxTree tree(boxes);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Vec at = ends[i].first;
    const std::size_t number = ends[i].second;
    const double furthest = distance(all.low, all.high);
    double nearest = std::numeric_limits<double>::infinity();
    // The square is doubled until it holds the nearest end for certain.
    for (double reach = tolerance_mm * 2;; reach *= 2) {
      tree.visit(Box{at, at}.grown(reach), [&](std::size_t j) {
        if (j != i && contours[ends[j].second].layer == contours[number].layer)
          nearest = std::min(nearest, distance(at, ends[j].first));
      });
      if (nearest <= reach || reach > furthest) break;
    }
    faults.push_back({FaultKind::gap, at, nearest, number});
  }
}

struct Numbered {
  std::size_t path;  ///< the first one of the contour in the file
  Contour contour;
};

/// Sets the contour of each fault to that with an edge at its place.
void number_faults(std::vector<Fault>& faults, const std::vector<Contour>& contours,
                   double reach_mm) {
  if (faults.empty()) return;
  std::vector<Box> boxes;
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    for (std::size_t j = 0; j < contours[i].edges.size(); ++j) {
      boxes.push_back(box_of(contours[i].edges[j]));
      edges.emplace_back(i, j);
    }
  }
  const BoxTree tree(boxes);
  for (Fault& fault : faults) {
    fault.contour.reset();
    if (fault.kind == FaultKind::dot) continue;
    double nearest = reach_mm;
    tree.visit(Box{fault.at, fault.at}.grown(reach_mm), [&](std::size_t number) {
      const auto [i, j] = edges[number];
      const double away = distance_to(contours[i].edges[j], fault.at);
      if (away > nearest || (away == nearest && fault.contour)) return;
      nearest = away;
      fault.contour = i;
    });
  }
}

std::vector<Contour> contours_of(std::vector<Numbered> numbered) {
  std::stable_sort(numbered.begin(), numbered.end(),
                   [](const Numbered& p, const Numbered& q) { return p.path < q.path; });
  std::vector<Contour> contours;
  contours.reserve(numbered.size());
  for (Numbered& entry : numbered) contours.push_back(std::move(entry.contour));
  return contours;
}

}  // namespace

JoinedContours join_contours(const model::Curves& curves, const JoinOptions& options) {
  geometry::require_positive(options.tolerance_mm, "contours", "tolerance");
  JoinedContours result;
  std::vector<Numbered> all;
  std::vector<Contour> open;
  std::vector<std::size_t> open_paths;
  for (std::size_t i = 0; i < curves.paths.size(); ++i) {
    const model::Path& path = curves.paths[i];
    Contour chain{edges_of(path, options.curve_tolerance_mm), path.closed, path.layer, path.colour};
    connect(chain);
    if (chain.edges.empty()) {
      const geometry::Point at = model::start_of(path);
      result.faults.push_back({FaultKind::dot, {at.x, at.y}, 0, {}});
    } else if (chain.closed) {
      all.push_back({i, std::move(chain)});
    } else {
      open.push_back(std::move(chain));
      open_paths.push_back(i);
    }
  }
  // Open curves are compared on their own layer only: an equal curve of another layer may be needed
  // to close a contour there.
  const std::vector<std::size_t> by_layer;
  DuplicateFilter curve_filter(options.tolerance_mm, by_layer, result.faults);
  const std::vector<std::size_t> kept = curve_filter.keep(open);
  std::vector<Contour> chains;
  chains.reserve(kept.size());
  for (const std::size_t i : kept) chains.push_back(std::move(open[i]));
  Joiner joiner(std::move(chains), options.tolerance_mm, result.faults);
  for (auto& [first, contour] : joiner.joined()) {
    if (contour.edges.empty()) continue;
    // What is shorter than the gaps that are closed has no shape.
    if (!contour.closed && length_of(contour) <= options.tolerance_mm)
      result.faults.push_back({FaultKind::dot, contour.edges.front().from, length_of(contour), {}});
    else
      all.push_back({open_paths[kept[first]], std::move(contour)});
  }
  std::vector<Contour> contours = contours_of(std::move(all));
  DuplicateFilter filter(options.tolerance_mm, options.duplicate_groups, result.faults);
  for (const std::size_t i : filter.keep(contours))
    result.contours.push_back(std::move(contours[i]));
  number_faults(result.faults, result.contours, 2 * options.tolerance_mm);
  report_gaps(result.contours, options.tolerance_mm, result.faults);
  return result;
}

}  // namespace lamplock::cutting
