#include "host/run/mesh_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/glass/unused_parameters.hpp"
#include "host/model/transform.hpp"
#include "host/points/blue_noise.hpp"
#include "host/points/empty_surface.hpp"
#include "host/points/fill_faces.hpp"
#include "host/points/fill_solid.hpp"
#include "host/points/rays.hpp"
#include "host/points/slice.hpp"

namespace lamplock::run {
namespace {

using glass::Object;
using model::Mesh;

/// A place is empty if no point is within so many spacings: the largest gap of a filled face is 2.
constexpr double empty_spacings = 3;
/// Poles of round bodies always lose as much.
constexpr double empty_share_to_warn_of = 0.01;

geometry::Axis axis_named(const std::string& name) {
  return name == "x" ? geometry::Axis::x : name == "y" ? geometry::Axis::y : geometry::Axis::z;
}

MeshPoints by_blue_noise(const Mesh& mesh, const Object& object, double spacing_mm) {
  points::BlueNoiseOptions options;
  options.distance_mm = spacing_mm;
  options.seed = static_cast<std::uint64_t>(object.seed);
  if (object.tone) {
    if (!mesh.brightness)
      throw Error(Exit::bad_input, object.file,
                  fmt::format("has neither colours nor a texture{}{}",
                              mesh.reader_warnings.empty() ? "" : "; ",
                              fmt::join(mesh.reader_warnings, "; ")),
                  "leave tone out");
    options.tone =
        points::ToneCurve{object.gamma, object.invert, object.tone_lowest, object.tone_highest};
  }
  return {points::blue_noise(mesh, options), {}, true};
}

MeshPoints by_slices(const Mesh& mesh, const Object& object, double spacing_mm) {
  points::SliceOptions options;
  options.layer_mm = object.layer_mm.value_or(spacing_mm);
  options.vertex_mm = spacing_mm;
  options.first_offset_mm = object.first_mm;
  options.last_offset_mm = object.last_mm;
  options.twist_mm = object.twist_mm;
  options.end_points = object.end_points.value_or(false);
  options.frame = slice_frame_of(object);
  points::LayeredPoints slices = points::slice_in_layers(mesh, options);
  MeshPoints result{std::move(slices.points), std::move(slices.first)};
  return result;
}

MeshPoints by_faces(const Mesh& mesh, const Object& object, double spacing_mm) {
  points::FaceFill fill = points::fill_faces(mesh, {spacing_mm, object.min_mm});
  MeshPoints result{std::move(fill.points), {}, true, fill.rejected};
  if (fill.rejected != 0)
    result.warnings.push_back(
        fmt::format("{} of {} triangles are smaller than the smallest side or have no area",
                    fill.rejected, mesh.triangles.size()));
  return result;
}

/// Rays along an axis, or along an axis turned: the mesh is turned back under them.
MeshPoints by_rays(const Mesh& mesh, const Object& object, double spacing_mm) {
  const points::RayOptions options{spacing_mm, axis_named(object.direction)};
  if (!object.turn_deg) return {points::rays(mesh, options)};
  const auto [x, y, z] = *object.turn_deg;
  const geometry::Affine turn =
      geometry::turned_about_z(z) * geometry::turned_about_y(y) * geometry::turned_about_x(x);
  const Mesh turned = model::transformed(mesh, geometry::turned_back(turn));
  return {model::transformed(points::rays(turned, options), turn)};
}

MeshPoints by_solid(const Mesh& mesh, const Object& object, double spacing_mm) {
  points::SolidOptions options;
  options.name = object.file;
  options.distance_mm = spacing_mm;
  options.seed = static_cast<std::uint64_t>(object.seed);
  options.light_depth_mm = object.light_depth_mm;
  options.min_density = object.light_lowest;
  return {points::fill_solid(mesh, options), {}, true};
}

MeshPoints by_method(const std::string& method, const Mesh& mesh, const Object& object,
                     double spacing_mm) {
  if (method == "slice") return by_slices(mesh, object, spacing_mm);
  if (method == "faces") return by_faces(mesh, object, spacing_mm);
  if (method == "rays") return by_rays(mesh, object, spacing_mm);
  if (method == "solid") return by_solid(mesh, object, spacing_mm);
  return by_blue_noise(mesh, object, spacing_mm);
}

/// What fills the surface that a method leaves empty.
std::string remedy_for(const std::string& method) {
  if (method == "slice")
    return "faces along the planes get none: turn the planes, or use --method blue-noise";
  if (method == "rays")
    return "faces along the rays get none: turn the rays, or use --method blue-noise";
  if (method == "faces") return "use a smaller --smallest, or --method blue-noise";
  return "use a smaller --spacing";
}

/// Measures how much of the surface is empty. Tone and light depth leave parts empty on purpose.
void judge_surface(const std::string& method, const Mesh& mesh, const Object& object,
                   double spacing_mm, MeshPoints& made) {
  if (object.tone || (method == "solid" && object.light_depth_mm > 0)) return;
  const double layer_mm = method == "slice" ? object.layer_mm.value_or(spacing_mm) : spacing_mm;
  const double reach_mm = empty_spacings * std::max(spacing_mm, layer_mm);
  made.empty_share = points::empty_share(mesh, made.points, reach_mm);
  if (made.empty_share > empty_share_to_warn_of)
    made.warnings.push_back(fmt::format("{:.1f} % of the surface has no point within {:.3g} mm; {}",
                                        made.empty_share * 100, reach_mm, remedy_for(method)));
}

}  // namespace

points::SliceFrame slice_frame_of(const Object& object) {
  const glass::Triple turn = object.turn_deg.value_or(glass::Triple{});
  return {axis_named(object.axis), turn[0], turn[1], turn[2]};
}

MeshPoints mesh_points(const Mesh& mesh, const Object& object, double spacing_mm) {
  const std::string method = object.method.value_or(glass::default_method);
  if (object.tone && method != "blue-noise")
    throw Error(Exit::bad_input, object.file, "only blue noise has tones",
                "leave tone out, or use --method blue-noise");
  MeshPoints made = by_method(method, mesh, object, spacing_mm);
  judge_surface(method, mesh, object, spacing_mm, made);
  return made;
}

}  // namespace lamplock::run
