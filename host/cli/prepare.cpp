#include "host/cli/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "host/cli/console.hpp"
#include "host/cli/discretise.hpp"
#include "host/cli/ordering.hpp"
#include "host/glass/lens.hpp"
#include "host/glass/unused.hpp"
#include "host/points/weld.hpp"
#include "host/units.hpp"

namespace lamplock::cli {
namespace {

using model::InputKind;
using points::Bounds;
using points::PointCloud;
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
    for (const std::string& warning : made.warnings)
      cloud_.warnings.push_back(fmt::format("{}: {}", file, warning));
    cloud_.welded += made.welded;
    cloud_.rejected += made.rejected;
    if (made.kind == InputKind::points) {
      append(lists_, std::move(made.points));
      return;
    }
    cloud_.only_lists = false;
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
      fmt::format("at least {:.4g} mm, on average {:.4g} mm", spacing.smallest_mm, spacing.mean_mm);
  if (spacing.duplicates > 0)
    text += fmt::format(", {} at the place of another", spacing.duplicates);
  return text;
}

/// Duplicates are told of and engraved; so is what is closer than the lens can tell apart.
void judge_spacing(Cloud& cloud, const glass::GlassChoice& glass, Console& console) {
  cloud.spacing = points::spacing_of(cloud.points);
  const points::SpacingReport& spacing = cloud.spacing;
  if (cloud.points.size() < 2) return;
  console.phase("spacing", spacing_text(spacing));
  if (spacing.duplicates > 0)
    cloud.warnings.push_back(
        fmt::format("{} points lie exactly where another one does, the first "
                    "are points {} and {}",
                    spacing.duplicates, spacing.first, spacing.second));
  if (!glass.lens) return;
  const double wanted = glass::lens_named(*glass.lens).spacing_mm;
  constexpr double rounding = 1e-9;
  if (spacing.duplicates == 0 && spacing.smallest_mm < wanted * (1 - rounding))
    cloud.warnings.push_back(
        fmt::format("points {} and {} are {:.4g} mm apart, the lens wants {:g}", spacing.first,
                    spacing.second, spacing.smallest_mm, wanted));
}

/// A margin that is smaller than what glass wants.
void judge_margin(Cloud& cloud, const glass::Volume& volume) {
  if (!volume.block || volume.block->margin_mm >= glass::default_margin_mm) return;
  cloud.warnings.push_back(fmt::format("a margin of {:g} mm may crack the block, {:g} mm are usual",
                                       volume.block->margin_mm, glass::default_margin_mm));
}

/// Lists stay in their order unless somebody wants another.
std::string order_name(const Cloud& cloud, const glass::OrderChoice& choice) {
  return choice.name.value_or(cloud.only_lists ? "given" : default_order);
}

}  // namespace

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
                 Console& console) {
  Merger merger;
  for (const glass::Object& object : description.objects)
    merger.add(object_points(object, description.glass, volume, console), object.file,
               description.objects.size() == 1);
  Cloud cloud = merger.finish();
  judge_spacing(cloud, description.glass, console);
  judge_margin(cloud, volume);
  for (std::string& warning : glass::unused(description, order_name(cloud, description.order)))
    cloud.warnings.push_back(std::move(warning));
  for (const std::string& warning : cloud.warnings) console.say("warning  {}", warning);
  return cloud;
}

Bounds input_bounds(const glass::Description& description, const glass::Volume& volume) {
  PointCloud corners;
  for (const glass::Object& object : description.objects) {
    const Bounds box = object_bounds(object, description.glass, volume);
    corners.push_back(box.low);
    corners.push_back(box.high);
  }
  return points::bounds(corners);
}

void order_cloud(Cloud& cloud, const glass::Description& description,
                 const settings::Values& values, const glass::Volume& volume, Console& console) {
  const glass::OrderChoice& choice = description.order;
  const auto layer_mm = cloud.only_lists ? std::nullopt : std::optional(cloud.layer_mm);
  order_points(cloud.points, order_name(cloud, choice),
               order_options(choice, layer_mm, motion_of(values, volume.refraction)), console);
}

Json spacing_json(const points::SpacingReport& spacing) {
  return {{"smallest_mm", spacing.smallest_mm},
          {"mean_mm", spacing.mean_mm},
          {"largest_mm", spacing.largest_mm},
          {"duplicates", spacing.duplicates}};
}

}  // namespace lamplock::cli
