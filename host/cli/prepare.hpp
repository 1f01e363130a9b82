// From a file to points in firing order: what `points`, `order`, `job`, `engrave` and `frame`
// share.
//
// In:  a mesh, bitmap or point list; options; the machine's work space. Out: points in mm.
// Meshes and bitmaps are put into the middle of the work space, point lists never moved.
#pragma once

#include <cstddef>
#include <filesystem>

#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/model/input.hpp"
#include "host/points/bounds.hpp"
#include "host/points/point.hpp"

namespace lamplock::cli {

/// Points of an input.
struct Cloud {
  points::PointCloud points;
  model::InputKind kind = model::InputKind::points;
  std::size_t welded = 0;  ///< left out because too close to another
};

/// The work space of a machine, mm.
points::Bounds work_space_mm(const settings::Values& values);

/// Reads the input and makes points of it, all inside the work space. Throws Error(bad_input).
Cloud make_cloud(const std::filesystem::path& input, const PointsOptions& options,
                 const points::Bounds& work_space, Console& console);

/// The box round what would be engraved, inside the work space. Throws Error(bad_input).
points::Bounds input_bounds(const std::filesystem::path& input, const PointsOptions& options,
                            const points::Bounds& work_space);

/// Brings points into the order of firing.
void order_cloud(points::PointCloud& cloud, order::Ordering ordering, double layer_mm,
                 Console& console);

/// "x -10..10, y -5..5, z 0..20 mm".
std::string bounds_text(const points::Bounds& bounds);
Json bounds_json(const points::Bounds& bounds);
std::string kind_name(model::InputKind kind);

}  // namespace lamplock::cli
