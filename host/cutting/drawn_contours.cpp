#include "host/cutting/drawn_contours.hpp"

#include <algorithm>

namespace lamplock::cutting {
namespace {

// A gap as wide as the beam, to the tolerance of curves.
constexpr double slack_mm = 1e-3;

}  // namespace

void DrawnContours::add(const Contour& contour, std::size_t number) {
  edges_.insert(edges_.end(), contour.edges.begin(), contour.edges.end());
  numbers_.resize(edges_.size(), number);
}

void DrawnContours::index() { tree_ = tree_of(edges_); }

template <class Found>
bool DrawnContours::any_cut(const Edge& edge, std::size_t own, double reach_mm,
                            const Found& found) const {
  if (!(reach_mm > slack_mm)) return false;
  return tree_.any(box_of(edge).grown(reach_mm), [&](std::size_t i) {
    if (numbers_[i] == own) return false;
    const Approach approach = approach_of(edge, edges_[i]);
    return approach.distance_mm < reach_mm - slack_mm &&
           found(Cut{numbers_[i], approach.at, approach.distance_mm});
  });
}

std::vector<DrawnContours::Cut> DrawnContours::cut_by(const Contour& path, std::size_t own,
                                                      double reach_mm) const {
  std::vector<Cut> cuts;
  for (const Edge& edge : path.edges) {
    any_cut(edge, own, reach_mm, [&](const Cut& cut) {
      const auto known = std::find_if(
          cuts.begin(), cuts.end(), [&](const Cut& other) { return other.contour == cut.contour; });
      if (known == cuts.end()) {
        cuts.push_back(cut);
      } else if (cut.distance_mm < known->distance_mm) {
        *known = cut;
      }
      return false;
    });
  }
  return cuts;
}

bool DrawnContours::are_cut_by(const Edge& edge, std::size_t own, double reach_mm) const {
  return any_cut(edge, own, reach_mm, [](const Cut&) { return true; });
}

}  // namespace lamplock::cutting
