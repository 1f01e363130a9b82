#include "host/geometry/affine.hpp"

#include <cmath>
#include <numbers>

namespace lamplock::geometry {
namespace {

struct Direction {
  double cosine, sine;
};

/// Computed by quarter turns, so that these are exact.
Direction direction(double degrees) {
  const double quarters = std::round(degrees / 90);
  const double rest = (degrees - 90 * quarters) * std::numbers::pi / 180;
  const double c = std::cos(rest), s = std::sin(rest);
  const double quarter = quarters - 4 * std::floor(quarters / 4);
  if (quarter == 1) return {-s, c};
  if (quarter == 2) return {-c, -s};
  if (quarter == 3) return {s, -c};
  return {c, s};
}

}  // namespace

Affine turned_about_x(double degrees) {
  const auto [c, s] = direction(degrees);
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}, {}};
}

Affine turned_about_y(double degrees) {
  const auto [c, s] = direction(degrees);
  return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}, {}};
}

Affine turned_about_z(double degrees) {
  const auto [c, s] = direction(degrees);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {}};
}

Affine turned_back(const Affine& turn) {
  Affine back{{turn.x.x, turn.y.x, turn.z.x},
              {turn.x.y, turn.y.y, turn.z.y},
              {turn.x.z, turn.y.z, turn.z.z},
              {}};
  const Point moved = back.turn(turn.offset);
  back.offset = {-moved.x, -moved.y, -moved.z};
  return back;
}

}  // namespace lamplock::geometry
