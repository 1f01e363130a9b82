// contour_tree(): which closed contours are around each contour, by rays from some of its points.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"

namespace lamplock::cutting {
namespace {

// Boxes of contours that touch from inside may differ by rounding.
constexpr double box_slack_mm = 1e-6;

/// True if a ray from `at` towards +x crosses the piece between two points of which the first two
/// values are heights; an end at exactly this height counts as below.
bool spans(double from_y, double to_y, double y) { return (from_y > y) != (to_y > y); }

/// Number of crossings of the edge with the ray from `at` towards +x.
int crossings(const Edge& edge, const Vec& at) {
  if (edge.is_line()) {
    if (!spans(edge.from.y, edge.to.y, at.y)) return 0;
    const double part = (at.y - edge.from.y) / (edge.to.y - edge.from.y);
    return edge.from.x + part * (edge.to.x - edge.from.x) > at.x ? 1 : 0;
  }
  // The arc between its highest and lowest points: there each height has one point.
  const double radius = radius_of(edge);
  std::array<std::pair<double, double>, 4> stops{{{0, edge.from.y}}};
  std::size_t count = 1;
  for (const double side : {-1.0, 1.0}) {
    const double part = part_at(edge, edge.centre + Vec{0, side * radius});
    if (part > 0 && part < 1) stops[count++] = {part, edge.centre.y + side * radius};
  }
  if (count == 3 && stops[2] < stops[1]) std::swap(stops[1], stops[2]);
  stops[count++] = {1, edge.to.y};
  int found = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (!spans(stops[i].second, stops[i + 1].second, at.y)) continue;
    const double height = at.y - edge.centre.y;
    const double half = std::sqrt(std::max(0.0, (radius - height) * (radius + height)));
    const bool is_right =
        point_at(edge, (stops[i].first + stops[i + 1].first) / 2).x > edge.centre.x;
    found += edge.centre.x + (is_right ? half : -half) > at.x ? 1 : 0;
  }
  return found;
}

class TreeBuilder {
 public:
  explicit TreeBuilder(const std::vector<Contour>& contours)
      : contours_(contours), tree_(closed_edge_boxes()) {
    for (const Contour& contour : contours) {
      boxes_.push_back(box_of(contour));
      areas_.push_back(std::abs(signed_area(contour)));
    }
  }

  ContourPlace place(std::size_t number) const {
    // A contour is around another if it is around most of these points.
    std::map<std::size_t, int> votes;
    const std::vector<Edge>& edges = contours_[number].edges;
    constexpr std::size_t samples = 3;
    constexpr double part = 0.382;  // of an edge: not a point that drawings are symmetric about
    for (std::size_t i = 0; i < samples; ++i)
      vote(point_at(edges[i * edges.size() / samples], part + 0.1 * static_cast<double>(i)), votes);
    ContourPlace place;
    double smallest = std::numeric_limits<double>::infinity();
    for (const auto& [other, count] : votes) {
      if (2 * count < static_cast<int>(samples) || !may_contain(other, number)) continue;
      ++place.depth;
      if (areas_[other] >= smallest) continue;
      smallest = areas_[other];
      place.parent = other;
    }
    if (contours_[number].closed)
      place.kind = place.depth == 0       ? ContourKind::outside
                   : place.depth % 2 == 1 ? ContourKind::hole
                                          : ContourKind::island;
    return place;
  }

 private:
  std::vector<Box> closed_edge_boxes() {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < contours_.size(); ++i) {
      if (!contours_[i].closed) continue;
      for (const Edge& edge : contours_[i].edges) {
        boxes.push_back(box_of(edge));
        edges_.emplace_back(i, &edge);
      }
    }
    return boxes;
  }

  bool may_contain(std::size_t outer, std::size_t inner) const {
    return outer != inner && boxes_[outer].grown(box_slack_mm).contains(boxes_[inner]) &&
           (!contours_[inner].closed || areas_[outer] > areas_[inner]);
  }

  void vote(const Vec& at, std::map<std::size_t, int>& votes) const {
    std::map<std::size_t, int> crossed;
    const Box ray{at, {std::numeric_limits<double>::max(), at.y}};
    tree_.visit(
        ray, [&](std::size_t i) { crossed[edges_[i].first] += crossings(*edges_[i].second, at); });
    for (const auto& [number, count] : crossed) {
      if (count % 2 == 1) ++votes[number];
    }
  }

  const std::vector<Contour>& contours_;
  std::vector<std::pair<std::size_t, const Edge*>> edges_;  ///< of closed contours, as in tree_
  BoxTree tree_;
  std::vector<Box> boxes_;
  std::vector<double> areas_;
};

}  // namespace

std::vector<ContourPlace> contour_tree(const std::vector<Contour>& contours) {
  const TreeBuilder builder(contours);
  std::vector<ContourPlace> places;
  places.reserve(contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) places.push_back(builder.place(i));
  return places;
}

}  // namespace lamplock::cutting
