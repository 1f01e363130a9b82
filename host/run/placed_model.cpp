#include "host/run/placed_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/transformation.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/picture.hpp"
#include "host/model/transform.hpp"
#include "host/number_text.hpp"
#include "host/run/file_ways.hpp"

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

/// Half of the thickness of the layers, along x, y and z.
Point half_thickness(const points::PictureFrame& frame, double thickness_mm) {
  const double half = thickness_mm / 2;
  return {half * std::abs(frame.normal.x), half * std::abs(frame.normal.y),
          half * std::abs(frame.normal.z)};
}

Bounds box_of(const PlacedPicture& picture) {
  Bounds box = geometry::bounds(points::corners(picture.frame));
  const Point half = half_thickness(picture.frame, picture.thickness_mm);
  box.low = {box.low.x - half.x, box.low.y - half.y, box.low.z - half.z};
  box.high = {box.high.x + half.x, box.high.y + half.y, box.high.z + half.z};
  return box;
}

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
                       const Volume& volume, const std::string& file) {
  const double size = size_mm.value_or(box.max_side());
  if (!(box.max_side() > 0))
    throw Error(Exit::bad_input, file, "has no extent: all its points are in one place",
                "draw something longer, or give a list of points");
  const Point middle = volume.middle();
  return geometry::moved(middle.x, middle.y, middle.z) * model::centring_and_scaling(box, size);
}

/// The number of digits that shows which side of a box is longer than that of another.
int telling_digits(const Bounds& box, const Bounds& room) {
  constexpr int usual = 4, max_digits = 9;
  const auto shows = [](double side, double limit, int digits) {
    return side > limit && number_text(side, digits) != number_text(limit, digits);
  };
  int digits = usual;
  for (; digits < max_digits; ++digits)
    if (shows(box.high.x - box.low.x, room.high.x - room.low.x, digits) ||
        shows(box.high.y - box.low.y, room.high.y - room.low.y, digits) ||
        shows(box.high.z - box.low.z, room.high.z - room.low.z, digits))
      break;
  return digits;
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
  const int digits = telling_digits(box, volume.room());
  throw Error(Exit::bad_input, object.file,
              fmt::format("is {}, the {} {}", size_text(box, digits),
                          volume.block ? "block has room for" : "work space",
                          size_text(volume.room(), digits)),
              remedy);
}

/// In the middle of the block, and from there as the object says.
template <class Model>
Model fitted(Model model, const Object& object, const Volume& volume) {
  const Affine first = into_the_middle(box_of(model), object.size_mm, volume, object.file);
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
        fmt::format("the picture {} cannot be read: the surface that it covers is white", picture));
  for (std::string& warning : model::warnings(model::find_faults(mesh)))
    result.warnings.push_back(std::move(warning));
  // The reader has turned a GLB, whose y axis always points up.
  if (object.up == "y" && lower_extension(object.file) != ".glb")
    mesh = model::y_up_to_z_up(std::move(mesh));
  mesh = fitted(std::move(mesh), object, volume);
  result.what = count_text(mesh.triangles.size(), "triangle");
  result.model = std::move(mesh);
  return result;
}

PlacedModel placed_curves(model::Curves curves, const Object& object, const Volume& volume) {
  PlacedModel result;
  result.kind = InputKind::curves;
  result.warnings = curves.warnings;
  if (const std::string rest = model::left_out_text(curves); !rest.empty())
    result.warnings.push_back(fmt::format("left out: {}", rest));
  if (curves.paths.empty() && curves.points.empty())
    throw Error(Exit::bad_input, object.file, "has no curves",
                "draw lines, arcs or splines; convert text to paths");
  curves = fitted(std::move(curves), object, volume);
  result.what = count_text(curves.paths.size(), "curve");
  result.model = std::move(curves);
  return result;
}

points::Plane plane_of(const Object& object) {
  return object.plane == "xy"   ? points::Plane::xy
         : object.plane == "xz" ? points::Plane::xz
                                : points::Plane::yz;
}

/// The frame of a picture in the middle of the block, and from there as the object says. Points are
/// put into the frame later, so that every way to one size gives the same points.
points::PictureFrame placed_frame(const PlacedPicture& picture, const Object& object,
                                  const Volume& volume) {
  const auto box_under = [&picture](const Affine& map) {
    return geometry::bounds(points::corners(points::transformed(picture.frame, map)));
  };
  const auto margin_under = [&picture](const Affine& map) {
    return half_thickness(points::transformed(picture.frame, map), picture.thickness_mm);
  };
  const Point middle = volume.middle();
  const Affine map =
      glass::placement(geometry::moved(middle.x, middle.y, middle.z), object.transform, volume,
                       box_under, object.file, margin_under);
  return points::transformed(picture.frame, map);
}

PlacedModel placed_bitmap(model::Bitmap bitmap, const Object& object, double layer_mm,
                          const Volume& volume) {
  constexpr double default_size_mm = 50;  // as the table of parameters says
  PlacedModel result;
  result.kind = InputKind::bitmap;
  result.what = fmt::format("{} x {} pixels", bitmap.width, bitmap.height);
  if (!object.tone && model::is_photo(bitmap))
    result.warnings.emplace_back(
        "the picture has many greys, as photos have, and each pixel becomes a point or none; turn "
        "on tone, which makes densities of points from greys");
  PlacedPicture picture;
  picture.frame =
      points::picture_frame(bitmap, object.size_mm.value_or(default_size_mm), plane_of(object));
  picture.bitmap = std::move(bitmap);
  picture.thickness_mm = (object.layers - 1) * layer_mm;
  picture.frame = placed_frame(picture, object, volume);
  result.model = std::move(picture);
  return result;
}

PlacedModel placed_points(PointCloud cloud, const Object& object, const Volume& volume) {
  PlacedModel result;
  result.what = count_text(cloud.size(), "point");
  result.model = placed(std::move(cloud), {}, object, volume);
  return result;
}

}  // namespace

Bounds PlacedModel::box() const {
  return std::visit([](const auto& one) { return box_of(one); }, model);
}

PlacedModel placed_model(const Object& object, double layer_mm, const Volume& volume) {
  refuse_finished(object.file);
  model::Input input = model::read_input(object.file);
  if (auto* mesh = std::get_if<model::Mesh>(&input))
    return placed_mesh(std::move(*mesh), object, volume);
  if (auto* curves = std::get_if<model::Curves>(&input))
    return placed_curves(std::move(*curves), object, volume);
  if (auto* bitmap = std::get_if<model::Bitmap>(&input))
    return placed_bitmap(std::move(*bitmap), object, layer_mm, volume);
  return placed_points(std::move(std::get<PointCloud>(input)), object, volume);
}

std::string size_text(const Bounds& box, int digits) {
  return fmt::format("{} x {} x {} mm", number_text(box.high.x - box.low.x, digits),
                     number_text(box.high.y - box.low.y, digits),
                     number_text(box.high.z - box.low.z, digits));
}

}  // namespace lamplock::run
