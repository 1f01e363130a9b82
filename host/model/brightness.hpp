// Brightness of a surface: colours of vertices and textures, as far as engraving needs them. Comes
// in: what the mesh reader found in the file. Goes out: how bright a place of a triangle is. Called
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

/// Brightness is luma: 0 black, 1 white. Where there is a texture too, both are multiplied. The two
/// lists of triangles have the length of the mesh's, or none if there is nothing of that kind.
struct Brightness {
  static constexpr std::uint32_t no_texture = std::numeric_limits<std::uint32_t>::max();
  struct Textured {
    std::uint32_t texture = no_texture;  // index into textures
    std::array<TexturePlace, 3> corners{};
  };

  std::vector<std::array<float, 3>> corners;  // of each triangle, from colours of vertices
  std::vector<Textured> textured;             // of each triangle
  std::vector<Bitmap> textures;

  /// At weights `b` of the second and `c` of the third corner of a triangle (the first has the
  /// rest). Between corners linear, of a texture the pixel that the place lies in.
  double at(std::size_t triangle, double b, double c) const;
};

}  // namespace lamplock::model
