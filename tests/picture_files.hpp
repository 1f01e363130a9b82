// Writes small pictures with all that readers have to know: depths, palettes, transparency, Exif,
// CMYK. Without a library, so that readers and writers do not share their mistakes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "shared/wire/crc32.hpp"

namespace lamplock::test {

/// The lowest bytes of a number, highest first.
inline std::string big_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i));
  return text;
}

inline std::uint32_t png_crc(std::string_view bytes) {
  return wire::crc32({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// A chunk of a PNG.
inline std::string png_chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size()), 4) + type + data +
         big_endian(png_crc(type + data), 4);
}

/// zlib without compression: blocks of at most 65535 bytes.
inline std::string stored_zlib(const std::string& bytes) {
  constexpr std::size_t block = 65'535;
  std::string packed = "\x78\x01";
  std::uint32_t a = 1, b = 0;
  for (const char byte : bytes) {
    a = (a + static_cast<std::uint8_t>(byte)) % 65'521;
    b = (b + a) % 65'521;
  }
  for (std::size_t at = 0; at < bytes.size(); at += block) {
    const std::size_t length = std::min(block, bytes.size() - at);
    packed += at + length == bytes.size() ? '\1' : '\0';
    packed += static_cast<char>(length & 0xff);
    packed += static_cast<char>(length >> 8);
    packed += static_cast<char>(~length & 0xff);
    packed += static_cast<char>(~length >> 8 & 0xff);
    packed += bytes.substr(at, length);
  }
  return packed + big_endian(b << 16 | a, 4);
}

/// Colour types of PNG.
enum class PngType { grey = 0, rgb = 2, palette = 3, grey_alpha = 4, rgb_alpha = 6 };

/// A row of samples as PNG stores it: filter 0, then the samples packed.
inline std::string png_row(int depth, const std::vector<std::uint32_t>& samples) {
  std::string row(1, '\0');
  std::uint32_t bits = 0;
  int filled = 0;
  for (const std::uint32_t sample : samples) {
    bits = bits << depth | sample;
    filled += depth;
    for (; filled >= 8; filled -= 8) row += static_cast<char>(bits >> (filled - 8));
  }
  if (filled > 0) row += static_cast<char>(bits << (8 - filled));
  return row;
}

/// All rows one after the other, or those of the seven passes of Adam7.
enum class PngInterlace { none = 0, adam7 = 1 };

/// The pixels of a pass: every `step` from `first`.
struct PngPass {
  int first_x, first_y, step_x, step_y;
};

/// The rows of a picture in the order of the file.
inline std::string png_rows(int width, int height, int depth,
                            const std::vector<std::uint32_t>& samples, PngInterlace interlace) {
  // "Portable Network Graphics", second edition, 8.2.
  static constexpr std::array<PngPass, 7> adam7{{{0, 0, 8, 8},
                                                 {4, 0, 8, 8},
                                                 {0, 4, 4, 8},
                                                 {2, 0, 4, 4},
                                                 {0, 2, 2, 4},
                                                 {1, 0, 2, 2},
                                                 {0, 1, 1, 2}}};
  const std::vector<PngPass> passes = interlace == PngInterlace::none
                                          ? std::vector<PngPass>{{0, 0, 1, 1}}
                                          : std::vector<PngPass>(adam7.begin(), adam7.end());
  const std::size_t per_pixel = samples.size() / static_cast<std::size_t>(width * height);
  std::string rows;
  for (const PngPass& pass : passes) {
    for (int y = pass.first_y; y < height && pass.first_x < width; y += pass.step_y) {
      std::vector<std::uint32_t> row;
      for (int x = pass.first_x; x < width; x += pass.step_x)
        for (std::size_t i = 0; i < per_pixel; ++i)
          row.push_back(samples[static_cast<std::size_t>(y * width + x) * per_pixel + i]);
      rows += png_row(depth, row);
    }
  }
  return rows;
}

/// A PNG. `samples`: row by row from the top, each with the samples of its pixels; `chunks` follow
/// the header, as PLTE, tRNS and eXIf do.
inline std::string png_file(int width, int height, int depth, PngType type,
                            const std::vector<std::uint32_t>& samples,
                            const std::string& chunks = "",
                            PngInterlace interlace = PngInterlace::none) {
  std::string header = big_endian(static_cast<std::uint32_t>(width), 4) +
                       big_endian(static_cast<std::uint32_t>(height), 4);
  header += static_cast<char>(depth);
  header += static_cast<char>(type);
  header += std::string(2, '\0');
  header += static_cast<char>(interlace);
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + chunks +
         png_chunk("IDAT", stored_zlib(png_rows(width, height, depth, samples, interlace))) +
         png_chunk("IEND", "");
}

/// A block of Exif with an orientation, in either byte order.
inline std::string exif_block(int orientation, bool big = true) {
  const auto number = [big](std::uint32_t value, int bytes) {
    std::string text = big_endian(value, bytes);
    if (!big) std::reverse(text.begin(), text.end());
    return text;
  };
  const auto entry = [&](std::uint32_t tag, std::uint32_t value) {
    return number(tag, 2) + number(3, 2) + number(1, 4) + number(value, 2) + number(0, 2);
  };
  return (big ? "MM" : "II") + number(42, 2) + number(8, 4) + number(2, 2) + entry(256, 7) +
         entry(274, static_cast<std::uint32_t>(orientation)) + number(0, 4);
}

/// A segment of a JPEG.
inline std::string jpeg_segment(int marker, const std::string& data) {
  return '\xFF' + std::string(1, static_cast<char>(marker)) +
         big_endian(static_cast<std::uint32_t>(data.size() + 2), 2) + data;
}
inline std::string jpeg_exif(int orientation, bool big = true) {
  return jpeg_segment(0xE1, std::string("Exif\0\0", 6) + exif_block(orientation, big));
}
inline std::string jpeg_adobe(int transform) {
  return jpeg_segment(
      0xEE, std::string("Adobe\0\x64\0\0\0\0", 11) + std::string(1, static_cast<char>(transform)));
}

/// Bits of the entropy-coded part of a JPEG, in which 0 follows 0xFF.
class JpegBits {
 public:
  void put(std::uint32_t value, int count) {
    for (int i = count - 1; i >= 0; --i) {
      bits_ = bits_ << 1 | (value >> i & 1);
      if (++filled_ < 8) continue;
      bytes_ += static_cast<char>(bits_);
      if ((bits_ & 0xff) == 0xff) bytes_ += '\0';
      bits_ = 0;
      filled_ = 0;
    }
  }
  std::string bytes() {
    if (filled_ > 0) put(0x7f, 8 - filled_);
    return bytes_;
  }

 private:
  std::string bytes_;
  std::uint32_t bits_ = 0;
  int filled_ = 0;
};

/// A baseline JPEG of blocks of 8 x 8 equal pixels. `values`: block by block, row by row, each with
/// its components, 0..255; `segments` follow the start.
inline std::string jpeg_of_blocks(int columns, int rows, int components,
                                  const std::vector<int>& values,
                                  const std::string& segments = "") {
  constexpr int code_bits = 4;  // of the 12 lengths of a mean
  std::string frame("\x08", 1), scan(1, static_cast<char>(components));
  frame += big_endian(static_cast<std::uint32_t>(rows * 8), 2) +
           big_endian(static_cast<std::uint32_t>(columns * 8), 2) + static_cast<char>(components);
  for (int c = 1; c <= components; ++c) {
    frame += std::string{static_cast<char>(c), '\x11', '\0'};
    scan += std::string{static_cast<char>(c), '\0'};
  }
  std::string means(1, '\0'), rest(1, '\x10');
  for (int length = 1; length <= 16; ++length) {
    means += static_cast<char>(length == code_bits ? 12 : 0);
    rest += static_cast<char>(length == 1 ? 1 : 0);
  }
  for (char length = 0; length < 12; ++length) means += length;
  rest += '\0';  // end of block: the code 0
  JpegBits bits;
  std::vector<int> last(static_cast<std::size_t>(components), 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    int& before = last[i % last.size()];
    const int mean = (values[i] - 128) * 8, step = mean - before;
    before = mean;
    int length = 0;
    while (std::abs(step) >> length != 0) ++length;
    bits.put(static_cast<std::uint32_t>(length), code_bits);
    bits.put(static_cast<std::uint32_t>(step < 0 ? step + (1 << length) - 1 : step), length);
    bits.put(0, 1);
  }
  return "\xFF\xD8" + segments + jpeg_segment(0xDB, std::string(1, '\0') + std::string(64, '\1')) +
         jpeg_segment(0xC0, frame) + jpeg_segment(0xC4, means) + jpeg_segment(0xC4, rest) +
         jpeg_segment(0xDA, scan + std::string("\0\x3F\0", 3)) + bits.bytes() + "\xFF\xD9";
}

}  // namespace lamplock::test
