#include "host/run/no_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <variant>

#include "host/error.hpp"
#include "host/geometry/bounds.hpp"
#include "host/geometry/vector.hpp"
#include "host/glass/unused_parameters.hpp"
#include "host/points/slice.hpp"
#include "host/run/mesh_points.hpp"

namespace lamplock::run {
namespace {

using geometry::Point;
using glass::Object;
using model::Mesh;

constexpr const char* finer = "use a smaller --spacing or a greater --size";
constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

struct Cause {
  std::string what, remedy;
};

std::array<double, 3> numbers_of(const Point& point) { return {point.x, point.y, point.z}; }

/// The area that a mesh shows to each axis, both sides together, and its whole area, mm2.
struct Areas {
  std::array<double, 3> shown{};
  double whole = 0;
};

Areas areas_of(const Mesh& mesh) {
  Areas areas;
  for (const auto& triangle : mesh.triangles) {
    const Point &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]],
                &c = mesh.vertices[triangle[2]];
    const auto normal =
        numbers_of(geometry::cross(geometry::difference(b, a), geometry::difference(c, a)));
    for (std::size_t i = 0; i < 3; ++i) areas.shown[i] += std::abs(normal[i]) / 2;
    areas.whole += std::hypot(normal[0], normal[1], normal[2]) / 2;
  }
  return areas;
}

/// The axis of the greatest value.
std::string axis_of_max(const std::array<double, 3>& values) {
  return axis_names[static_cast<std::size_t>(
      std::distance(values.begin(), std::max_element(values.begin(), values.end())))];
}

/// "along z", "across the turned planes".
std::string across(const Object& object) {
  return object.turn_deg ? "across the turned planes" : "along " + object.axis;
}

Cause cause_of_slices(const Mesh& mesh, const Object& object, double spacing_mm) {
  const double height = points::height_across(mesh, slice_frame_of(object));
  const double layer = object.layer_mm.value_or(spacing_mm);
  const double first = object.first_mm.value_or(layer / 2), last = object.last_mm.value_or(0);
  const geometry::Bounds box = geometry::bounds(mesh.vertices);
  const auto sides = numbers_of(geometry::difference(box.high, box.low));
  constexpr double rounding = 1e-9;
  const std::string height_text = fmt::format("is {:.4g} mm high {}", height, across(object));
  if (height <= rounding * box.max_side()) {
    const std::string other =
        object.turn_deg ? "turn the planes otherwise, or use --method blue-noise"
                        : fmt::format("use --axis {}, or --method blue-noise", axis_of_max(sides));
    return {fmt::format("gives no points: it {}, so no plane cuts it", height_text), other};
  }
  if (object.first_mm && first >= height)
    return {fmt::format("gives no points: it {}, and its first plane is {:.4g} mm above its "
                        "lowest point",
                        height_text, first),
            fmt::format("use --first {:.4g}, or leave it out", std::min(layer, height) / 2)};
  if (first + last >= height && object.last_mm && last > 0)
    return {fmt::format("gives no points: it {}, and its planes begin {:.4g} mm above its lowest "
                        "and end {:.4g} mm below its highest point",
                        height_text, first, last),
            "use a smaller --last, or leave it out"};
  if (!object.first_mm)
    return {fmt::format("gives no points: it {}, and its first plane is half a layer, {:.4g} mm, "
                        "above its lowest point",
                        height_text, first),
            fmt::format("use --layer {:.4g}, or --method blue-noise", height / 2)};
  return {fmt::format("gives no points: it {}, and its planes only touch it", height_text),
          fmt::format("use --first {:.4g}, or --method blue-noise", std::min(layer, height) / 2)};
}

Cause cause_of_rays(const Areas& areas, const Object& object, double spacing_mm) {
  if (object.turn_deg)
    return {"gives no points: no turned ray hits its faces",
            "leave --turn out, use a smaller --spacing, or --method blue-noise"};
  const std::size_t direction = object.direction == "x" ? 0 : object.direction == "y" ? 1 : 2;
  constexpr double rounding = 1e-9;
  if (areas.shown[direction] > rounding * areas.whole)
    return {fmt::format("gives no points: it is thinner than the distance of the rays, {:.4g} mm",
                        spacing_mm),
            std::string(finer) + ", or --method blue-noise"};
  return {fmt::format("gives no points: all its faces lie along the rays, which have the direction "
                      "{}",
                      object.direction),
          fmt::format("use --direction {}, or --method blue-noise", axis_of_max(areas.shown))};
}

/// The remedy for a density of 0 everywhere.
std::string other_tone(const Object& object) {
  return fmt::format("{} --invert, or use --tone-lowest 0.1", object.invert ? "leave out" : "use");
}

Cause cause_of_mesh(const Mesh& mesh, const Object& object, double spacing_mm) {
  const Areas areas = areas_of(mesh);
  if (!(areas.whole > 0))
    return {"gives no points: its triangles have no area",
            object.size_mm ? "use a greater --size, or repair the mesh" : "repair the mesh"};
  const std::string method = object.method.value_or(glass::default_method);
  if (method == "slice") return cause_of_slices(mesh, object, spacing_mm);
  if (method == "rays") return cause_of_rays(areas, object, spacing_mm);
  if (method == "faces" && object.min_mm > 0)
    return {fmt::format("gives no points: all sides of its triangles are shorter than --smallest "
                        "{:g} mm",
                        object.min_mm),
            "use --smallest 0, or --method blue-noise"};
  if (method == "solid")
    return {"gives no points: it is too thin or too small for points inside",
            std::string(finer) + ", or --method blue-noise"};
  if (object.tone)
    return {"gives no points: its brightness gives the density 0", other_tone(object)};
  return {"gives no points", finer};
}

/// The darkest and the lightest visible pixel, over what gives no points.
struct Greys {
  int darkest = model::white, lightest = model::black;
  bool is_visible = false;
};

Greys greys_of(const model::Bitmap& bitmap, bool invert) {
  Greys greys;
  for (std::size_t i = 0; i < bitmap.grey.size(); ++i) {
    if (!bitmap.is_visible(i)) continue;
    const int grey = bitmap.grey_over(i, invert ? model::black : model::white);
    greys.darkest = std::min(greys.darkest, grey);
    greys.lightest = std::max(greys.lightest, grey);
    greys.is_visible = true;
  }
  return greys;
}

Cause cause_of_picture(const model::Bitmap& bitmap, const Object& object) {
  const Greys greys = greys_of(bitmap, object.invert);
  if (!greys.is_visible)
    return {"gives no points: all its pixels are transparent", "give a picture with opaque pixels"};
  const bool is_empty =
      object.invert ? greys.lightest == model::black : greys.darkest == model::white;
  const std::string colour = object.invert ? "black" : "white";
  const std::string other = object.invert ? "leave out --invert" : "use --invert";
  if (is_empty && object.tone)
    return {fmt::format("gives no points: it is {}, which gives the density 0", colour),
            other_tone(object)};
  if (is_empty) return {fmt::format("gives no points: it is {}", colour), other};
  if (object.tone)
    return {"gives no points: its densities are too low for its size",
            std::string(finer) + ", or a greater --tone-lowest"};
  const bool is_missed =
      object.invert ? greys.lightest < object.threshold : greys.darkest >= object.threshold;
  if (!is_missed)
    return {"gives no points: its parts are smaller than the spacing",
            std::string(finer) + ", or --tone"};
  const int extreme = object.invert ? greys.lightest : greys.darkest;
  return {fmt::format("gives no points: its {} grey is {}, and the threshold {}",
                      object.invert ? "lightest" : "darkest", extreme, object.threshold),
          fmt::format("use --tone, which makes densities of greys, --threshold {}, or {}",
                      object.invert ? extreme : extreme + 1, other)};
}

}  // namespace

void refuse_without_points(const PlacedModel& model, const Object& object, double spacing_mm) {
  Cause cause{"gives no points", finer};
  if (const auto* mesh = std::get_if<Mesh>(&model.model))
    cause = cause_of_mesh(*mesh, object, spacing_mm);
  else if (const auto* picture = std::get_if<PlacedPicture>(&model.model))
    cause = cause_of_picture(picture->bitmap, object);
  else if (std::holds_alternative<model::Curves>(model.model))
    cause.what = "gives no points: its curves are shorter than the spacing";
  throw Error(Exit::bad_input, object.file, cause.what, cause.remedy);
}

void refuse_thinned_out(const Object& object) {
  throw Error(Exit::bad_input, object.file,
              fmt::format("gives no points: the densities of depth, {:g} at the face and {:g} at "
                          "full depth, leave none",
                          object.face_density, object.depth_density),
              "use a greater --face-density or --depth-density, or a smaller --spacing");
}

}  // namespace lamplock::run
