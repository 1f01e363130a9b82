#include "host/model/jpeg.hpp"

#include <stb/stb_image.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/exif.hpp"
#include "host/model/picture.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// "Digital compression and coding of continuous-tone still images" (ITU-T T.81), table B.1.
struct JpegMarker {
  static constexpr std::uint8_t prefix = 0xFF, temporary = 0x01;
  static constexpr std::uint8_t baseline = 0xC0, extended = 0xC1, progressive = 0xC2;
  static constexpr std::uint8_t last_frame = 0xCF, first_restart = 0xD0;
  static constexpr std::uint8_t huffman_tables = 0xC4, reserved_frame = 0xC8,
                                arithmetic_tables = 0xCC;
  static constexpr std::uint8_t end_of_image = 0xD9, start_of_scan = 0xDA;
  static constexpr std::uint8_t application_1 = 0xE1, application_14 = 0xEE;

  static bool is_frame(std::uint8_t marker) {
    return marker >= baseline && marker <= last_frame && marker != huffman_tables &&
           marker != reserved_frame && marker != arithmetic_tables;
  }
  /// A marker without a length.
  static bool is_single(std::uint8_t marker) {
    return marker == temporary || (marker >= first_restart && marker < end_of_image);
  }
};

/// What the segments before the first scan state.
struct JpegHeader {
  std::uint8_t frame = 0;  ///< the marker of its kind
  int bits = 0, width = 0, height = 0, components = 0;
  std::optional<int> adobe_transform{};
  int orientation = upright;
  std::size_t scan = 0;  ///< offset of the first scan
};

std::uint8_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

std::uint16_t big_u16(std::string_view bytes, std::size_t at) {
  return load<std::uint16_t>(bytes.data() + at, std::endian::big);
}

void read_jpeg_segment(const path& file, std::uint8_t marker, std::string_view data,
                       JpegHeader& header) {
  constexpr std::string_view exif("Exif\0\0", 6), adobe("Adobe");
  constexpr std::size_t frame_bytes = 6, adobe_bytes = 12, transform_in_adobe = 11;
  if (JpegMarker::is_frame(marker)) {
    if (data.size() < frame_bytes) refuse_damaged(file, "short frame header");
    header.frame = marker;
    header.bits = byte_at(data, 0);
    header.height = big_u16(data, 1);
    header.width = big_u16(data, 3);
    header.components = byte_at(data, 5);
  } else if (marker == JpegMarker::application_1 && data.starts_with(exif)) {
    header.orientation = exif_orientation(data.substr(exif.size()));
  } else if (marker == JpegMarker::application_14 && data.starts_with(adobe) &&
             data.size() >= adobe_bytes) {
    header.adobe_transform = byte_at(data, transform_in_adobe);
  }
}

JpegHeader read_jpeg_header(const path& file, std::string_view bytes) {
  JpegHeader header;
  for (std::size_t at = 2;;) {
    if (at >= bytes.size()) refuse_cut_off(file);
    if (byte_at(bytes, at) != JpegMarker::prefix) refuse_damaged(file, "no marker");
    while (at < bytes.size() && byte_at(bytes, at) == JpegMarker::prefix) ++at;
    if (at >= bytes.size()) refuse_cut_off(file);
    const std::uint8_t marker = byte_at(bytes, at++);
    if (marker == JpegMarker::end_of_image) refuse_damaged(file, "no picture in it");
    if (JpegMarker::is_single(marker)) continue;
    if (at + 2 > bytes.size()) refuse_cut_off(file);
    const std::size_t length = big_u16(bytes, at);
    if (length < 2) refuse_damaged(file, "short segment");
    if (length > bytes.size() - at) refuse_cut_off(file);
    if (marker == JpegMarker::start_of_scan) {
      header.scan = at;
      return header;
    }
    read_jpeg_segment(file, marker, bytes.substr(at + 2, length - 2), header);
    at += length;
  }
}

/// Refuses what the library does not decode, and what it would decode wrongly or without an end.
void check_jpeg_header(const path& file, const JpegHeader& header, std::string_view bytes) {
  if (header.frame == 0) refuse_damaged(file, "no frame header");
  const bool known = header.frame == JpegMarker::baseline || header.frame == JpegMarker::extended ||
                     header.frame == JpegMarker::progressive;
  constexpr int sample_bits = 8;
  if (!known || header.bits != sample_bits)
    refuse(file,
           "is a JPEG with arithmetic coding, without loss or with 12 bits, which is not read",
           "convert it to PNG, or save it as a baseline JPEG");
  require_size(file, header.width, header.height);
  constexpr int grey = 1, colour = 3, cmyk = 4, transform_ycc = 1;
  if (header.components != grey && header.components != colour && header.components != cmyk)
    refuse_damaged(file, "number of components");
  if (header.components == cmyk && header.adobe_transform.value_or(transform_ycc) == transform_ycc)
    refuse(file, "is a JPEG of four colours that does not say which they are", "convert it to RGB");
  // A block of 8 x 8 pixels needs a bit at least, that of its mean.
  constexpr std::uint64_t max_pixels_per_byte = 8 * 64;
  const auto pixels =
      static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height);
  if (pixels > max_pixels_per_byte * bytes.size()) refuse_cut_off(file);
  if (bytes.find("\xFF\xD9", header.scan) == std::string_view::npos) refuse_cut_off(file);
  // Progressive pictures have about ten scans; each takes the time of the whole picture, and an
  // empty one has a few bytes.
  constexpr std::size_t max_scans = 100;
  std::size_t scans = 1;
  for (std::size_t at = header.scan; scans <= max_scans; ++scans) {
    at = bytes.find("\xFF\xDA", at + 1);
    if (at == std::string_view::npos) return;
  }
  refuse_damaged(file, "too many scans");
}

/// The file with all eight Huffman tables empty from its start, so that a scan without its tables
/// fails: the library (stb_image before 2.28) would decode it by memory that has no value.
std::string with_empty_tables(std::string_view bytes) {
  constexpr std::size_t start_of_image = 2, lengths = 16, classes = 2, numbers = 4;
  std::string tables{static_cast<char>(JpegMarker::prefix),
                     static_cast<char>(JpegMarker::huffman_tables), '\0',
                     static_cast<char>(2 + classes * numbers * (1 + lengths))};
  for (std::size_t kind = 0; kind < classes; ++kind)
    for (std::size_t number = 0; number < numbers; ++number)
      tables += static_cast<char>(kind << 4 | number) + std::string(lengths, '\0');
  std::string whole(bytes.substr(0, start_of_image));
  whole += tables;
  whole += bytes.substr(start_of_image);
  return whole;
}

}  // namespace

bool is_jpeg(const std::string& bytes) { return bytes.starts_with("\xFF\xD8"); }

Bitmap decode_jpeg(const path& file, const std::string& bytes) {
  constexpr std::size_t max_bytes = std::numeric_limits<int>::max() / 2;
  if (bytes.size() > max_bytes)
    refuse(file, "the image is too large", "give an image of at most 100 million pixels");
  const JpegHeader header = read_jpeg_header(file, bytes);
  check_jpeg_header(file, header, bytes);
  const std::string decodable = with_empty_tables(bytes);
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(decodable.data()),
                            static_cast<int>(decodable.size()), &width, &height, &channels,
                            STBI_rgb),
      stbi_image_free);
  if (!pixels) refuse_damaged(file, stbi_failure_reason());
  // A second frame header in the file could change the size.
  if (width != header.width || height != header.height) refuse_damaged(file, "two sizes");
  constexpr int rgb = 3;
  const std::span<const std::uint8_t> colours(
      pixels.get(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * rgb);
  return oriented(bitmap_of_colours(colours, width, height, rgb), header.orientation);
}

}  // namespace lamplock::model
