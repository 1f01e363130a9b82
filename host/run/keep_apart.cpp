#include "host/run/keep_apart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/glass/lens.hpp"
#include "host/points/weld.hpp"

namespace lamplock::run {
namespace {

/// Arc lengths are the spacing, chords a little less, and distances on a grid are less by rounding:
/// a weld at the spacing itself thins out every bend by 4 to 7 %, and a box by 38 %.
constexpr double weld_per_spacing = 0.9;

/// A layer distance that is less by rounding only is not less.
bool is_less(double layer_mm, double limit_mm) {
  constexpr double rounding = 1e-9;
  return layer_mm < limit_mm * (1 - rounding);
}

/// A distance that the user stated as a minimum, and what states it.
struct Minimum {
  double distance_mm = 0;
  std::string source{};
};

/// 0 if nothing states one. A spacing below that of the lens is a choice against the lens.
Minimum stated_minimum(const glass::Object& object, double spacing_mm,
                       const glass::GlassChoice& glass) {
  if (object.weld_mm) return {*object.weld_mm, "weld"};
  if (!glass.lens) return {};
  const double lens_mm = glass::lens_named(*glass.lens).spacing_mm;
  if (spacing_mm < lens_mm) return {spacing_mm, "spacing"};
  return {lens_mm, fmt::format("lens {}", *glass.lens)};
}

}  // namespace

PointsApart keep_apart(points::LayeredPoints cloud, double layer_mm, const glass::Object& object,
                       double spacing_mm, const glass::GlassChoice& glass) {
  PointsApart result;
  result.distance_mm = object.weld_mm.value_or(weld_per_spacing * spacing_mm);
  if (cloud.first.size() < 2) {
    points::WeldResult welded = points::weld(std::move(cloud.points), result.distance_mm);
    result.points = std::move(welded.points);
    result.removed = welded.removed;
    return result;
  }
  points::WeldResult welded = points::weld_in_layers(cloud, result.distance_mm);
  result.removed = welded.removed;
  const Minimum minimum = stated_minimum(object, spacing_mm, glass);
  if (is_less(layer_mm, minimum.distance_mm)) {
    welded = points::weld(std::move(welded.points), minimum.distance_mm);
    result.removed += welded.removed;
    result.distance_mm = minimum.distance_mm;
    result.warnings.push_back(fmt::format(
        "layers are {:g} mm apart, but the {} requires {:g} mm between points: {} points of "
        "neighbouring layers are left out; use a layer distance of {:g} mm or more",
        layer_mm, minimum.source, minimum.distance_mm, welded.removed, minimum.distance_mm));
  } else {
    result.distance_mm = std::min(result.distance_mm, layer_mm);
    if (!object.weld_mm && is_less(layer_mm, spacing_mm))
      result.warnings.push_back(fmt::format(
          "layers are {:g} mm apart, closer than the spacing of {:g} mm, and keep all their "
          "points; state a minimum distance with --weld if the glass cracks",
          layer_mm, spacing_mm));
  }
  result.points = std::move(welded.points);
  return result;
}

}  // namespace lamplock::run
