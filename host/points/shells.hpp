// Against cracks and for even light: neighbours on nested shells and depth compensation. Comes in:
// a cloud. Goes out: the same cloud with points moved inwards, or thinned. Called by the command
// line behind the discretisers.
//
// Neighbouring defects on one shell join to a crack along it. So each point goes to that shell,
// whole steps inwards, on which its nearest neighbour is furthest away, and which keeps it apart
// from all points placed before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/model/mesh.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

struct ShellOptions {
  int shells = 3;            // 1..255, the outermost is the surface itself
  double shell_mm = 0.1;     // from shell to shell
  double distance_mm = 0.1;  // no two points are closer afterwards
};

struct Shells {
  PointCloud points;
  std::vector<std::uint8_t> shell;  // of each point, 0 outermost
  std::size_t removed = 0;          // points that fitted on no shell
};

/// The way inwards, of length 1, for every point of a cloud on the surface of `mesh`: against the
/// normal of the triangle that is nearest to it (of those not further away than `reach_mm`; -z for
/// a point further from all). Throws Error (bad_input) if `reach_mm` is not positive.
std::vector<Point> inward_ways(const model::Mesh& mesh, std::span<const Point> cloud,
                               double reach_mm);

/// Moves each point along its way of `inward`, or along -z if `inward` is empty. Throws Error
/// (bad_input) for options out of range, coordinates that are not finite, or an `inward` of another
/// size than the cloud.
Shells spread_over_shells(std::span<const Point> cloud, std::span<const Point> inward,
                          const ShellOptions& options);

/// Defects look weaker the more glass is before them; leaving out some of the shallow ones evens
/// that out. Density changes linearly from the entry face to the full depth and not below.
struct DepthOptions {
  double entry_z_mm = 0;      // of the face that the beam enters through (from +z)
  double full_depth_mm = 50;  // under that face
  double density_at_face = 0.5;
  double density_at_depth = 1;
  std::uint64_t seed = 1;
};

/// The points that stay, in their order. Which ones depends on the seed and the index alone. Throws
/// Error (bad_input) for densities outside 0..1 or a depth that is not positive.
PointCloud compensate_depth(PointCloud cloud, const DepthOptions& options);

}  // namespace lamplock::points
