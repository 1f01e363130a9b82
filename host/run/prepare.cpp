#include "host/run/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host/glass/lens.hpp"
#include "host/glass/unused_parameters.hpp"
#include "host/number_text.hpp"
#include "host/points/weld.hpp"
#include "host/run/discretise.hpp"
#include "host/run/frontend.hpp"
#include "host/run/ordering.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using geometry::Bounds;
using geometry::PointCloud;
using model::InputKind;
using settings::Id;

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

/// Objects one after the other, as they become one cloud.
class Merger {
 public:
  void add(ObjectPoints made, const std::string& file, bool alone) {
    const std::string kind = kind_name(made.kind);
    cloud_.kind = alone || cloud_.kind == kind || cloud_.kind.empty() ? kind : "several";
    if (std::find(cloud_.ways.begin(), cloud_.ways.end(), made.way) == cloud_.ways.end())
      cloud_.ways.push_back(made.way);
    for (std::string& hint : made.hints)
      if (std::find(cloud_.hints.begin(), cloud_.hints.end(), hint) == cloud_.hints.end())
        cloud_.hints.push_back(std::move(hint));
    for (const std::string& warning : made.warnings)
      cloud_.warnings.push_back(fmt::format("{}: {}", file, warning));
    cloud_.welded += made.welded;
    cloud_.rejected += made.rejected;
    cloud_.empty_share = std::max(cloud_.empty_share, made.empty_share);
    if (made.kind == InputKind::points) {
      append(lists_, std::move(made.points));
      return;
    }
    cloud_.only_lists = false;
    cloud_.spacing_mm = std::min(made.spacing_mm, cloud_.spacing_mm.value_or(made.spacing_mm));
    // An object that is not welded itself is kept apart from the others all the same.
    if (made.distance_mm > 0) distance_mm_ = std::min(distance_mm_, made.distance_mm);
    layer_mm_ = std::min(layer_mm_, made.layer_mm);
    append(cloud_.points, std::move(made.points));
    ++objects_;
  }

  Cloud finish() {
    if (cloud_.only_lists) {
      cloud_.points = std::move(lists_);
      return std::move(cloud_);
    }
    cloud_.layer_mm = layer_mm_;
    if (lists_.empty() && objects_ == 1) return std::move(cloud_);
    const std::size_t given = lists_.size();
    append(lists_, std::move(cloud_.points));
    const double distance_mm = std::isfinite(distance_mm_) ? distance_mm_ : 0;
    points::WeldResult welded = points::weld(std::move(lists_), distance_mm, given);
    cloud_.points = std::move(welded.points);
    cloud_.welded += welded.removed;
    return std::move(cloud_);
  }

 private:
  static void append(PointCloud& cloud, PointCloud more) {
    if (cloud.empty())
      cloud = std::move(more);
    else
      cloud.insert(cloud.end(), more.begin(), more.end());
  }

  Cloud cloud_;
  PointCloud lists_;  ///< engraved exactly as given
  std::size_t objects_ = 0;
  double distance_mm_ = std::numeric_limits<double>::infinity();
  double layer_mm_ = std::numeric_limits<double>::infinity();
};

std::string spacing_text(const points::SpacingReport& spacing) {
  std::string text =
      fmt::format("at least {:.4g} mm, on average {:.4g} mm", spacing.min_mm, spacing.mean_mm);
  if (spacing.duplicates > 0)
    text += fmt::format(", {} at the place of another", spacing.duplicates);
  return text;
}

/// Duplicates, and points closer than the lens resolves, are reported and engraved.
void judge_spacing(Cloud& cloud, const glass::GlassChoice& glass, Frontend& frontend) {
  cloud.spacing = points::spacing_of(cloud.points);
  const points::SpacingReport& spacing = cloud.spacing;
  if (cloud.points.size() < 2) return;
  frontend.phase("spacing", spacing_text(spacing));
  if (spacing.duplicates > 0)
    cloud.warnings.push_back(fmt::format(
        "{} exactly where another one does, the first are points {} and {}",
        count_text(spacing.duplicates, "point lies", "points lie"), spacing.first, spacing.second));
  if (!glass.lens) return;
  const double wanted = glass::lens_named(*glass.lens).spacing_mm;
  constexpr double rounding = 1e-9;
  if (spacing.duplicates == 0 && spacing.min_mm < wanted * (1 - rounding))
    cloud.warnings.push_back(
        fmt::format("points {} and {} are {:.4g} mm apart, the lens needs {:g} mm", spacing.first,
                    spacing.second, spacing.min_mm, wanted));
}

/// Warns of a margin that is too small for glass.
void judge_margin(Cloud& cloud, const glass::Volume& volume) {
  if (!volume.block || volume.block->margin_mm >= glass::default_margin_mm) return;
  cloud.warnings.push_back(fmt::format("a margin of {:g} mm may crack the block, {:g} mm are usual",
                                       volume.block->margin_mm, glass::default_margin_mm));
}

}  // namespace

/// Lists keep their order unless the description names another.
std::string order_name(const Cloud& cloud, const glass::OrderChoice& choice) {
  return choice.name.value_or(cloud.only_lists ? "given" : default_order);
}

Bounds work_space_mm(const settings::Values& values) {
  std::array<double, 3> low{}, high{};
  for (int axis = 0; axis < std::min(3, values.whole(Id::axes)); ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    low[i] = in_units(values, Id::min_corner_x, axis);
    high[i] = low[i] + in_units(values, Id::travel_x, axis);
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

Cloud make_cloud(const glass::Description& description, const glass::Volume& volume,
                 Frontend& frontend) {
  Merger merger;
  for (const glass::Object& object : description.objects)
    merger.add(object_points(object, description.glass, volume, frontend), object.file,
               description.objects.size() == 1);
  Cloud cloud = merger.finish();
  judge_spacing(cloud, description.glass, frontend);
  judge_margin(cloud, volume);
  for (std::string& warning : glass::unused(description, order_name(cloud, description.order)))
    cloud.warnings.push_back(std::move(warning));
  for (const std::string& warning : cloud.warnings) frontend.say("warning  {}", warning);
  return cloud;
}

void show_hints(const Cloud& cloud, Frontend& frontend) {
  for (const std::string& hint : cloud.hints) frontend.notice("warning  " + hint);
}

Bounds input_bounds(const glass::Description& description, const glass::Volume& volume) {
  PointCloud corners;
  for (const glass::Object& object : description.objects) {
    const Bounds box = object_bounds(object, description.glass, volume);
    corners.push_back(box.low);
    corners.push_back(box.high);
  }
  return geometry::bounds(corners);
}

void order_cloud(Cloud& cloud, const glass::Description& description,
                 const settings::Values& values, const glass::Volume& volume, Frontend& frontend) {
  const glass::OrderChoice& choice = description.order;
  const auto layer_mm = cloud.only_lists ? std::nullopt : std::optional(cloud.layer_mm);
  std::vector<std::string> warnings =
      order_points(cloud.points, order_name(cloud, choice),
                   order_options(choice, layer_mm, motion_of(values, volume.refraction)), frontend);
  for (std::string& warning : warnings) cloud.warnings.push_back(std::move(warning));
}

}  // namespace lamplock::run
