#include "host/model/gzip.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <limits>
#include <new>

#include "host/file.hpp"

namespace lamplock::model {
namespace {

/// A state of zlib that reads gzip; freed with the object.
class Inflater {
 public:
  Inflater() {
    constexpr int gzip_header = 16;
    if (inflateInit2(&stream_, gzip_header + MAX_WBITS) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  z_stream& stream() { return stream_; }

 private:
  z_stream stream_{};
};

[[noreturn]] void refuse_gzip(const std::filesystem::path& file) {
  refuse(file, "the compressed drawing is cut off or damaged", "export it again as SVG");
}

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1F\x8B\x08"); }

std::string gunzip(const std::filesystem::path& file, const std::string& bytes) {
  constexpr std::size_t step = 1u << 18;
  if (bytes.size() > std::numeric_limits<uInt>::max()) refuse_gzip(file);
  Inflater inflater;
  z_stream& stream = inflater.stream();
  // zlib does not change the input; its interface has no const.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string text;
  while (true) {
    const std::size_t before = text.size();
    text.resize(before + step);
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + before);
    stream.avail_out = static_cast<uInt>(step);
    const int state = inflate(&stream, Z_NO_FLUSH);
    text.resize(before + step - stream.avail_out);
    if (text.size() > max_gunzip_bytes)
      refuse(file, fmt::format("the drawing unpacks to more than {} MB", max_gunzip_bytes >> 20),
             "divide the drawing");
    if (state == Z_STREAM_END && stream.avail_in == 0) return text;
    const bool has_next_member = state == Z_STREAM_END && inflateReset(&stream) == Z_OK;
    if (state != Z_OK && !has_next_member) refuse_gzip(file);
  }
}

}  // namespace lamplock::model
