// Inside or outside of a closed mesh, and how much of it lies above. Comes in: a mesh and places.
// Goes out: what a ray upwards from the place crosses. Called by fill_solid().
//
// Triangles are kept by the cells of a grid in x and y that they may lie over; a ray looks at one
// cell. Whether it passes an edge left or right is computed the same way for both triangles of the
// edge, so that a ray never slips between them. Memory is linear in the triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/model/mesh.hpp"
#include "host/points/bounds.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

class Inside {
 public:
  /// The mesh is closed, its coordinates are finite, and it outlives this.
  explicit Inside(const model::Mesh& mesh);

  /// Whether a ray upwards crosses the surface an odd number of times.
  bool contains(const Point& place) const;
  /// mm of the body's inside straight above `place`, gaps between its parts left out.
  double filled_above_mm(const Point& place) const;

 private:
  struct Columns {  // cells from, to (included) of a triangle
    std::size_t x_from, x_to, y_from, y_to;
  };
  Columns columns_of(std::size_t triangle) const;
  std::size_t column_rank(double coordinate, double from) const;
  void choose_columns();
  /// Calls `hit(z)` for every triangle above or below the place.
  template <class Hit>
  void for_each_crossing(const Point& place, const Hit& hit) const;

  const model::Mesh& mesh_;
  Bounds box_;
  std::size_t side_ = 1;  // columns in x and in y
  double width_mm_ = 1;   // of a column
  std::vector<std::uint32_t> first_, triangles_;
};

}  // namespace lamplock::points
