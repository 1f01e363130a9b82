// Spatial tree of the points that are not fired yet. In: points, then removals one by one. Out: the
// cheapest remaining point, or a point under a cone. Called by the greedy orders, by the repair of
// an order and by the proof of the shadow rule.
//
// Points are sorted along a Morton curve (G. M. Morton, "A computer oriented geodetic data base",
// 1966) and stored in the leaves of a binary tree in that order; a node has the bounding box of the
// points that remain below it. A removal costs the depth of the tree, a query usually not much
// more. Memory: about 41 bytes a point.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::order {

/// Throws Error (bad_input) with index and coordinates of the first point that is not finite or
/// more than a kilometre away, beyond any machine.
void require_coordinates(std::span<const geometry::Point> points);

/// Distance of a value from an interval.
inline double distance_outside(double value, double low, double high) {
  return std::max({low - value, value - high, 0.0});
}

/// Metric of RestTree: the square of the distance from a place.
struct Nearest {
  geometry::Point from;
  double cost(const geometry::Point& p) const {
    return square(p.x - from.x, p.y - from.y, p.z - from.z);
  }
  double bound(const geometry::Bounds& box) const {
    return square(distance_outside(from.x, box.low.x, box.high.x),
                  distance_outside(from.y, box.low.y, box.high.y),
                  distance_outside(from.z, box.low.z, box.high.z));
  }
  static double square(double x, double y, double z) { return x * x + y * y + z * z; }
};

class RestTree {
 public:
  using Index = std::uint32_t;

  /// At most 2^32 - 2 points, with coordinates that require_coordinates() accepts.
  explicit RestTree(std::span<const geometry::Point> points);

  bool empty() const { return nodes_[1].least == none; }
  bool holds(Index point) const { return present_[slot_[point]]; }
  void remove(Index point) { set_present(point, false); }
  void put_back(Index point) { set_present(point, true); }

  /// A remaining point that a defect at `apex` shadows (cone.hpp), if there is one.
  std::optional<Index> under_cone(const geometry::Point& apex, double tangent) const;

  /// The remaining point for which metric.cost(point) is least, the lowest index among equals.
  /// metric.bound(box) must be no more than the cost of any point in the box. Not for an empty
  /// tree.
  template <class Metric>
  Index cheapest(const Metric& metric) const {
    Best best;
    search(1, metric, best);
    return best.index;
  }

 private:
  static constexpr Index none = std::numeric_limits<Index>::max();
  static constexpr std::size_t leaf_points = 8;

  // Boxes of floats, rounded outwards: half the memory.
  struct Node {
    std::array<float, 3> low{}, high{};
    Index least = none;  // lowest index of the remaining points; none if there are none
    geometry::Bounds box() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
  };
  struct Best {
    double cost = std::numeric_limits<double>::infinity();
    Index index = none;
    bool beats(double bound, Index least) const {
      return bound > cost || (bound == cost && least > index);
    }
  };

  void set_present(Index point, bool present);
  Node leaf(std::size_t number) const;
  static Node join(const Node& a, const Node& b);

  template <class Metric>
  void search(std::size_t node, const Metric& metric, Best& best) const {
    if (node >= leaves_) {
      const std::size_t first = (node - leaves_) * leaf_points;
      const std::size_t last = std::min(first + leaf_points, points_.size());
      for (std::size_t slot = first; slot < last; ++slot) {
        if (!present_[slot]) continue;
        const double cost = metric.cost(points_[slot]);
        if (!best.beats(cost, index_[slot])) best = {cost, index_[slot]};
      }
      return;
    }
    std::size_t near = 2 * node, far = near + 1;
    constexpr double never = std::numeric_limits<double>::infinity();
    double to_near = nodes_[near].least == none ? never : metric.bound(nodes_[near].box());
    double to_far = nodes_[far].least == none ? never : metric.bound(nodes_[far].box());
    if (to_far < to_near) {
      std::swap(near, far);
      std::swap(to_near, to_far);
    }
    if (!best.beats(to_near, nodes_[near].least)) search(near, metric, best);
    if (!best.beats(to_far, nodes_[far].least)) search(far, metric, best);
  }

  std::vector<geometry::Point> points_;  // along the curve
  std::vector<Index> index_, slot_;      // of the point in a slot, of the slot of a point
  std::vector<std::uint8_t> present_;    // per slot
  std::size_t leaves_ = 1;  // node 1 is the root, 2 n and 2 n + 1 are children of n, leaves last
  std::vector<Node> nodes_;
};

}  // namespace lamplock::order
