// A bitmap: grey values and opacity of a picture, upright.
//
// In:  the readers of pictures. Out: the grey of a pixel over a background.
// Who: the discretiser of pictures, rows of pixels, textures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lamplock::model {

inline constexpr std::uint8_t black = 0, white = 255, opaque = 255;

/// Row by row from the top left.
struct Bitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;     ///< 0 black, 255 white; without a background
  std::vector<std::uint8_t> alpha{};  ///< 0 invisible, 255 opaque; empty: all pixels are opaque

  /// False for a pixel that is fully transparent.
  bool is_visible(std::size_t pixel) const { return alpha.empty() || alpha[pixel] != 0; }

  /// The grey of a pixel over an even background.
  std::uint8_t grey_over(std::size_t pixel, std::uint8_t background) const {
    if (alpha.empty()) return grey[pixel];
    const int share = alpha[pixel];
    return static_cast<std::uint8_t>(
        (grey[pixel] * share + background * (opaque - share) + opaque / 2) / opaque);
  }
};

/// The same picture without transparency, over an even background.
inline Bitmap flattened(Bitmap bitmap, std::uint8_t background) {
  for (std::size_t i = 0; i < bitmap.grey.size(); ++i)
    bitmap.grey[i] = bitmap.grey_over(i, background);
  bitmap.alpha.clear();
  return bitmap;
}

}  // namespace lamplock::model
