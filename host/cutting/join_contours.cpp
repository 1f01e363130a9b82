// join_contours(): chains of edges from paths, joined to contours; their duplicates and gaps.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/chain_joiner.hpp"
#include "host/cutting/contour.hpp"
#include "host/cutting/duplicate_filter.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::cutting {
namespace {

// Shorter contours have no shape, whatever gaps are closed.
constexpr double max_dot_mm = JoinOptions{}.tolerance_mm;

/// False for the ends of a contour that no tolerance closes, because it is a part of its gap.
bool can_close(const Contour& contour, double gap_mm, double tolerance_mm) {
  return gap_mm > tolerance_mm && length_of(contour) > min_loop_gaps * gap_mm;
}

/// One fault for each end of an open contour, with the distance to the nearest other end of its
/// layer that a tolerance can join with it; 0 without one.
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
        const Contour& other = contours[ends[j].second];
        if (j == i || other.layer != contours[number].layer) return;
        const double gap_mm = distance(at, ends[j].first);
        if (ends[j].second != number || can_close(other, gap_mm, tolerance_mm))
          nearest = std::min(nearest, gap_mm);
      });
      if (nearest <= reach || reach > furthest) break;
    }
    faults.push_back({FaultKind::gap, at, std::isfinite(nearest) ? nearest : 0, number});
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
  const double dot_mm = std::min(options.tolerance_mm, max_dot_mm);
  JoinedContours result;
  std::vector<Numbered> all;
  std::vector<Contour> open;
  std::vector<std::size_t> open_paths;
  for (std::size_t i = 0; i < curves.paths.size(); ++i) {
    const model::Path& path = curves.paths[i];
    Contour chain{edges_of(path, options.curve_tolerance_mm),
                  path.closed,
                  path.fill_rule,
                  path.covers,
                  path.layer,
                  path.colour,
                  path.area};
    connect(chain);
    const double length_mm = length_of(chain);
    if (chain.edges.empty() || (chain.closed && length_mm <= dot_mm)) {
      const geometry::Point at = model::start_of(path);
      result.faults.push_back({FaultKind::dot, {at.x, at.y}, length_mm, {}});
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
  for (auto& [first, contour] :
       join_chains(std::move(chains), options.tolerance_mm, result.faults)) {
    if (contour.edges.empty()) continue;
    if (length_of(contour) <= dot_mm)
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
