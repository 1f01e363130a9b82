// Where vertical lines cross triangles. In: triangles and places. Out: the crossings of the line
// through a place. Called by Inside and bodies_of().
//
// Triangles are listed by the cells of a grid in x and y that they may cover; a line needs one
// cell. The side on which it passes an edge is computed the same way for all triangles of the edge,
// so that a line never passes between them. Memory is linear in the triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::points {

using Triangle = std::array<std::uint32_t, 3>;

struct Crossing {
  std::uint32_t triangle = 0;  ///< its index
  double z = 0;
  bool normal_up = false;  ///< the line crosses the triangle from its back to its front
};

class VerticalCrossings {
 public:
  /// Coordinates must be finite; vertices and triangles must outlive this.
  VerticalCrossings(std::span<const geometry::Point> vertices, std::span<const Triangle> triangles);

  /// Calls `hit(crossing)` for every triangle above `place`.
  template <class Hit>
  void for_each_above(const geometry::Point& place, const Hit& hit) const {
    const std::size_t column =
        column_rank(place.y, box_.low.y) * side_ + column_rank(place.x, box_.low.x);
    for (std::size_t i = first_[column]; i < first_[column + 1]; ++i) {
      const Listed& listed = listed_[i];
      if (!listed.may_be_above(place)) continue;
      const auto crossing = crossing_of(listed.triangle, place);
      if (crossing && crossing->z > place.z) hit(*crossing);
    }
  }

 private:
  /// A triangle in a column, with bounds that are rounded outwards: most triangles of a column are
  /// passed over without a look at their vertices.
  struct Listed {
    std::uint32_t triangle = 0;
    float x_low = 0, x_high = 0, y_low = 0, y_high = 0, z_high = 0;

    bool may_be_above(const geometry::Point& place) const {
      return place.z <= z_high && place.x >= x_low && place.x <= x_high && place.y >= y_low &&
             place.y <= y_high;
    }
  };
  struct Columns {  // cells from, to (included) of a triangle
    std::size_t x_from, x_to, y_from, y_to;
  };
  Columns columns_of(const Triangle& triangle) const;
  Listed listed(std::uint32_t triangle) const;
  std::size_t column_rank(double coordinate, double from) const;
  void choose_columns();
  bool is_left(std::uint32_t from, std::uint32_t to, const geometry::Point& place) const;
  std::optional<Crossing> crossing_of(std::uint32_t triangle, const geometry::Point& place) const;

  std::span<const geometry::Point> vertices_;
  std::span<const Triangle> triangles_;
  geometry::Bounds box_;
  std::size_t side_ = 1;  // columns in x and in y
  double width_mm_ = 1;   // of a column
  std::vector<std::uint32_t> first_;
  std::vector<Listed> listed_;
};

}  // namespace lamplock::points
