#include "host/run/placed_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/transformation.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/transform.hpp"
#include "host/points/bitmap_points.hpp"

namespace lamplock::run {
namespace {

using geometry::Affine;
using geometry::Bounds;
using geometry::Point;
using geometry::PointCloud;
using glass::Object;
using glass::Volume;
using model::InputKind;

/// Rounding of scaled coordinates; far below a step.
constexpr double rounding_mm = 1e-6;

Bounds box_of(const PointCloud& cloud) { return geometry::bounds(cloud); }
Bounds box_of(const model::Mesh& mesh) { return geometry::bounds(mesh.vertices); }
Bounds box_of(const model::Curves& curves) { return model::bounds(curves); }

/// The box of a model under a map, without a copy of the model.
Bounds box_under(const PointCloud& cloud, const Affine& map) {
  if (cloud.empty()) return {};
  const Point first = map(cloud.front());
  Bounds box{first, first};
  for (const Point& point : cloud) {
    const Point at = map(point);
    box = {{std::min(box.low.x, at.x), std::min(box.low.y, at.y), std::min(box.low.z, at.z)},
           {std::max(box.high.x, at.x), std::max(box.high.y, at.y), std::max(box.high.z, at.z)}};
  }
  return box;
}
Bounds box_under(const model::Mesh& mesh, const Affine& map) {
  return box_under(mesh.vertices, map);
}
Bounds box_under(const model::Curves& curves, const Affine& map) {
  return box_of(model::transformed(curves, map));
}

/// Moves a model to its place: first of all, then the transformations.
template <class Model>
Model placed(Model model, const Affine& first, const Object& object, const Volume& volume) {
  const auto under = [&model](const Affine& map) { return box_under(model, map); };
  const Affine map = glass::placement(first, object.transform, volume, under, object.file);
  return map == Affine{} ? model : model::transformed(std::move(model), map);
}

/// Into the middle of the block, in the size that is wanted.
Affine into_the_middle(const Bounds& box, const std::optional<double>& size_mm,
                       const Volume& volume) {
  const double size = size_mm.value_or(box.max_side());
  const Point middle = volume.middle();
  return geometry::moved(middle.x, middle.y, middle.z) * model::centring_and_scaling(box, size);
}

/// Refuses an object that is too large before the work.
void check_size(const Object& object, const Bounds& box, const Volume& volume) {
  Bounds room = volume.room();
  room.low = {room.low.x - rounding_mm, room.low.y - rounding_mm, room.low.z - rounding_mm};
  room.high = {room.high.x + rounding_mm, room.high.y + rounding_mm, room.high.z + rounding_mm};
  const double scale = glass::fitting_scale(box, room);
  if (scale >= 1) return;
  const double size = std::floor(scale * box.max_side() * 10) / 10;
  std::string remedy = "check travel in the machine profile";
  if (size > 0)
    remedy = object.transform.empty() ? fmt::format("give --size {:g} or less", size)
                                      : "make it smaller, or end its transformations with fit";
  throw Error(Exit::bad_input, object.file,
              fmt::format("is {}, the {} {}", size_text(box),
                          volume.block ? "block has room for" : "work space", size_text(room)),
              remedy);
}

/// In the middle of the block, and from there as the object says.
template <class Model>
Model fitted(Model model, const Object& object, const Volume& volume) {
  const Affine first = into_the_middle(box_of(model), object.size_mm, volume);
  model = placed(std::move(model), first, object, volume);
  check_size(object, box_of(model), volume);
  return model;
}

PlacedModel placed_mesh(model::Mesh mesh, const Object& object, const Volume& volume) {
  PlacedModel result;
  result.kind = InputKind::mesh;
  result.warnings = mesh.reader_warnings;
  for (const std::string& picture : mesh.unread_pictures)
    result.warnings.push_back(
        fmt::format("the picture {} is not read: its surface is white", picture));
  for (std::string& warning : model::warnings(model::find_faults(mesh)))
    result.warnings.push_back(std::move(warning));
  // The reader has turned a GLB, whose y axis always points up.
  if (object.up == "y" && lower_extension(object.file) != ".glb")
    mesh = model::y_up_to_z_up(std::move(mesh));
  mesh = fitted(std::move(mesh), object, volume);
  result.what = fmt::format("{} triangles", mesh.triangles.size());
  result.model = std::move(mesh);
  return result;
}

PlacedModel placed_curves(model::Curves curves, const Object& object, const Volume& volume) {
  PlacedModel result;
  result.kind = InputKind::curves;
  for (const auto& [name, count] : curves.left_out)
    result.warnings.push_back(
        fmt::format("{} x {} cannot be engraved and is left out", count, name));
  if (curves.paths.empty() && curves.points.empty())
    throw Error(Exit::bad_input, object.file, "has no curves",
                "draw lines, arcs or splines; convert text to paths");
  curves = fitted(std::move(curves), object, volume);
  result.what = fmt::format("{} curves", curves.paths.size());
  result.model = std::move(curves);
  return result;
}

points::BitmapOptions bitmap_options(const Object& object, double spacing_mm) {
  points::BitmapOptions options;
  options.size_mm = object.size_mm.value_or(options.size_mm);
  options.spacing_mm = spacing_mm;
  options.threshold = object.threshold;
  options.invert = object.invert;
  options.layers = object.layers;
  options.layer_mm = object.layer_mm.value_or(spacing_mm);
  options.plane = object.plane == "xy"   ? points::Plane::xy
                  : object.plane == "xz" ? points::Plane::xz
                                         : points::Plane::yz;
  options.seed = static_cast<std::uint64_t>(object.seed);
  if (object.tone)
    options.tone = points::ToneCurve{object.gamma, false, object.tone_lowest, object.tone_highest};
  return options;
}

PlacedModel placed_bitmap(const model::Bitmap& bitmap, const Object& object, double spacing_mm,
                          const Volume& volume) {
  PlacedModel result;
  result.kind = InputKind::bitmap;
  result.what = fmt::format("{} x {} pixels", bitmap.width, bitmap.height);
  PointCloud cloud = points::bitmap_points(bitmap, bitmap_options(object, spacing_mm));
  const Point middle = volume.middle();
  result.model =
      placed(std::move(cloud), geometry::moved(middle.x, middle.y, middle.z), object, volume);
  return result;
}

PlacedModel placed_points(PointCloud cloud, const Object& object, const Volume& volume) {
  PlacedModel result;
  result.what = fmt::format("{} points", cloud.size());
  result.model = placed(std::move(cloud), {}, object, volume);
  return result;
}

}  // namespace

Bounds PlacedModel::box() const {
  return std::visit([](const auto& one) { return box_of(one); }, model);
}

PlacedModel placed_model(const Object& object, double spacing_mm, const Volume& volume) {
  model::Input input = model::read_input(object.file);
  if (auto* mesh = std::get_if<model::Mesh>(&input))
    return placed_mesh(std::move(*mesh), object, volume);
  if (auto* curves = std::get_if<model::Curves>(&input))
    return placed_curves(std::move(*curves), object, volume);
  if (const auto* bitmap = std::get_if<model::Bitmap>(&input))
    return placed_bitmap(*bitmap, object, spacing_mm, volume);
  return placed_points(std::move(std::get<PointCloud>(input)), object, volume);
}

std::string size_text(const Bounds& box) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", box.high.x - box.low.x, box.high.y - box.low.y,
                     box.high.z - box.low.z);
}

}  // namespace lamplock::run
