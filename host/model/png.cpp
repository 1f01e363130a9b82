#include "host/model/png.hpp"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <new>
#include <string_view>
#include <vector>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/exif.hpp"
#include "host/model/picture.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

constexpr std::string_view png_signature("\x89PNG\r\n\x1a\n", 8);

std::uint32_t big_u32(std::string_view bytes, std::size_t offset) {
  return load<std::uint32_t>(bytes.data() + offset, std::endian::big);
}

/// A chunk: length, type, data, CRC of type and data.
struct PngChunk {
  static constexpr std::size_t before_data = 8, around_data = 12;
  std::string_view whole, type, data;
};

/// The chunk at an offset, checked.
PngChunk chunk_at(const path& file, std::string_view bytes, std::size_t at) {
  const std::string_view rest = bytes.substr(at);
  if (rest.size() < PngChunk::around_data) refuse_cut_off(file);
  const std::size_t length = big_u32(rest, 0);
  if (length > rest.size() - PngChunk::around_data) refuse_cut_off(file);
  PngChunk chunk{rest.substr(0, PngChunk::around_data + length), rest.substr(4, 4),
                 rest.substr(PngChunk::before_data, length)};
  const std::string_view sum_of = rest.substr(4, 4 + length);
  const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(sum_of.data()), sum_of.size());
  if (sum != big_u32(rest, PngChunk::before_data + length))
    refuse_damaged(file, fmt::format("wrong checksum of the chunk at byte {}", at).c_str());
  return chunk;
}

/// The chunks of one type that define colours.
struct ColourChunks {
  std::size_t count = 0;
  std::size_t bytes = 0;  ///< of the last
  std::size_t at = 0;     ///< of the last in the file
};

/// A checked file.
struct PngParts {
  std::string image{};  ///< the file with only the chunks that the colours need
  std::size_t packed_bytes = 0;
  std::size_t pixels_at = 0;  ///< the first chunk of pixels in the file
  ColourChunks palette{}, transparency{};
  int orientation = upright;
  unsigned type = 0;  ///< of colours, from the header
};

void note(ColourChunks& chunks, const PngChunk& chunk, std::size_t at) {
  chunks = {chunks.count + 1, chunk.data.size(), at};
}

PngParts checked_parts(const path& file, std::string_view bytes) {
  PngParts parts;
  parts.image.reserve(bytes.size());
  parts.image = png_signature;
  for (std::size_t at = png_signature.size();;) {
    const PngChunk chunk = chunk_at(file, bytes, at);
    if (chunk.type == "PLTE") note(parts.palette, chunk, at);
    if (chunk.type == "tRNS") note(parts.transparency, chunk, at);
    if (chunk.type == "IDAT" && parts.pixels_at == 0) parts.pixels_at = at;
    at += chunk.whole.size();
    // Chunks with lower case are ancillary. Without them the library has no profile or gamma to
    // apply and no text to unpack.
    const bool is_critical = (static_cast<unsigned char>(chunk.type[0]) & 0x20U) == 0;
    if (is_critical || chunk.type == "tRNS") parts.image += chunk.whole;
    if (chunk.type == "IDAT") parts.packed_bytes += chunk.data.size();
    if (chunk.type == "eXIf") parts.orientation = exif_orientation(chunk.data);
    if (chunk.type != "IEND") continue;
    if (at == bytes.size()) return parts;
    refuse_damaged(file, fmt::format("{} bytes after its end", bytes.size() - at).c_str());
  }
}

// Colour types of the header.
constexpr unsigned grey_type = 0, rgb_type = 2, palette_type = 3;

/// Refuses palettes and transparencies that do not fit the pixels: the library ignores or cuts off
/// what it cannot use, which changes colours.
void check_colours(const path& file, const PngParts& parts, unsigned type, unsigned depth) {
  const ColourChunks &palette = parts.palette, &transparency = parts.transparency;
  constexpr std::size_t entry_bytes = 3;
  const std::size_t colours =
      std::min(palette.bytes / entry_bytes, std::size_t{1} << std::min(depth, 8U));
  if (type == palette_type) {
    if (palette.count == 0) refuse_damaged(file, "it has no palette");
    if (palette.count > 1) refuse_damaged(file, "it has more than one palette");
    if (palette.bytes == 0 || palette.bytes % entry_bytes != 0)
      refuse_damaged(file, fmt::format("its palette has {}, not 3 for each colour",
                                       count_text(palette.bytes, "byte"))
                               .c_str());
    if (parts.pixels_at < palette.at) refuse_damaged(file, "its palette follows the pixels");
  }
  const bool is_used = type == grey_type || type == rgb_type || type == palette_type;
  if (!is_used || transparency.count == 0) return;
  if (transparency.count > 1) refuse_damaged(file, "it has more than one list of transparencies");
  if (parts.pixels_at < transparency.at)
    refuse_damaged(file, "its transparencies follow the pixels");
  if (type == palette_type && transparency.at < palette.at)
    refuse_damaged(file, "its transparencies come before the palette");
  if (type == palette_type && transparency.bytes > colours)
    refuse_damaged(file,
                   fmt::format("{} for a palette of {}",
                               count_text(transparency.bytes, "transparency", "transparencies"),
                               count_text(colours, "colour"))
                       .c_str());
  constexpr std::size_t grey_bytes = 2, rgb_bytes = 6;
  if (type != palette_type && transparency.bytes != (type == grey_type ? grey_bytes : rgb_bytes))
    refuse_damaged(
        file, fmt::format("its transparent colour has {}", count_text(transparency.bytes, "byte"))
                  .c_str());
}

/// Refuses a header whose size the rest of the file cannot fill, before memory is reserved for it.
void check_png_header(const path& file, PngParts& parts) {
  constexpr std::size_t ihdr_bytes = 13, chunk = png_signature.size();
  const std::string_view image = parts.image;
  if (image.size() < chunk + PngChunk::around_data + ihdr_bytes ||
      image.substr(chunk + 4, 4) != "IHDR")
    refuse_damaged(file, "no header");
  const std::string_view header = image.substr(chunk + PngChunk::before_data, ihdr_bytes);
  const std::uint64_t width = big_u32(header, 0), height = big_u32(header, 4);
  require_size(file, static_cast<long long>(width), static_cast<long long>(height));
  // Samples of a pixel by colour type.
  constexpr std::array<std::uint64_t, 7> samples{1, 0, 3, 1, 2, 0, 4};
  const auto depth = static_cast<unsigned char>(header[8]);
  const auto type = static_cast<unsigned char>(header[9]);
  if (type >= samples.size() || samples[type] == 0) refuse_damaged(file, "unknown colour type");
  parts.type = type;
  check_colours(file, parts, type, depth);
  constexpr std::uint64_t max_ratio = 1032;  // of deflate: 258 bytes from 2 bits
  const std::uint64_t row_bytes = (width * samples[type] * depth + 7) / 8;
  if (row_bytes * height > max_ratio * parts.packed_bytes) refuse_cut_off(file);
}

/// The library's reader of one file. The interface of a whole picture in one call (png_image) is
/// not used: libpng 1.6 reads interlaced rows of 16 bits wrongly through it.
struct PngReader {
  explicit PngReader(std::string_view bytes) : rest(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, stop, ignore_warning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) {
      png_destroy_read_struct(&png, &info, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, this, take);
    png_set_benign_errors(png, 1);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  /// Called by the library: it must not return, and it must not throw through the library.
  [[noreturn]] static void stop(png_structp png, png_const_charp message) {
    auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(reader->message.data(), reader->message.size(), "%s", message);
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp /*png*/, png_const_charp /*message*/) {}
  static void take(png_structp png, png_bytep to, png_size_t size) {
    auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (size > reader->rest.size()) png_error(png, "it ends too early");
    std::copy_n(reader->rest.data(), size, reinterpret_cast<char*>(to));
    reader->rest.remove_prefix(size);
  }

  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string_view rest;            ///< bytes that the library has not read
  std::array<char, 120> message{};  ///< of the last error
  png_colorp palette = nullptr;     ///< owned by the library, like the next ones
  png_bytep opacities = nullptr;    ///< of the first colours of the palette
  int colours = 0, opacity_count = 0;
};

/// Reads the header and sets what the rows will be: numbers of a palette with 8 bits each, or RGBA
/// with 8 bits. False on an error. The library leaves this function by longjmp, so that it has no
/// local object.
bool read_header(PngReader& reader, bool of_palette) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_info(reader.png, reader.info);
  if (of_palette) {
    png_get_PLTE(reader.png, reader.info, &reader.palette, &reader.colours);
    png_get_tRNS(reader.png, reader.info, &reader.opacities, &reader.opacity_count, nullptr);
    png_set_packing(reader.png);
  } else {
    png_set_expand(reader.png);  // fewer than 8 bits, and a transparent colour to alpha
    png_set_scale_16(reader.png);
    png_set_gray_to_rgb(reader.png);
    png_set_add_alpha(reader.png, opaque, PNG_FILLER_AFTER);
  }
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

/// Reads all rows. False on an error; no local object, as in read_header().
bool read_rows(PngReader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  return true;
}

/// The samples of the whole picture, as read_header() has set them.
std::vector<std::uint8_t> read_samples(const path& file, PngReader& reader,
                                       std::size_t pixel_bytes) {
  const std::size_t height = png_get_image_height(reader.png, reader.info);
  const std::size_t row = png_get_rowbytes(reader.png, reader.info);
  if (row != png_get_image_width(reader.png, reader.info) * pixel_bytes)
    refuse_damaged(file, "unknown samples");
  std::vector<std::uint8_t> samples(height * row);
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = samples.data() + y * row;
  if (!read_rows(reader, rows.data())) refuse_damaged(file, reader.message.data());
  return samples;
}

constexpr std::size_t rgba = 4;

/// The colours of pixels with a palette, RGBA. Colours that the palette does not have are refused.
std::vector<std::uint8_t> palette_colours(const path& file, PngReader& reader, std::size_t width) {
  const std::vector<std::uint8_t> numbers = read_samples(file, reader, 1);
  std::vector<std::uint8_t> colours(numbers.size() * rgba);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const int number = numbers[i];
    if (number >= reader.colours)
      refuse_damaged(
          file,
          fmt::format("pixel {}, {} has colour {} of a palette of {}", i % width + 1, i / width + 1,
                      number + 1, count_text(static_cast<std::size_t>(reader.colours), "colour"))
              .c_str());
    const png_color& colour = reader.palette[number];
    const std::uint8_t opacity =
        number < reader.opacity_count ? reader.opacities[number] : std::uint8_t{opaque};
    const std::array<std::uint8_t, rgba> pixel{colour.red, colour.green, colour.blue, opacity};
    std::ranges::copy(pixel, colours.data() + i * rgba);
  }
  return colours;
}

}  // namespace

bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG"); }

Bitmap decode_png(const path& file, const std::string& bytes) {
  if (bytes.size() < png_signature.size()) refuse_cut_off(file);
  if (!bytes.starts_with(png_signature)) refuse_damaged(file, "wrong signature");
  PngParts parts = checked_parts(file, bytes);
  check_png_header(file, parts);
  const bool of_palette = parts.type == palette_type;
  PngReader reader(parts.image);
  if (!read_header(reader, of_palette)) refuse_damaged(file, reader.message.data());
  const std::size_t width = png_get_image_width(reader.png, reader.info);
  const std::size_t height = png_get_image_height(reader.png, reader.info);
  const std::vector<std::uint8_t> colours =
      of_palette ? palette_colours(file, reader, width) : read_samples(file, reader, rgba);
  return oriented(
      bitmap_of_colours(colours, static_cast<int>(width), static_cast<int>(height), rgba),
      parts.orientation);
}

}  // namespace lamplock::model
