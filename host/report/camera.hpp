// Vectors and the perspective camera of the pictures. Pure arithmetic, single precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lamplock::report {

struct Vec {
  float x = 0, y = 0, z = 0;
  friend Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(Vec a, float s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec operator*(Vec a, Vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  Vec& operator+=(Vec b) { return *this = *this + b; }
};
inline float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec normalized(Vec a) { return a * (1 / std::sqrt(dot(a, a))); }
inline Vec mix(Vec a, Vec b, float t) { return a * (1 - t) + b * t; }

/// Box along the axes.
struct Box {
  Vec low, high;
  Vec centre() const { return (low + high) * 0.5f; }
  Vec size() const { return high - low; }
  std::array<Vec, 8> corners() const {
    std::array<Vec, 8> result;
    for (unsigned i = 0; i < 8; ++i)
      result[i] = {(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                   (i & 4) != 0 ? high.z : low.z};
    return result;
  }
};

/// A camera that looks at the centre of a box from a given side and fits it into the picture.
class Camera {
 public:
  /// Position on the picture in pixels and distance along the view.
  struct Projected {
    float x, y, depth;
  };

  Camera(const Box& box, float yaw_deg, float elevation_deg, int width, int height) {
    constexpr float radians = std::numbers::pi_v<float> / 180;
    const float yaw = yaw_deg * radians, elevation = elevation_deg * radians;
    const Vec towards{std::sin(yaw) * std::cos(elevation), -std::cos(yaw) * std::cos(elevation),
                      std::sin(elevation)};
    forward_ = towards * -1.0f;
    right_ = normalized(cross(forward_, {0, 0, 1}));
    up_ = cross(right_, forward_);
    const Vec size = box.size();
    const float longest = std::sqrt(dot(size, size));
    // About 22 degrees of view for a cube: a long lens, as for a product photograph.
    eye_ = box.centre() + towards * (longest * viewing_distance);
    fit(box, static_cast<float>(width), static_cast<float>(height));
  }

  Projected project(Vec point) const {
    const Vec d = point - eye_;
    const float depth = dot(d, forward_);
    return {x0_ + focal_ * dot(d, right_) / depth, y0_ - focal_ * dot(d, up_) / depth, depth};
  }

  /// Unit vector of the ray through a position of the picture.
  Vec ray(float x, float y) const {
    return normalized(forward_ + right_ * ((x - x0_) / focal_) + up_ * ((y0_ - y) / focal_));
  }
  Vec eye() const { return eye_; }
  Vec forward() const { return forward_; }
  float focal() const { return focal_; }

 private:
  static constexpr float viewing_distance = 2.6f;
  static constexpr float filled = 0.84f;  ///< of the picture, by the box

  /// Chooses focal length and centre so that the box fills the picture.
  void fit(const Box& box, float width, float height) {
    float left = std::numeric_limits<float>::max(), right = -left, top = left, bottom = -left;
    for (const Vec corner : box.corners()) {
      const Projected p = project(corner);
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
    const float scale = filled * std::min(width / (right - left), height / (bottom - top));
    focal_ = scale;
    x0_ = width / 2 - scale * (left + right) / 2;
    y0_ = height / 2 - scale * (top + bottom) / 2;
  }

  Vec eye_, forward_, right_, up_;
  float focal_ = 1, x0_ = 0, y0_ = 0;
};

}  // namespace lamplock::report
