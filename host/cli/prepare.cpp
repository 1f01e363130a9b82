#include "host/cli/prepare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "host/cli/progress.hpp"
#include "host/error.hpp"
#include "host/model/bitmap.hpp"
#include "host/model/read_mesh.hpp"
#include "host/model/read_points.hpp"
#include "host/model/transform.hpp"
#include "host/points/bitmap_points.hpp"
#include "host/points/bounds_check.hpp"
#include "host/points/rays.hpp"
#include "host/points/slice.hpp"
#include "host/points/weld.hpp"
#include "host/units.hpp"

namespace lamplock::cli {
namespace {

namespace fs = std::filesystem;
using model::InputKind;
using points::Bounds;
using points::Point;
using points::PointCloud;
using settings::Id;

/// Rounding of scaled coordinates; far below a step.
constexpr double rounding_mm = 1e-6;

Bounds widened(const Bounds& box, double by) {
  return {{box.low.x - by, box.low.y - by, box.low.z - by},
          {box.high.x + by, box.high.y + by, box.high.z + by}};
}

void move_by(PointCloud& cloud, const Point& way) {
  for (Point& point : cloud) point = {point.x + way.x, point.y + way.y, point.z + way.z};
}

std::string size_text(const Bounds& box) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", box.high.x - box.low.x, box.high.y - box.low.y,
                     box.high.z - box.low.z);
}

/// The largest size at which a box still fits, relative to its present one.
double fitting_scale(const Bounds& box, const Bounds& room) {
  double scale = std::numeric_limits<double>::infinity();
  const auto axis = [&scale](double side, double space) {
    if (side > 0) scale = std::min(scale, space / side);
  };
  axis(box.high.x - box.low.x, room.high.x - room.low.x);
  axis(box.high.y - box.low.y, room.high.y - room.low.y);
  axis(box.high.z - box.low.z, room.high.z - room.low.z);
  return scale;
}

/// Tells before the work that the object is too large.
void check_size(const fs::path& input, const Bounds& box, const Bounds& room) {
  const double scale = fitting_scale(box, widened(room, rounding_mm));
  if (scale >= 1) return;
  const double size = std::floor(scale * box.longest_side() * 10) / 10;
  throw Error(Exit::bad_input, input.string(),
              fmt::format("is {}, the work space {}", size_text(box), size_text(room)),
              size > 0 ? fmt::format("give --size {:g} or less", size)
                       : "check travel in the machine profile");
}

/// Centred on the origin, in mm.
model::Mesh read_sized_mesh(const fs::path& input, const PointsOptions& options) {
  model::Mesh mesh = model::read_mesh(input);
  if (options.up == "y") mesh = model::y_up_to_z_up(std::move(mesh));
  const double size =
      options.size_mm ? *options.size_mm : points::bounds(mesh.vertices).longest_side();
  return model::centred_and_scaled(std::move(mesh), size);
}

PointCloud mesh_points(const model::Mesh& mesh, const PointsOptions& options) {
  if (options.method == "rays") {
    points::RayOptions rays;
    rays.pitch_mm = options.spacing_mm;
    rays.direction = options.direction == "x"   ? points::Axis::x
                     : options.direction == "y" ? points::Axis::y
                                                : points::Axis::z;
    return points::rays(mesh, rays);
  }
  points::SliceOptions slice;
  slice.layer_mm = options.layer();
  slice.vertex_mm = options.spacing_mm;
  return points::slice(mesh, slice);
}

PointCloud picture_points(const fs::path& input, const PointsOptions& options) {
  points::BitmapOptions bitmap;
  bitmap.size_mm = options.size_mm.value_or(bitmap.size_mm);
  bitmap.spacing_mm = options.spacing_mm;
  bitmap.threshold = options.threshold;
  bitmap.invert = options.invert;
  bitmap.layers = options.layers;
  bitmap.layer_mm = options.layer();
  return points::bitmap_points(model::read_bitmap(input), bitmap);
}

/// Points of a mesh or bitmap, centred on the origin, and how the phase is described.
PointCloud discretise(const fs::path& input, InputKind kind, const PointsOptions& options,
                      const Bounds& work_space, Console& console) {
  if (kind == InputKind::bitmap) return picture_points(input, options);
  const model::Mesh mesh = read_sized_mesh(input, options);
  const Bounds box = points::bounds(mesh.vertices);
  check_size(input, box, work_space);
  console.phase("model", fmt::format("{}: {} triangles, {}", input.string(), mesh.triangles.size(),
                                     size_text(box)));
  return mesh_points(mesh, options);
}

double way_mm(const PointCloud& cloud) {
  double way = 0;
  for (std::size_t i = 1; i < cloud.size(); ++i)
    way += std::hypot(cloud[i].x - cloud[i - 1].x, cloud[i].y - cloud[i - 1].y,
                      cloud[i].z - cloud[i - 1].z);
  return way;
}

void require_points(const PointCloud& cloud, InputKind kind, const fs::path& input) {
  if (!cloud.empty()) return;
  throw Error(Exit::bad_input, input.string(), "gives no points",
              kind == InputKind::bitmap ? "try --threshold or --invert"
                                        : "use a smaller --spacing or a greater --size");
}

}  // namespace

Bounds work_space_mm(const settings::Values& values) {
  std::array<double, 3> low{}, high{};
  for (int axis = 0; axis < std::min(3, values.whole(Id::axes)); ++axis) {
    const std::size_t i = index(axis);
    low[i] = in_units(values, Id::min_corner_x, axis);
    high[i] = low[i] + in_units(values, Id::travel_x, axis);
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

Cloud make_cloud(const fs::path& input, const PointsOptions& options, const Bounds& work_space,
                 Console& console) {
  console.restart_clock();
  Cloud cloud;
  cloud.kind = model::classify(input);
  if (cloud.kind == InputKind::points) {
    cloud.points = model::read_point_list(input);
  } else {
    cloud.points = discretise(input, cloud.kind, options, work_space, console);
    points::WeldResult welded = points::weld(std::move(cloud.points), options.weld());
    cloud.points = std::move(welded.points);
    cloud.welded = welded.removed;
    move_by(cloud.points, work_space.centre());
  }
  require_points(cloud.points, cloud.kind, input);
  points::check_bounds(cloud.points, widened(work_space, rounding_mm), input.string());
  std::string what =
      fmt::format("{} in {}", cloud.points.size(), bounds_text(points::bounds(cloud.points)));
  if (cloud.welded > 0) what += fmt::format(", {} too close left out", cloud.welded);
  console.phase("points", what);
  return cloud;
}

Bounds input_bounds(const fs::path& input, const PointsOptions& options, const Bounds& work_space) {
  const InputKind kind = model::classify(input);
  PointCloud cloud = kind == InputKind::mesh     ? read_sized_mesh(input, options).vertices
                     : kind == InputKind::bitmap ? picture_points(input, options)
                                                 : model::read_point_list(input);
  require_points(cloud, kind, input);
  if (kind == InputKind::mesh) check_size(input, points::bounds(cloud), work_space);
  if (kind != InputKind::points) move_by(cloud, work_space.centre());
  points::check_bounds(cloud, widened(work_space, rounding_mm), input.string());
  return points::bounds(cloud);
}

void order_cloud(PointCloud& cloud, order::Ordering ordering, double layer_mm, Console& console) {
  console.restart_clock();
  if (ordering == order::Ordering::given)
    return console.phase("order", fmt::format("as given, {:.1f} mm of way", way_mm(cloud)));
  const double before = way_mm(cloud);
  {
    Progress progress("ordering", cloud.size());
    order::OrderOptions options;
    options.layer_mm = layer_mm;
    const auto total = static_cast<double>(cloud.size());
    options.progress = [&progress, total](double part) {
      if (part < 1) progress.update(static_cast<std::size_t>(part * total));
    };
    cloud = order::order(std::move(cloud), ordering, options);
  }
  console.phase("order",
                fmt::format("by layers, {:.1f} mm of way (before: {:.1f})", way_mm(cloud), before));
}

std::string bounds_text(const Bounds& b) {
  return fmt::format("x {:.4g}..{:.4g}, y {:.4g}..{:.4g}, z {:.4g}..{:.4g} mm", b.low.x, b.high.x,
                     b.low.y, b.high.y, b.low.z, b.high.z);
}

Json bounds_json(const Bounds& b) {
  return {{"low_mm", {b.low.x, b.low.y, b.low.z}}, {"high_mm", {b.high.x, b.high.y, b.high.z}}};
}

std::string kind_name(InputKind kind) {
  switch (kind) {
    case InputKind::mesh:
      return "mesh";
    case InputKind::bitmap:
      return "bitmap";
    case InputKind::points:
      return "points";
    case InputKind::curves:
      return "curves";
  }
  return "unknown";
}

}  // namespace lamplock::cli
