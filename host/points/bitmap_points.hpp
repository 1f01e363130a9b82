// Bitmap to points ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects
// in glass": threshold, inversion, vertex distance, number of layers, layer distance, plane,
// density of points from grey).
//
// In:  grey values and opacity, the frame of the picture in the glass.
// Out: points on a square grid in parallel planes, row by row from the lowest.
// Who: discretise.cpp, after the picture has its place and size.
//
// Each layer has its grid shifted by another part of the spacing, so that the points of layers are
// not columns, which would shadow each other and crack the glass.
//
// Density from grey: the error of each grid point is spread over its neighbours (Floyd and
// Steinberg, "An Adaptive Algorithm for Spatial Greyscale", 1976) with weights and threshold moved
// at random (Ulichney, "Dithering with Blue Noise", 1988), so that points follow the tone
// everywhere, no pattern shows and layers differ.
//
// Transparency: no point is in a pixel with alpha 0; other pixels are composed over the grey that
// gives no points, which is white, or black with `invert`.
#pragma once

#include <cstdint>
#include <optional>

#include "host/model/bitmap.hpp"
#include "host/points/layered_points.hpp"
#include "host/points/picture_frame.hpp"
#include "host/points/tone.hpp"

namespace lamplock::points {

struct BitmapOptions {
  double spacing_mm = 0.1;  // of the points
  int threshold = 128;      // 0..255: pixels darker than this become points
  bool invert = false;      // light pixels become points instead
  int layers = 1;
  double layer_mm = 0.1;  // from layer to layer
  /// Instead of the threshold: the share of grid points that become points. The input of the curve
  /// is the picture's negative, because dark pixels become points; with `invert` the picture
  /// itself.
  std::optional<ToneCurve> tone{};
  std::uint64_t seed = 1;  // of the dither
};

/// The middle layer is in the frame. The value of a grid point is the mean of the visible pixels in
/// its square, or its pixel if that is larger. Throws Error (bad_input) for options out of range or
/// too many points.
LayeredPoints bitmap_points(const model::Bitmap& bitmap, const PictureFrame& frame,
                            const BitmapOptions& options);

}  // namespace lamplock::points
