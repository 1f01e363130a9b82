// Refraction at a flat entry face: where the stage stands for a defect at a place in the glass.
//
// The beam comes from +z and enters through a face of constant z. Rays near the axis are refracted
// so that a stage move dz moves the focus by n dz ("Mechatronic positioning of a pulsed laser beam
// in devices forming 3-D objects in glass"): stage z = entry + (glass z - entry) / n. x and y are
// left alone. Point clouds are in glass coordinates, jobs in stage coordinates, reports in glass
// coordinates again.
//
// In:  a point in one of the two. Out: the same point in the other; above the face, in air, both
//      are one. Who: making jobs, reports, the check of the machine's reach.
#pragma once

#include "host/points/bounds.hpp"
#include "host/points/point.hpp"

namespace lamplock::glass {

/// A glass with a flat top. Made as no glass at all.
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
  points::Point stage(const points::Point& glass) const {
    return {glass.x, glass.y, bends() ? stage_z(glass.z) : glass.z};
  }
  points::Point glass(const points::Point& stage) const {
    return {stage.x, stage.y, bends() ? glass_z(stage.z) : stage.z};
  }
  /// Where the focus can be if the stage can be in `stage`.
  points::Bounds reach(const points::Bounds& stage) const {
    return {glass(stage.low), glass(stage.high)};
  }

  friend bool operator==(const Refraction&, const Refraction&) = default;
};

}  // namespace lamplock::glass
