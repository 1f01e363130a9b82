// Refraction at a flat entry face: the stage position for a defect at a position in the glass.
//
// The beam comes from +z and enters through a face of constant z. Rays near the axis are refracted
// so that a stage move dz moves the focus by n dz ("Mechatronic positioning of a pulsed laser beam
// in devices forming 3-D objects in glass"): stage z = entry + (glass z - entry) / n. x and y do
// not change. Point clouds are in glass coordinates, jobs in stage coordinates, reports in glass
// coordinates.
//
// In:  a point in one of the two. Out: the same point in the other; above the face, in air, both
//      are equal. Who: making jobs, reports, the check of the machine's travel.
#pragma once

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::glass {

/// A glass with a flat top; by default no glass.
struct Refraction {
  double index = 1;     ///< refractive index, 1 or more
  double entry_mm = 0;  ///< z of the entry face

  bool bends() const { return index != 1; }

  /// Stage z for a focus at this z in the glass, mm.
  double stage_z(double glass_z) const {
    return glass_z >= entry_mm ? glass_z : entry_mm + (glass_z - entry_mm) / index;
  }
  /// z of the focus for this stage z, mm.
  double glass_z(double stage_z) const {
    return stage_z >= entry_mm ? stage_z : entry_mm + (stage_z - entry_mm) * index;
  }
  geometry::Point stage(const geometry::Point& glass) const {
    return {glass.x, glass.y, bends() ? stage_z(glass.z) : glass.z};
  }
  geometry::Point glass(const geometry::Point& stage) const {
    return {stage.x, stage.y, bends() ? glass_z(stage.z) : stage.z};
  }
  /// Travel of the focus if the stage's travel is `stage`.
  geometry::Bounds reach(const geometry::Bounds& stage) const {
    return {glass(stage.low), glass(stage.high)};
  }

  friend bool operator==(const Refraction&, const Refraction&) = default;
};

}  // namespace lamplock::glass
