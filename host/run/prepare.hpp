// From a description to points in firing order: what `points`, `engrave`, `job` and `frame` share.
//
//   objects (discretise.hpp) -> one cloud, welded -> what spacing it has -> order
//
// In:  a description; the volume that points may be in. Out: points in mm, in
//      coordinates of the glass.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/glass/volume.hpp"
#include "host/model/input.hpp"
#include "host/points/spacing.hpp"
#include "host/run/frontend.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {

/// All points of a job, those of point lists first.
struct Cloud {
  geometry::PointCloud points{};
  std::string kind{};                  ///< of the object; "several" of several kinds
  std::vector<std::string> ways{};     ///< methods of the objects, each once
  std::optional<double> spacing_mm{};  ///< that was asked for, the smallest; none of point lists
  bool only_lists = true;              ///< to be engraved in the order in which they came
  double layer_mm = 0;                 ///< of the objects, the least
  std::size_t welded = 0;              ///< left out because too close to another
  std::size_t rejected = 0;            ///< triangles that a method leaves out
  double empty_share = 0;  ///< of the surface, 0..1, without points near it; of the worst mesh
  points::SpacingReport spacing{};
  std::vector<std::string> warnings{};
  std::vector<std::string> hints{};  ///< questions to the user, each once
};

/// The work space of a machine, mm.
geometry::Bounds work_space_mm(const settings::Values& values);

/// Makes points of all objects, none outside the volume. Points of different objects keep the
/// smallest distance of the objects. Throws Error(bad_input).
Cloud make_cloud(const glass::Description& description, const glass::Volume& volume,
                 Frontend& frontend);

/// The box round what would be engraved. Throws Error(bad_input).
geometry::Bounds input_bounds(const glass::Description& description, const glass::Volume& volume);

/// Name of the order that the description or the kind of the points chooses.
std::string order_name(const Cloud& cloud, const glass::OrderChoice& choice);

/// Shows the questions to the user, once the job is made: an error comes alone.
void show_hints(const Cloud& cloud, Frontend& frontend);

/// Brings points into the order of firing of the description, for a machine with these
/// settings.
void order_cloud(Cloud& cloud, const glass::Description& description,
                 const settings::Values& values, const glass::Volume& volume, Frontend& frontend);

}  // namespace lamplock::run
