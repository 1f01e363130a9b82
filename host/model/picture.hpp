// What the readers of pictures share: limits, grey from colours, orientation, kind of picture.
//
// In:  sizes, colours and the orientation that a file states. Out: a Bitmap, upright.
// Who: png.cpp, jpeg.cpp, bmp.cpp; placed_model.cpp asks whether a picture is a photo.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

/// More than a glass block can show, and few enough for the memory: a decoded picture needs 4 bytes
/// a pixel.
inline constexpr long long max_pixels = 100'000'000;

/// Throws Error(bad_input) for a side below 1 or more than max_pixels.
void require_size(const std::filesystem::path& file, long long width, long long height);

/// Throws Error(bad_input): the file ends too early.
[[noreturn]] void refuse_cut_off(const std::filesystem::path& file);

/// Throws Error(bad_input): a library or a check found damage, which `what` names.
[[noreturn]] void refuse_damaged(const std::filesystem::path& file, const char* what);

/// Pixels of red, green, blue and, with `channels` 4, alpha, to luma and alpha.
Bitmap bitmap_of_colours(std::span<const std::uint8_t> colours, int width, int height,
                         int channels);

/// The orientations of Exif: where the first row and the first column of the file are in the
/// upright picture. "Exif Version 2.32" (CIPA DC-008), 4.6.4, tag 274.
constexpr int upright = 1, max_orientation = 8;

/// The picture upright; any other number than 1 to 8 counts as upright.
Bitmap oriented(Bitmap bitmap, int orientation);

/// True if a threshold loses most of the picture: its visible pixels have many greys, as those of a
/// photo or a gradient, and not a few with soft edges, as those of a drawing or a logo.
bool is_photo(const Bitmap& bitmap);

}  // namespace lamplock::model
