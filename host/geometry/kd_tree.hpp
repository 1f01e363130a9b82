// The nearest of many points. In: points. Out: those nearest to a place. Called by the orders, by
// the check of the spacing and by the page of a report. The tree is nanoflann's; about 14 bytes a
// point besides the points themselves, which are not copied.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <span>
#include <utility>

#include "host/geometry/point.hpp"

namespace lamplock::geometry {

/// A tree of the points `at(0)` to `at(count - 1)`, which must not change.
template <class PointAt>
class KdTree {
 public:
  KdTree(std::size_t count, PointAt at)
      : adaptor_{count, std::move(at)},
        tree_(3, adaptor_, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_points)) {}
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  /// Writes the numbers of the nearest points, nearest first, and the squares of their distances,
  /// mm2. The point at `from` itself is one of them, if it is in the tree. Returns their number:
  /// `most`, or all points.
  template <std::size_t size>
  std::size_t nearest(const Point& from, std::size_t most, std::array<std::uint32_t, size>& number,
                      std::array<double, size>& squared) const {
    const std::array<double, 3> query{from.x, from.y, from.z};
    return tree_.knnSearch(query.data(), most, number.data(), squared.data());
  }

 private:
  static constexpr std::size_t leaf_points = 10;  // recommended by nanoflann's manual

  /// The library's interface to the points.
  struct Adaptor {
    std::size_t count;
    PointAt at;
    std::size_t kdtree_get_point_count() const { return count; }
    double kdtree_get_pt(std::size_t index, std::size_t axis) const {
      const Point& point = at(index);
      return axis == 0 ? point.x : axis == 1 ? point.y : point.z;
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };

  Adaptor adaptor_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>, Adaptor, 3,
                                      std::uint32_t>
      tree_;
};

/// A tree of a cloud.
inline auto kd_tree_of(std::span<const Point> cloud) {
  return KdTree(cloud.size(), [cloud](std::size_t i) -> const Point& { return cloud[i]; });
}

}  // namespace lamplock::geometry
