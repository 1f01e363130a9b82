#include "host/report/glass_scene.hpp"

#include <array>
#include <optional>
#include <utility>

namespace lamplock::report {
namespace {

constexpr Vec night{0.0035f, 0.0050f, 0.0095f};
constexpr Vec haze{0.016f, 0.026f, 0.048f};
constexpr Vec glow{0.22f, 0.48f, 1.0f};  ///< the lamp in the plinth
constexpr Vec edge_light{0.62f, 0.82f, 1.0f};

struct Hit {
  float t;
  int axis;  ///< 0..2: the normal of the face
};
struct Crossing {
  Hit in, out;
};

float component(Vec v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
float square(float x) { return x * x; }

/// Entry and exit of a ray through a box (slab method).
std::optional<Crossing> cross_box(const Box& box, Vec from, Vec direction) {
  Crossing c{{-1e30f, 0}, {1e30f, 0}};
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1 / component(direction, axis);
    float near = (component(box.low, axis) - component(from, axis)) * inverse;
    float far = (component(box.high, axis) - component(from, axis)) * inverse;
    if (near > far) std::swap(near, far);
    if (near > c.in.t) c.in = {near, axis};
    if (far < c.out.t) c.out = {far, axis};
  }
  if (c.in.t >= c.out.t || c.in.t < 0) return std::nullopt;
  return c;
}

/// Distance from a point to a rectangle in the xy plane; 0 inside.
float distance_to_footprint(const Box& box, Vec p) {
  const float dx = std::max({box.low.x - p.x, 0.0f, p.x - box.high.x});
  const float dy = std::max({box.low.y - p.y, 0.0f, p.y - box.high.y});
  return std::sqrt(dx * dx + dy * dy);
}

class Stage {
 public:
  Stage(const Box& block, const Camera& camera)
      : block_(block),
        plinth_(plinth_under(block)),
        camera_(camera),
        scale_(std::max({block.size().x, block.size().y, block.size().z})) {}

  /// Light along a ray; `u`, `v` is the position on the picture, -1..1.
  Vec light(Vec direction, float u, float v) const {
    const Vec eye = camera_.eye();
    const auto plinth = cross_box(plinth_, eye, direction);
    const Vec behind =
        plinth ? plinth_light(eye + direction * plinth->in.t, plinth->in.axis, direction)
               : room_light(direction, u, v);
    const auto glass = cross_box(block_, eye, direction);
    return glass ? through_glass(*glass, direction, behind) : behind;
  }

 private:
  Vec room_light(Vec direction, float u, float v) const {
    const float centre = std::exp(-(square(u) + square(v + 0.1f)) * 1.3f);
    const Vec wall = night + haze * (0.38f * centre);
    if (direction.z >= 0) return wall;
    const float t = (plinth_.low.z - camera_.eye().z) / direction.z;
    const Vec p = camera_.eye() + direction * t;
    const float away = distance_to_footprint(plinth_, p) / scale_;
    const float pool = 0.036f * std::exp(-away * 5.0f) + 0.012f * std::exp(-away * 1.3f);
    const float contact = 1 - 0.75f * std::exp(-away * 40.0f);  // the plinth's own shadow
    return wall + glow * (pool * contact);
  }

  Vec plinth_light(Vec p, int axis, Vec direction) const {
    const Vec body = axis == 2   ? Vec{0.012f, 0.014f, 0.019f}
                     : axis == 1 ? Vec{0.007f, 0.008f, 0.012f}
                                 : Vec{0.004f, 0.005f, 0.008f};
    const float pixel = dot(p - camera_.eye(), camera_.forward()) / camera_.focal();
    const float rim = edge_glow(plinth_, p, axis, 1.3f * pixel);
    Vec result = body + edge_light * (0.05f * rim);
    if (axis == 2) {
      const float away = distance_to_footprint(block_, p) / scale_;
      result += glow * (0.30f * std::exp(-away * 34.0f) + 0.035f * std::exp(-away * 8.0f));
    } else {
      // A thin line of light under the top edge, and the sheen of a polished side.
      const float below = (plinth_.high.z - p.z) / (plinth_.high.z - plinth_.low.z);
      result += glow * (0.06f * std::exp(-below * 3.0f));
      result += haze * (0.25f * square(1 - std::abs(component(direction, axis))));
    }
    return result;
  }

  /// 1 on an edge of the face that p lies on, falling off over `width`.
  static float edge_glow(const Box& box, Vec p, int axis, float width) {
    float nearest = 1e30f;
    for (int other = 0; other < 3; ++other) {
      if (other == axis) continue;
      const float value = component(p, other);
      nearest = std::min(
          {nearest, value - component(box.low, other), component(box.high, other) - value});
    }
    return std::exp(-square(nearest / width));
  }

  /// Share of the plinth's light at a height inside the block, 1 at the bottom.
  float lit(float z) const {
    return 0.25f + 0.75f * std::exp(-(z - block_.low.z) / (0.45f * scale_));
  }

  /// Edges and sheen of one face of the block.
  Vec face(Vec p, Hit hit, Vec direction, float strength) const {
    const float pixel = dot(p - camera_.eye(), camera_.forward()) / camera_.focal();
    const float line = edge_glow(block_, p, hit.axis, 1.5f * pixel);
    const float bevel = edge_glow(block_, p, hit.axis, 0.022f * scale_);
    const float slant = 1 - std::abs(component(direction, hit.axis));
    const float fresnel = 0.04f + 0.96f * square(square(slant)) * slant;
    // A soft band of reflected sky across each face.
    const float band = (p.z - block_.low.z) / scale_ + 0.6f * (p.x - p.y) / scale_;
    const float sheen = std::exp(-square((band - 0.55f) * 3.2f));
    return edge_light * (strength * lit(p.z) * (0.55f * line + 0.040f * bevel)) +
           haze * (strength * (0.10f + 0.9f * fresnel + 0.30f * sheen));
  }

  /// Light of the plinth scattered along the path through the glass, exact for an exponential.
  float fog(Vec from, Vec to) const {
    const float height = 0.30f * scale_;
    const float a = (from.z - block_.low.z) / height, b = (to.z - block_.low.z) / height;
    const Vec way = to - from;
    const float length = std::sqrt(dot(way, way)) / scale_;
    const float mean =
        std::abs(a - b) < 1e-3f ? std::exp(-a) : (std::exp(-a) - std::exp(-b)) / (b - a);
    return length * mean;
  }

  Vec through_glass(const Crossing& c, Vec direction, Vec behind) const {
    const Vec in = camera_.eye() + direction * c.in.t, out = camera_.eye() + direction * c.out.t;
    const Vec tint{0.86f, 0.90f, 0.93f};
    // Through the bottom the lamp is visible.
    const bool bottom = c.out.axis == 2 && direction.z < 0;
    Vec result = bottom ? glow * bottom_light(out) : behind * tint;
    result += face(out, c.out, direction, 0.45f) + glow * (0.042f * fog(in, out));
    return result + face(in, c.in, direction, 1.0f);
  }

  float bottom_light(Vec p) const {
    const Vec offset = p - block_.centre(), half = block_.size() * 0.5f;
    const float r2 = square(offset.x / half.x) + square(offset.y / half.y);
    return 0.055f + 0.115f * std::exp(-1.7f * r2);
  }

  Box block_, plinth_;
  const Camera& camera_;
  float scale_;
};

}  // namespace

Box plinth_under(const Box& block) {
  const Vec size = block.size();
  const float longest = std::max({size.x, size.y, size.z});
  const float rim = 0.055f * longest;
  return {{block.low.x - rim, block.low.y - rim, block.low.z - 0.085f * longest},
          {block.high.x + rim, block.high.y + rim, block.low.z}};
}

void paint_glass_scene(Image& image, const Box& block, const Camera& camera, unsigned threads) {
  const Stage stage(block, camera);
  const float w = static_cast<float>(image.width), h = static_cast<float>(image.height);
  // Four samples a pixel on a rotated grid.
  constexpr std::array<std::pair<float, float>, 4> samples{
      {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}}};
  for_rows(image.height, threads, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      Vec sum;
      for (const auto& [dx, dy] : samples) {
        const float px = static_cast<float>(x) + dx, py = static_cast<float>(y) + dy;
        sum += stage.light(camera.ray(px, py), 2 * px / w - 1, 2 * py / h - 1);
      }
      image.at(x, y) = sum * 0.25f;
    }
  });
}

}  // namespace lamplock::report
