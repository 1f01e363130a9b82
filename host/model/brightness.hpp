// Brightness of a surface: colours of vertices and textures, as far as engraving needs them. In:
// colours and textures from the mesh reader. Out: the brightness at a place of a triangle. Called
// by the discretisers that make bright places denser (points/tone.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

/// A place of a texture: u to the right, v upwards, 0..1 across the picture, repeated outside.
struct TexturePlace {
  float u = 0, v = 0;
};

/// Brightness is luma: 0 black, 1 white. If there is a texture too, both are multiplied. The two
/// lists have one entry per triangle, or are empty if the file has no such data.
struct Brightness {
  static constexpr std::uint32_t no_texture = std::numeric_limits<std::uint32_t>::max();
  struct Textured {
    std::uint32_t texture = no_texture;  // index into textures
    std::array<TexturePlace, 3> corners{};
  };

  std::vector<std::array<float, 3>> corners;  // of each triangle, from colours of vertices
  std::vector<Textured> textured;             // of each triangle
  std::vector<Bitmap> textures;

  /// Brightness at weights `b` of the second and `c` of the third corner of a triangle (the first
  /// has the rest). Linear between corners; of a texture the pixel at the place.
  double at(std::size_t triangle, double b, double c) const;
};

}  // namespace lamplock::model
