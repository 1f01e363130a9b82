// Bitmap to points ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects
// in glass": threshold, inversion, vertex distance, number of layers, layer distance). Comes in:
// grey values. Goes out: points on a square grid in planes of constant z, row by row from the
// lowest. Called by the command line.
#pragma once

#include "host/model/bitmap.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

struct BitmapOptions {
  double size_mm = 50;      // longest side of the picture
  double spacing_mm = 0.1;  // of the points
  int threshold = 128;      // 0..255: darker than this is a point
  bool invert = false;      // light pixels become points instead
  int layers = 1;
  double layer_mm = 0.1;  // from layer to layer
};

/// The picture stands upright in the x-y plane: its left is -x, its top is +y, seen from +z.
/// Centred on the origin in all axes. A grid point stands for the mean of the pixels of its square,
/// or for the pixel it lies in if that is larger. Throws Error (bad_input) for options out of range
/// or too many points.
PointCloud bitmap_points(const model::Bitmap& bitmap, const BitmapOptions& options);

}  // namespace lamplock::points
