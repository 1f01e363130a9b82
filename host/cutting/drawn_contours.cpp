#include "host/cutting/drawn_contours.hpp"

#include <algorithm>

namespace lamplock::cutting {
namespace {

// A gap as wide as the beam, to the tolerance of curves.
constexpr double slack_mm = 1e-3;
// Edges about a contour that are compared with each of its edges; among more they are searched.
constexpr std::size_t max_listed = 64;

}  // namespace

void DrawnContours::add(const Contour& contour, std::size_t number) {
  edges_.insert(edges_.end(), contour.edges.begin(), contour.edges.end());
  numbers_.resize(edges_.size(), number);
}

void DrawnContours::index() { tree_ = tree_of(edges_); }

/// Calls found(cut) if edge `i` is nearer to an edge of a path than the reach; its result.
template <class Found>
bool DrawnContours::is_cut(const Edge& edge, std::size_t i, double reach_mm,
                           const Found& found) const {
  const Approach approach = approach_of(edge, edges_[i]);
  return approach.distance_mm < reach_mm - slack_mm &&
         found(Cut{numbers_[i], approach.at, approach.distance_mm});
}

std::vector<DrawnContours::Cut> DrawnContours::cut_by(const Contour& path, std::size_t own,
                                                      double reach_mm) const {
  std::vector<Cut> cuts;
  if (!(reach_mm > slack_mm)) return cuts;
  const auto note = [&](const Cut& cut) {
    const auto known = std::find_if(cuts.begin(), cuts.end(),
                                    [&](const Cut& other) { return other.contour == cut.contour; });
    if (known == cuts.end()) {
      cuts.push_back(cut);
    } else if (cut.distance_mm < known->distance_mm) {
      *known = cut;
    }
    return false;
  };
  // Most contours have few edges of others about them, or none.
  std::vector<std::size_t> others;
  const bool are_many = tree_.any(box_of(path).grown(reach_mm), [&](std::size_t i) {
    if (numbers_[i] != own) others.push_back(i);
    return others.size() > max_listed;
  });
  for (const Edge& edge : path.edges) {
    const Box about = box_of(edge).grown(reach_mm);
    if (are_many) {
      tree_.visit(about, [&](std::size_t i) {
        if (numbers_[i] != own) is_cut(edge, i, reach_mm, note);
      });
      continue;
    }
    for (const std::size_t i : others)
      if (tree_.box(i).meets(about)) is_cut(edge, i, reach_mm, note);
  }
  return cuts;
}

bool DrawnContours::are_cut_by(const Edge& edge, std::size_t own, double reach_mm) const {
  return reach_mm > slack_mm && tree_.any(box_of(edge).grown(reach_mm), [&](std::size_t i) {
    return numbers_[i] != own && is_cut(edge, i, reach_mm, [](const Cut&) { return true; });
  });
}

}  // namespace lamplock::cutting
