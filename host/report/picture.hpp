// A picture of an engraved cloud as it would stand in a block of optical glass, lit from below.
//
// In:  points in mm, z up; 1 to some millions of them. Out: a PNG file.
// Who: write_report(), the command line. About a second for a million points on one core.
//
// Points are soft sprites of light added up in floating point; exposure follows the brightness that
// results, so that few and many points both come out well. Size and brightness fall with distance.
#pragma once

#include <filesystem>
#include <optional>

#include "host/points/point.hpp"

namespace lamplock::report {

/// How the picture is taken. Lengths in mm, angles in degrees.
struct PictureOptions {
  int width = 1200;
  int height = 1200;
  /// Camera round the block from the front (-y) to the right, and above the horizon; empty: by the
  /// shape of the cloud, flat ones more from above and from the front.
  std::optional<double> yaw_deg, elevation_deg;
  double margin = 0.1;  ///< glass round the cloud, relative to its longest side
  unsigned threads = 2;
};

/// Writes the picture. An empty cloud gives an empty block. Points that are not finite are left
/// out. Throws lamplock::Error if the file cannot be written.
void write_cloud_picture(const std::filesystem::path& path, const points::PointCloud& cloud,
                         const PictureOptions& options = {});

}  // namespace lamplock::report
