// A picture of an engraved cloud in a block of optical glass, lit from below.
//
// In:  points in mm, z up; 1 to some millions of them. Out: a PNG file.
// Who: write_report(), the command line. About a second for a million points on one core.
//
// Points are soft sprites of light, added in floating point; the exposure depends on the resulting
// brightness and suits few and many points. Size and brightness fall with distance.
#pragma once

#include <filesystem>

#include "host/geometry/point.hpp"

namespace lamplock::report {

/// Size of the picture in pixels.
struct PictureSize {
  int width = 1200;
  int height = 1200;
};

/// Writes the picture; flat clouds are seen more from above and from the front. An empty cloud
/// gives an empty block. Points that are not finite are left out. Throws lamplock::Error if the
/// file cannot be written.
void write_cloud_picture(const std::filesystem::path& path, const geometry::PointCloud& cloud,
                         const PictureSize& size = {});

/// The same with points that were not fired, in grey, in the same block.
void write_cloud_picture(const std::filesystem::path& path, const geometry::PointCloud& fired,
                         const geometry::PointCloud& not_fired, const PictureSize& size = {});

/// The same with points that an earlier run has fired, in a shade of their own.
void write_cloud_picture(const std::filesystem::path& path, const geometry::PointCloud& fired,
                         const geometry::PointCloud& not_fired,
                         const geometry::PointCloud& fired_before, const PictureSize& size = {});

}  // namespace lamplock::report
