// The light of the engraved points: a sum of sprites, exposed, with a little bloom.
//
// In:  points, their block, the camera. Out: light to add to the scene. Who: picture.cpp.
#pragma once

#include <vector>

#include "host/report/camera.hpp"
#include "host/report/image.hpp"

namespace lamplock::report {

/// Light of the cloud alone, exposed so that its bright parts are near 1.
Image cloud_light(const std::vector<Vec>& points, const Box& block, const Camera& camera, int width,
                  int height);

/// Adds points that give no light: dots of one colour, whose brightness does not grow with their
/// number.
void add_dots(Image& image, const std::vector<Vec>& points, const Vec& colour,
              const Camera& camera);

}  // namespace lamplock::report
