// Tests whether places are inside a closed mesh, and the thickness above them. In: a mesh and
// places. Out: the crossings of a ray upwards from the place. Called by fill_solid().
//
// Triangles are listed by the cells of a grid in x and y that they may cover; a ray needs one cell.
// The side on which it passes an edge is computed the same way for both triangles of the edge, so
// that a ray never passes between them. Memory is linear in the triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

class Inside {
 public:
  /// The mesh must be closed, with finite coordinates, and must outlive this.
  explicit Inside(const model::Mesh& mesh);

  /// True if a ray upwards crosses the surface an odd number of times.
  bool contains(const geometry::Point& place) const;
  /// Thickness of the body straight above `place` in mm, without gaps between its parts.
  double filled_above_mm(const geometry::Point& place) const;

 private:
  struct Columns {  // cells from, to (included) of a triangle
    std::size_t x_from, x_to, y_from, y_to;
  };
  Columns columns_of(std::size_t triangle) const;
  std::size_t column_rank(double coordinate, double from) const;
  void choose_columns();
  /// Calls `hit(z)` for every triangle above or below the place.
  template <class Hit>
  void for_each_crossing(const geometry::Point& place, const Hit& hit) const;

  const model::Mesh& mesh_;
  geometry::Bounds box_;
  std::size_t side_ = 1;  // columns in x and in y
  double width_mm_ = 1;   // of a column
  std::vector<std::uint32_t> first_, triangles_;
};

}  // namespace lamplock::points
