#include "host/points/picture_frame.hpp"

#include <algorithm>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/vector.hpp"

namespace lamplock::points {

using geometry::Point;

PictureFrame picture_frame(const model::Bitmap& bitmap, double size_mm, Plane plane) {
  geometry::require_positive(size_mm, "bitmap", "size");
  if (bitmap.width <= 0 || bitmap.height <= 0)
    throw Error(Exit::bad_input, "bitmap", "it has no pixels", "give a picture");
  const double pixel_mm = size_mm / std::max(bitmap.width, bitmap.height);
  const double width = bitmap.width * pixel_mm, height = bitmap.height * pixel_mm;
  switch (plane) {
    case Plane::xz:
      return {{}, {width, 0, 0}, {0, 0, height}, {0, 1, 0}};
    case Plane::yz:
      return {{}, {0, width, 0}, {0, 0, height}, {1, 0, 0}};
    case Plane::xy:
      break;
  }
  return {{}, {width, 0, 0}, {0, height, 0}, {0, 0, 1}};
}

PictureFrame transformed(const PictureFrame& frame, const geometry::Affine& map) {
  PictureFrame result{map(frame.centre), map.turn(frame.right), map.turn(frame.up), {}};
  const auto unit = [](const Point& way) { return geometry::times(way, 1 / geometry::norm(way)); };
  const Point square = geometry::cross(unit(result.right), unit(result.up));
  const double side = geometry::dot(square, map.turn(frame.normal)) < 0 ? -1 : 1;
  result.normal = geometry::times(unit(square), side);
  return result;
}

std::array<Point, 4> corners(const PictureFrame& frame) {
  const geometry::Affine place{frame.right, frame.up, frame.normal, frame.centre};
  return {place({-0.5, -0.5, 0}), place({0.5, -0.5, 0}), place({-0.5, 0.5, 0}),
          place({0.5, 0.5, 0})};
}

}  // namespace lamplock::points
