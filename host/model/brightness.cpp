#include "host/model/brightness.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::model {
namespace {

/// The pixel at a place, 0..1. Rows of a bitmap go downwards.
double pixel_at(const Bitmap& picture, double u, double v) {
  if (picture.width <= 0 || picture.height <= 0) return 1;
  // NaN counts as 0.
  const auto pixel = [](double place, int count) {
    const double part = std::isfinite(place) ? place - std::floor(place) : 0.0;
    return std::min(static_cast<std::size_t>(part * count), static_cast<std::size_t>(count - 1));
  };
  const std::size_t column = pixel(u, picture.width);
  const std::size_t row = static_cast<std::size_t>(picture.height - 1) - pixel(v, picture.height);
  return picture.grey[row * static_cast<std::size_t>(picture.width) + column] / 255.0;
}

}  // namespace

double Brightness::at(std::size_t triangle, double b, double c) const {
  const double a = 1 - b - c;
  double value = 1;
  if (triangle < corners.size()) {
    const auto& corner = corners[triangle];
    value = a * corner[0] + b * corner[1] + c * corner[2];
  }
  if (triangle < textured.size() && textured[triangle].texture < textures.size()) {
    const auto& place = textured[triangle].corners;
    value *= pixel_at(textures[textured[triangle].texture],
                      a * place[0].u + b * place[1].u + c * place[2].u,
                      a * place[0].v + b * place[1].v + c * place[2].v);
  }
  return value;
}

}  // namespace lamplock::model
