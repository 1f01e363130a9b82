#include "host/run/discretise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include "host/error.hpp"
#include "host/glass/lens.hpp"
#include "host/glass/unused_parameters.hpp"
#include "host/points/bitmap_points.hpp"
#include "host/points/bounds_check.hpp"
#include "host/points/divide.hpp"
#include "host/points/layered_points.hpp"
#include "host/points/shells.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/frontend.hpp"
#include "host/run/keep_apart.hpp"
#include "host/run/mesh_points.hpp"
#include "host/run/no_points.hpp"
#include "host/run/placed_model.hpp"
#include "host/run/size_hints.hpp"

namespace lamplock::run {
namespace {

using geometry::Bounds;
using geometry::Point;
using geometry::PointCloud;
using glass::Object;
using glass::Volume;
using model::InputKind;

constexpr double default_spacing_mm = 0.1;
/// Rounding of scaled coordinates; far below a step.
constexpr double rounding_mm = 1e-6;
/// Refuses points that the machine cannot reach, or outside the block less its margin.
void check_place(const PointCloud& cloud, const Volume& volume, const std::string& file) {
  points::check_bounds(cloud, volume.reach, file);
  if (volume.block)
    points::check_bounds(cloud, volume.block->inside(), file,
                         fmt::format("the block less {:g} mm of margin", volume.block->margin_mm));
}

/// How the file becomes points, as the table of parameters names it.
std::string way_of(InputKind kind, const Object& object) {
  switch (kind) {
    case InputKind::mesh:
      return object.method.value_or(glass::default_method);
    case InputKind::curves:
      return glass::way_of_drawings;
    case InputKind::bitmap:
      return glass::way_of_bitmaps;
    case InputKind::points:
      break;
  }
  return glass::way_of_lists;
}

PointCloud curve_points(const model::Curves& curves, const Object& object, double spacing) {
  points::DivideOptions options;
  options.spacing_mm = spacing;
  options.end_points = object.end_points.value_or(options.end_points);
  options.layers = object.layers;
  options.layer_mm = object.layer_mm.value_or(spacing);
  options.twist_mm = object.twist_mm;
  return points::divide(curves, options);
}

points::BitmapOptions bitmap_options(const Object& object, double spacing) {
  points::BitmapOptions options;
  options.spacing_mm = spacing;
  options.threshold = object.threshold;
  options.invert = object.invert;
  options.layers = object.layers;
  options.layer_mm = object.layer_mm.value_or(spacing);
  options.seed = static_cast<std::uint64_t>(object.seed);
  if (object.tone)
    options.tone = points::ToneCurve{object.gamma, false, object.tone_lowest, object.tone_highest};
  return options;
}

/// Layers of a drawing are apart only if the drawing is flat: others reach into each other, and are
/// one layer.
std::vector<std::size_t> first_of_layers(const PointCloud& cloud, int layers) {
  const std::size_t size = cloud.size() / static_cast<std::size_t>(layers);  // all are equal
  if (size == 0) return {0};
  const Bounds box = geometry::bounds(std::span(cloud).first(size));
  if (box.high.z - box.low.z > rounding_mm) return {0};
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < cloud.size(); i += size) first.push_back(i);
  return first;
}

/// Points before they are kept apart.
struct RawPoints {
  points::LayeredPoints cloud{};
  double layer_mm = 0;
  bool keeps_spacing = false;  ///< the method itself keeps them apart
};

/// Points by the method of the model.
RawPoints make_points(PlacedModel& model, const Object& object, double spacing,
                      ObjectPoints& made) {
  RawPoints raw;
  raw.layer_mm = object.layer_mm.value_or(spacing);
  if (auto* mesh = std::get_if<model::Mesh>(&model.model)) {
    MeshPoints result = mesh_points(*mesh, object, spacing);
    made.rejected = result.rejected;
    made.empty_share = result.empty_share;
    for (std::string& warning : result.warnings) made.warnings.push_back(std::move(warning));
    raw.cloud = {std::move(result.points), std::move(result.first_of_layers)};
    raw.keeps_spacing = result.keeps_spacing;
  } else if (auto* curves = std::get_if<model::Curves>(&model.model)) {
    raw.cloud.points = curve_points(*curves, object, spacing);
    raw.cloud.first = first_of_layers(raw.cloud.points, object.layers);
  } else if (const auto* picture = std::get_if<PlacedPicture>(&model.model)) {
    raw.cloud =
        points::bitmap_points(picture->bitmap, picture->frame, bitmap_options(object, spacing));
  } else {
    raw.cloud.points = std::move(std::get<PointCloud>(model.model));
  }
  return raw;
}

void spread_over_shells(const PlacedModel& model, const Object& object, double spacing,
                        ObjectPoints& made) {
  if (object.shells == 1) return;
  if (object.method == "solid")
    throw Error(Exit::bad_input, object.file,
                "--shells needs points on a surface, and --method solid fills the inside",
                "remove --shells, or use another --method");
  std::vector<Point> inward;
  if (const auto* mesh = std::get_if<model::Mesh>(&model.model))
    inward = points::inward_ways(*mesh, made.points, spacing);
  points::ShellOptions options;
  options.shells = object.shells;
  options.shell_mm = object.shell_mm.value_or(spacing);
  options.distance_mm = made.distance_mm > 0 ? made.distance_mm : spacing;
  points::Shells shells = points::spread_over_shells(made.points, inward, options);
  made.points = std::move(shells.points);
  made.welded += shells.removed;
}

void compensate_depth(const Object& object, const Volume& volume, ObjectPoints& made) {
  if (object.face_density == 1 && object.depth_density == 1) return;
  const Bounds glass = volume.block ? volume.block->outside() : volume.reach;
  points::DepthOptions options;
  options.entry_z_mm = glass.high.z;
  options.full_depth_mm = glass.high.z - glass.low.z;
  options.density_at_face = object.face_density;
  options.density_at_depth = object.depth_density;
  options.seed = static_cast<std::uint64_t>(object.seed);
  made.points = points::compensate_depth(std::move(made.points), options);
}

/// What makes defects of points: apart from each other, on shells, thinned by depth.
void finish(const PlacedModel& model, const Object& object, RawPoints raw, double spacing,
            const glass::GlassChoice& glass, const Volume& volume, ObjectPoints& made) {
  if (raw.keeps_spacing && object.weld_mm.value_or(0) <= spacing) {
    made.distance_mm = spacing;
    made.points = std::move(raw.cloud.points);
  } else {
    PointsApart apart = keep_apart(std::move(raw.cloud), raw.layer_mm, object, spacing, glass);
    made.points = std::move(apart.points);
    made.distance_mm = apart.distance_mm;
    made.welded += apart.removed;
    for (std::string& warning : apart.warnings) made.warnings.push_back(std::move(warning));
  }
  spread_over_shells(model, object, spacing, made);
  compensate_depth(object, volume, made);
}

/// All that is engraved of a model, checked. Throws Error(bad_input).
ObjectPoints checked_points(PlacedModel& model, const Object& object, double spacing,
                            const glass::GlassChoice& glass, const Volume& volume) {
  ObjectPoints made;
  made.kind = model.kind;
  made.way = way_of(model.kind, object);
  const std::string& way = made.way;
  made.layer_mm = glass::uses(way, "layer") ? object.layer_mm.value_or(spacing) : spacing;
  made.warnings = std::move(model.warnings);
  for (std::string& warning : glass::unused(object, way))
    made.warnings.push_back(std::move(warning));
  RawPoints raw = make_points(model, object, spacing, made);
  if (raw.cloud.points.empty()) refuse_without_points(model, object, spacing);
  if (made.kind == InputKind::points)
    made.points = std::move(raw.cloud.points);
  else
    finish(model, object, std::move(raw), spacing, glass, volume, made);
  if (made.points.empty()) refuse_thinned_out(object);
  check_place(made.points, volume, object.file);
  return made;
}

std::string result_text(const ObjectPoints& made) {
  const Bounds box = geometry::bounds(made.points);
  std::string what = fmt::format("{} in {}", made.points.size(), bounds_text(box));
  if (made.welded > 0) what += fmt::format(", {} too close left out", made.welded);
  return what;
}

}  // namespace

double spacing_mm(const Object& object, const glass::GlassChoice& glass) {
  if (object.spacing_mm) return *object.spacing_mm;
  return glass.lens ? glass::lens_named(*glass.lens).spacing_mm : default_spacing_mm;
}

ObjectPoints object_points(const Object& object, const glass::GlassChoice& glass,
                           const Volume& volume, Frontend& frontend) {
  frontend.restart_clock();
  const double spacing = spacing_mm(object, glass);
  PlacedModel model = placed_model(object, object.layer_mm.value_or(spacing), volume);
  const Bounds box = model.kind == InputKind::points ? Bounds{} : model.box();
  if (model.kind != InputKind::points)
    frontend.phase("model", fmt::format("{}: {}, {}", object.file, model.what, size_text(box)));
  ObjectPoints made = checked_points(model, object, spacing, glass, volume);
  if (made.kind != InputKind::points) made.spacing_mm = spacing;
  made.hints = size_hints(object, made.kind, box, made.points.size());
  frontend.phase("points", result_text(made));
  return made;
}

Bounds object_bounds(const Object& object, const glass::GlassChoice& glass, const Volume& volume) {
  const double spacing = spacing_mm(object, glass);
  PlacedModel model = placed_model(object, object.layer_mm.value_or(spacing), volume);
  if (model.kind != InputKind::mesh)
    return geometry::bounds(checked_points(model, object, spacing, glass, volume).points);
  const Bounds box = model.box();
  check_place({box.low, box.high}, volume, object.file);
  return box;
}

}  // namespace lamplock::run
