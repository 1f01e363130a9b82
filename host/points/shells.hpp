// Nested shells against cracks, and depth compensation for even light. In: a cloud. Out: the same
// cloud with points moved inwards, or thinned. Called by the command line after the discretisers.
//
// Neighbouring defects on one shell join to a crack along it. So each point is moved by whole steps
// inwards to the shell on which its nearest neighbour is furthest away and the distance to all
// points placed before is sufficient.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

struct ShellOptions {
  int shells = 3;            // 1..255, the outermost is the surface
  double shell_mm = 0.1;     // from shell to shell
  double distance_mm = 0.1;  // no two points are closer afterwards
};

struct Shells {
  geometry::PointCloud points;
  std::vector<std::uint8_t> shell;  // of each point, 0 outermost
  std::size_t removed = 0;          // points that fitted on no shell
};

/// The inward unit vector for every point of a cloud on the surface of `mesh`: opposite to the
/// normal of its nearest triangle (within `reach_mm`; -z for a point further from all). Throws
/// Error (bad_input) if `reach_mm` is not positive.
std::vector<geometry::Point> inward_ways(const model::Mesh& mesh,
                                         std::span<const geometry::Point> cloud, double reach_mm);

/// Moves each point along its vector of `inward`, or along -z if `inward` is empty. Throws Error
/// (bad_input) for options out of range, coordinates that are not finite, or an `inward` of another
/// size than the cloud.
Shells spread_over_shells(std::span<const geometry::Point> cloud,
                          std::span<const geometry::Point> inward, const ShellOptions& options);

/// Deeper defects look weaker; leaving out some of the shallow ones compensates that. The density
/// changes linearly from the entry face to the full depth and is constant below.
struct DepthOptions {
  double entry_z_mm = 0;      // of the face that the beam enters through (from +z)
  double full_depth_mm = 50;  // below that face
  double density_at_face = 0.5;
  double density_at_depth = 1;
  std::uint64_t seed = 1;
};

/// The remaining points, in their order. The choice depends on the seed and the index only. Throws
/// Error (bad_input) for densities outside 0..1 or a depth that is not positive.
geometry::PointCloud compensate_depth(geometry::PointCloud cloud, const DepthOptions& options);

}  // namespace lamplock::points
