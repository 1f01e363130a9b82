// A picture of an engraved cloud as it would stand in a block of optical glass, lit from below.
//
// In:  points in mm, z up; 1 to some millions of them. Out: a PNG file.
// Who: write_report(), the command line. About a second for a million points on one core.
//
// Points are soft sprites of light added up in floating point; exposure follows the brightness that
// results, so that few and many points both come out well. Size and brightness fall with distance.
#pragma once

#include <filesystem>

#include "host/points/point.hpp"

namespace lamplock::report {

/// Size of the picture in pixels.
struct PictureSize {
  int width = 1200;
  int height = 1200;
};

/// Writes the picture; flat clouds are seen more from above and from the front. An empty cloud
/// gives an empty block. Points that are not finite are left out. Throws lamplock::Error if the
/// file cannot be written.
void write_cloud_picture(const std::filesystem::path& path, const points::PointCloud& cloud,
                         const PictureSize& size = {});

}  // namespace lamplock::report
