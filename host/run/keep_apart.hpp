// Keeps the points of slices, rays, drawings and bitmaps apart.
//
// Inside a layer no two points are closer than the weld distance; without a stated one, a part of
// the spacing. Layers keep all their points, although the user may have chosen a distance of layers
// that is smaller, unless that violates a stated minimum distance: that of the weld, or that of the
// lens, below which the glass cracks. Then this minimum is kept between all points, with a warning.
//
// In:  points, layer by layer; the object, the glass.
// Out: points, what was left out, warnings.
// Who: discretise.cpp.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/points/layered_points.hpp"

namespace lamplock::run {

struct PointsApart {
  geometry::PointCloud points{};
  double distance_mm = 0;  ///< no two points are closer
  std::size_t removed = 0;
  std::vector<std::string> warnings{};
};

/// `layer_mm`: between the planes of neighbouring layers; unused if there is one layer at most.
/// Throws Error(bad_input).
PointsApart keep_apart(points::LayeredPoints cloud, double layer_mm, const glass::Object& object,
                       double spacing_mm, const glass::GlassChoice& glass);

}  // namespace lamplock::run
