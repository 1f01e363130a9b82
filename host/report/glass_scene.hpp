// The scene of the picture: a block of glass on a lit plinth in a dark room, by ray casting.
//
// In:  the block, the camera. Out: light of every pixel without the cloud. Who: picture.cpp.
// The numbers are a matter of taste, not of physics; light is linear, 1 = white.
#pragma once

#include "host/report/camera.hpp"
#include "host/report/image.hpp"

namespace lamplock::report {

/// The plinth for a block.
Box plinth_under(const Box& block);

/// Paints block, plinth, floor and background.
void paint_glass_scene(Image& image, const Box& block, const Camera& camera, unsigned threads);

}  // namespace lamplock::report
