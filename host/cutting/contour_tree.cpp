// contour_tree(): which closed contours are around each contour, by rays from some of its points.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"
#include "host/geometry/parallel.hpp"

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

/// The closed contours around points.
class Surroundings {
 public:
  explicit Surroundings(const std::vector<Contour>& contours) : contours_(contours), tree_({}) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < contours.size(); ++i) {
      if (!contours[i].closed) continue;
      numbers_.push_back(i);
      boxes.push_back(box_of(contours[i]).grown(box_slack_mm));
    }
    edges_.assign(numbers_.size(), BoxTree({}));
    geometry::for_each_index(numbers_.size(), 0, [&](std::size_t i) {
      edges_[i] = tree_of(contours[numbers_[i]].edges);
    });
    tree_ = BoxTree(boxes);
  }

  /// Calls found(number, is_inside) for all contours whose boxes contain this box.
  template <class Found>
  void visit(const Vec& at, const Box& inner, const Found& found) const {
    tree_.visit({at, at}, [&](std::size_t i) {
      if (tree_.box(i).contains(inner)) found(numbers_[i], is_inside(i, at));
    });
  }

  /// True if the contour with this number is closed and around the point.
  bool is_around(std::size_t number, const Vec& at) const {
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), number);
    return found != numbers_.end() && *found == number &&
           is_inside(static_cast<std::size_t>(found - numbers_.begin()), at);
  }

 private:
  bool is_inside(std::size_t i, const Vec& at) const {
    int crossed = 0;
    const Box ray{at, {std::numeric_limits<double>::max(), at.y}};
    edges_[i].visit(ray, [&](std::size_t edge) {
      crossed += crossings(contours_[numbers_[i]].edges[edge], at);
    });
    return crossed % 2 == 1;
  }

  const std::vector<Contour>& contours_;
  std::vector<std::size_t> numbers_;  ///< of the closed contours
  BoxTree tree_;                      ///< of their boxes
  std::vector<BoxTree> edges_;        ///< of the edges of each
};

class TreeBuilder {
 public:
  explicit TreeBuilder(const std::vector<Contour>& contours)
      : contours_(contours), surroundings_(contours) {
    areas_.reserve(contours.size());
    for (const Contour& contour : contours) areas_.push_back(std::abs(signed_area(contour)));
  }

  ContourPlace place(std::size_t number) const {
    // A contour is around another if it is around most of these points.
    constexpr std::size_t samples = 3;
    constexpr double part = 0.382;  // of an edge: not a point that drawings are symmetric about
    const std::vector<Edge>& edges = contours_[number].edges;
    const Box box = box_of(contours_[number]);
    std::vector<std::size_t> around;  // once for each point
    for (std::size_t i = 0; i < samples; ++i) {
      const Vec at =
          sample(number, edges[i * edges.size() / samples], part + 0.1 * static_cast<double>(i));
      surroundings_.visit(at, box, [&](std::size_t other, bool is_inside) {
        if (is_inside && may_contain(other, number)) around.push_back(other);
      });
    }
    std::sort(around.begin(), around.end());
    ContourPlace place;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < around.size(); ++i) {
      const std::size_t other = around[i];
      // Two of three points; the third one is skipped.
      if (around[i + 1] != other || (i > 0 && around[i - 1] == other)) continue;
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
  /// A point of an edge; of a closed contour a little inside of it: where two contours touch, a
  /// point on both would be inside or outside by the rounding of numbers.
  Vec sample(std::size_t number, const Edge& edge, double part) const {
    constexpr double max_away_mm = 2 * JoinOptions{}.tolerance_mm;  // more than ends may differ
    constexpr double part_of_width = 0.1;  // so that it is inside of narrow contours, too
    const Vec at = point_at(edge, part);
    const Contour& contour = contours_[number];
    if (!contour.closed) return at;
    const double away_mm =
        std::min(max_away_mm, part_of_width * areas_[number] / length_of(contour));
    const Vec right = right_of(direction_at(edge, part)) * away_mm;
    for (const Vec& inside : {at - right, at + right})
      if (surroundings_.is_around(number, inside)) return inside;
    return at;
  }

  bool may_contain(std::size_t outer, std::size_t inner) const {
    return outer != inner && (!contours_[inner].closed || areas_[outer] > areas_[inner]);
  }

  const std::vector<Contour>& contours_;
  Surroundings surroundings_;
  std::vector<double> areas_;
};

}  // namespace

bool is_inside(const Contour& contour, const Vec& at) {
  int crossed = 0;
  for (const Edge& edge : contour.edges) crossed += crossings(edge, at);
  return contour.closed && crossed % 2 == 1;
}

std::vector<ContourPlace> contour_tree(const std::vector<Contour>& contours) {
  const TreeBuilder builder(contours);
  std::vector<ContourPlace> places(contours.size());
  geometry::for_each_index(contours.size(), 0,
                           [&](std::size_t i) { places[i] = builder.place(i); });
  return places;
}

}  // namespace lamplock::cutting
