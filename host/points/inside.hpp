// Tests whether places are inside a closed mesh, and the thickness above them. In: a mesh and
// places. Out: what the crossings of a ray upwards from the place say. Called by fill_solid().
//
// Inside is where the winding number is not zero: the union of overlapping bodies, without their
// cavities (bodies.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"
#include "host/points/bodies.hpp"
#include "host/points/vertical_crossings.hpp"

namespace lamplock::points {

class Inside {
 public:
  /// The mesh must be closed, with finite coordinates; its vertices must outlive this.
  explicit Inside(const model::Mesh& mesh);
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

  bool contains(const geometry::Point& place) const;
  /// Thickness of the body straight above `place` in mm, without gaps between its parts.
  double filled_above_mm(const geometry::Point& place) const;
  /// The sum of the volumes of all bodies; more than that of their union if they overlap.
  double volume_mm3() const { return volume_mm3_; }

 private:
  /// State of a ray after the crossings so far.
  struct Passed {
    int winding = 0;   // of oriented triangles
    bool odd = false;  // of the others
    bool inside() const { return winding != 0 || odd; }
  };
  void pass(const Crossing& crossing, Passed& passed) const;

  std::vector<Triangle> triangles_;  // oriented ones first
  std::size_t oriented_ = 0;
  double volume_mm3_ = 0;
  VerticalCrossings crossings_;
};

}  // namespace lamplock::points
