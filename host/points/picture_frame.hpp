// Where a picture is in space: a parallelogram with the picture on it, and the direction of its
// layers.
//
// In:  size and plane of a picture; maps. Out: the frame, its corners.
// Who: placed_model.cpp places the frame; bitmap_points() puts points on it. Lengths in mm.
#pragma once

#include <array>

#include "host/geometry/affine.hpp"
#include "host/geometry/point.hpp"
#include "host/model/bitmap.hpp"

namespace lamplock::points {

/// Plane of the picture; its left and bottom are at the lower coordinates.
enum class Plane {
  xy,  // top +y, layers along z
  xz,  // top +z, layers along y
  yz   // top +z, left -y, layers along x
};

struct PictureFrame {
  geometry::Point centre{};
  geometry::Point right{}, up{};  ///< lower and left side, from end to end
  geometry::Point normal{};       ///< from layer to layer; of length 1
};

/// A picture with this longest side, round the origin. Throws Error(bad_input) for a size that is
/// not positive, or a picture without pixels.
PictureFrame picture_frame(const model::Bitmap& bitmap, double size_mm, Plane plane);

/// The frame under a map. The normal stays perpendicular to the picture.
PictureFrame transformed(const PictureFrame& frame, const geometry::Affine& map);

/// The corners of the middle layer.
std::array<geometry::Point, 4> corners(const PictureFrame& frame);

}  // namespace lamplock::points
