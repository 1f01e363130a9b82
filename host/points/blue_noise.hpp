// Blue noise on a surface: points as random as a spacing allows, so that no rows show in the glass
// and no two defects are close enough to crack it. In: a mesh in mm. Out: points on its surface,
// none closer to another than the distance, no place of the surface much further from one. Called
// by the command line; needs no weld().
//
// Darts (Cook, "Stochastic Sampling in Computer Graphics", 1986) are thrown at the surface, with
// equal density for any triangles, and become points where no point is nearer than the distance.
// The gaps are filled by pieces of triangles that no single point covers: a dart at each, then
// smaller pieces (Cline, Jeschke, White, Razdan and Wonka, "Dart Throwing on Surfaces", 2009).
// Blocks of space are processed in parallel in eight groups, in each of which no block touches
// another (Wei, "Parallel Poisson Disk Sampling", 2008); each block has its own random numbers, so
// the result is the same for any number of threads.
//
// Budget: a million points in 5 s on two cores; memory linear in points and triangles, below 1 GB.
#pragma once

#include <cstdint>
#include <optional>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"
#include "host/points/tone.hpp"

namespace lamplock::points {

struct BlueNoiseOptions {
  double distance_mm = 0.1;  // Euclidean; no two points are closer
  std::uint64_t seed = 1;
  unsigned threads = 0;  // 0: as many as the processor has
  /// Density by brightness, for meshes that have it: the distance is distance_mm divided by the
  /// root of the density.
  std::optional<ToneCurve> tone{};
};

/// About 0.7 * area / distance^2 points. Without a tone every place of the surface is closer than
/// 1.04 distances to a point. Flat triangles get no points. Throws Error (bad_input) for a distance
/// that is not positive, a vertex that is not finite, too many points, or a mesh larger than
/// sixteen million distances.
geometry::PointCloud blue_noise(const model::Mesh& mesh, const BlueNoiseOptions& options);

}  // namespace lamplock::points
