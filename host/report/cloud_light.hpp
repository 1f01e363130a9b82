// The light of the engraved points: sprites added up, exposed, with a little bloom.
//
// In:  points, the block they stand in, the camera. Out: light to add to the scene. Who:
// picture.cpp.
#pragma once

#include <vector>

#include "host/report/camera.hpp"
#include "host/report/image.hpp"

namespace lamplock::report {

/// Light of the cloud alone, exposed so that its bright parts come near 1.
Image cloud_light(const std::vector<Vec>& points, const Box& block, const Camera& camera, int width,
                  int height);

}  // namespace lamplock::report
