#include "host/model/polygon_triangles.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::model {
namespace {

using geometry::Point;

/// A corner in the plane of its polygon.
struct Corner {
  double x = 0, y = 0;
};

/// Twice the signed area.
double area(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Drops the axis along which the polygon is thinnest. Counter-clockwise afterwards. Differences to
/// the first corner keep small polygons far from the origin.
std::vector<Corner> in_plane(std::span<const Point> polygon) {
  Point normal;
  const Point& o = polygon.front();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Point a{p.x - o.x, p.y - o.y, p.z - o.z}, b{q.x - o.x, q.y - o.y, q.z - o.z};
    normal.x += a.y * b.z - a.z * b.y;
    normal.y += a.z * b.x - a.x * b.z;
    normal.z += a.x * b.y - a.y * b.x;
  }
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  std::vector<Corner> corners;
  corners.reserve(polygon.size());
  for (const Point& p : polygon) {
    const Point d{p.x - o.x, p.y - o.y, p.z - o.z};
    if (z >= x && z >= y) {
      corners.push_back({normal.z < 0 ? -d.x : d.x, d.y});
    } else if (x >= y) {
      corners.push_back({normal.x < 0 ? -d.y : d.y, d.z});
    } else {
      corners.push_back({normal.y < 0 ? -d.z : d.z, d.x});
    }
  }
  return corners;
}

/// True if all corners turn left, by more than `min_area` (twice the area of the corner with its
/// neighbours), and the polygon turns round once.
bool is_convex(const std::vector<Corner>& corners, double min_area) {
  const std::size_t n = corners.size();
  int changes = 0;  // of the direction in x, which are two for one turn
  double last = 0;
  for (std::size_t i = 0; i <= n + 1; ++i) {
    const Corner &a = corners[i % n], &b = corners[(i + 1) % n], &c = corners[(i + 2) % n];
    if (!(area(a, b, c) > min_area)) return false;
    const double step = b.x - a.x;
    if (step == 0) continue;
    if (i <= n && last * step < 0) ++changes;
    last = step;
  }
  return changes <= 2;
}

/// Rounding errors of areas.
double rounding_area(const std::vector<Corner>& corners) {
  double side = 0;
  for (const Corner& corner : corners)
    side = std::max({side, std::abs(corner.x), std::abs(corner.y)});
  constexpr double rounding = 1e-9;
  return rounding * side * side;
}

/// The corners that are left while ears are cut.
class Ears {
 public:
  explicit Ears(const std::vector<Corner>& corners)
      : corners_(corners), next_(corners.size()), before_(corners.size()) {
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      before_[i] = (i + n - 1) % n;
    }
  }

  std::vector<std::array<std::size_t, 3>> cut() {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t left = corners_.size(), at = 0, tried = 0;
    // Each round tests every corner at most once; without an ear in it, any corner is cut.
    while (left > 3) {
      if (tried < left && !is_ear(at)) {
        at = next_[at];
        ++tried;
        continue;
      }
      triangles.push_back({before_[at], at, next_[at]});
      next_[before_[at]] = next_[at];
      before_[next_[at]] = before_[at];
      at = next_[at];
      // After a corner was cut by force, the others are not tested again: the polygon crosses
      // itself.
      tried = tried < left ? 0 : left;
      --left;
    }
    triangles.push_back({before_[at], at, next_[at]});
    return triangles;
  }

 private:
  bool is_ear(std::size_t i) const {
    const Corner &a = corners_[before_[i]], &b = corners_[i], &c = corners_[next_[i]];
    if (area(a, b, c) <= 0) return false;
    for (std::size_t k = next_[next_[i]]; k != before_[i]; k = next_[k]) {
      const Corner& p = corners_[k];
      const bool is_corner = (p.x == a.x && p.y == a.y) || (p.x == c.x && p.y == c.y);
      if (!is_corner && area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0)
        return false;
    }
    return true;
  }

  const std::vector<Corner>& corners_;
  std::vector<std::size_t> next_, before_;
};

}  // namespace

std::vector<std::array<std::size_t, 3>> triangles_of(std::span<const Point> polygon) {
  if (polygon.size() < 3) return {};
  if (polygon.size() == 3) return {{0, 1, 2}};
  const std::vector<Corner> corners = in_plane(polygon);
  // Straight corners give triangles without area in a fan, so small polygons with such are cut.
  const bool is_large = polygon.size() > max_concave_corners;
  if (!is_convex(corners, is_large ? -rounding_area(corners) : 0)) {
    if (is_large) return {};
    return Ears(corners).cut();
  }
  std::vector<std::array<std::size_t, 3>> triangles;
  for (std::size_t i = 2; i < polygon.size(); ++i) triangles.push_back({0, i - 1, i});
  return triangles;
}

}  // namespace lamplock::model
