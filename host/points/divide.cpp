#include "host/points/divide.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/model/arc_length.hpp"
#include "host/points/spread.hpp"

namespace lamplock::points {
namespace {

void check(const DivideOptions& options) {
  geometry::require_positive(options.spacing_mm, "divide", "spacing");
  if (options.layers < 1) {
    throw Error(Exit::bad_input, "divide", fmt::format("{} layers", options.layers),
                "give 1 or more");
  }
  if (options.layers > 1) geometry::require_positive(options.layer_mm, "divide", "layer distance");
  if (!std::isfinite(options.twist_mm)) {
    throw Error(Exit::bad_input, "divide", fmt::format("the twist is {}", options.twist_mm),
                "give a number of mm");
  }
}

/// Appends layer k at the drawing's own z.
void append_layer(const model::Curves& curves, std::vector<model::ArcLength>& along, int k,
                  const DivideOptions& options, geometry::PointCloud& cloud) {
  for (std::size_t path = 0; path < curves.paths.size(); ++path) {
    const SpreadOptions wanted{options.spacing_mm, curves.paths[path].closed, k * options.twist_mm,
                               options.end_points};
    const Spread spread = spread_along(along[path].total(), wanted, cloud.size(), "divide");
    for (std::size_t i = 0; i < spread.count; ++i) {
      cloud.push_back(
          along[path].at(spread.first_mm + static_cast<double>(i) * spread.distance_mm));
    }
  }
  geometry::require_count(static_cast<double>(cloud.size() + curves.points.size()), "divide");
  cloud.insert(cloud.end(), curves.points.begin(), curves.points.end());
}

}  // namespace

geometry::PointCloud divide(const model::Curves& curves, const DivideOptions& options) {
  check(options);
  std::vector<model::ArcLength> along;
  along.reserve(curves.paths.size());
  for (const model::Path& path : curves.paths) along.emplace_back(path);
  geometry::PointCloud cloud;
  append_layer(curves, along, 0, options, cloud);
  const std::size_t layer = cloud.size();
  geometry::require_count(static_cast<double>(layer) * options.layers, "divide");
  cloud.reserve(layer * static_cast<std::size_t>(options.layers));
  for (int k = 1; k < options.layers; ++k) {
    if (options.twist_mm == 0) {  // all layers are equal
      for (std::size_t i = 0; i < layer; ++i) cloud.push_back(geometry::Point(cloud[i]));
    } else {
      append_layer(curves, along, k, options, cloud);
    }
  }
  if (options.layers == 1 || layer == 0) return cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t k = i / layer;  // twist does not change counts
    const double half = (options.layers - 1) / 2.0;
    cloud[i].z += (static_cast<double>(k) - half) * options.layer_mm;
  }
  return cloud;
}

}  // namespace lamplock::points
