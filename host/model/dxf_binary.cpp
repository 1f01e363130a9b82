#include "host/model/dxf_binary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <iterator>

#include "host/file.hpp"

namespace lamplock::model {
namespace {

static_assert(std::endian::native == std::endian::little, "values are copied as they are stored");

constexpr std::string_view sentinel("AutoCAD Binary DXF\r\n\x1a\0", 22);

enum class ValueType { text, number, int16, int32, int64, byte, chunk };

/// Group codes from `first` to `last` have values of this type.
struct CodeRange {
  int first, last;
  ValueType type;
};
constexpr std::array<CodeRange, 29> code_ranges{{
    {-5, 9, ValueType::text},       {10, 59, ValueType::number},    {60, 79, ValueType::int16},
    {90, 99, ValueType::int32},     {100, 109, ValueType::text},    {110, 149, ValueType::number},
    {160, 169, ValueType::int64},   {170, 179, ValueType::int16},   {210, 239, ValueType::number},
    {270, 289, ValueType::int16},   {290, 299, ValueType::byte},    {300, 309, ValueType::text},
    {310, 319, ValueType::chunk},   {320, 369, ValueType::text},    {370, 389, ValueType::int16},
    {390, 399, ValueType::text},    {400, 409, ValueType::int16},   {410, 419, ValueType::text},
    {420, 429, ValueType::int32},   {430, 439, ValueType::text},    {440, 459, ValueType::int32},
    {460, 469, ValueType::number},  {470, 481, ValueType::text},    {999, 1003, ValueType::text},
    {1004, 1004, ValueType::chunk}, {1005, 1009, ValueType::text},  {1010, 1059, ValueType::number},
    {1060, 1070, ValueType::int16}, {1071, 1071, ValueType::int32},
}};

class BinaryDxf {
 public:
  BinaryDxf(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), bytes_(bytes), at_(sentinel.size()) {
    // The first group is 0 SECTION. Releases before 13 store its code in one byte.
    has_short_codes_ = bytes.size() > at_ + 1 && bytes[at_ + 1] != '\0';
  }

  std::string text() {
    while (true) {
      const int code = next_code();
      fmt::format_to(std::back_inserter(text_), "{}\n", code);
      const std::size_t value = text_.size();
      append_value(type_of(code));
      const bool is_end = code == 0 && std::string_view(text_).substr(value) == "EOF";
      text_ += '\n';
      if (is_end) return std::move(text_);
    }
  }

 private:
  [[noreturn]] void refuse_here(const std::string& what) const {
    refuse(file_, fmt::format("byte {}: {}", at_, what), "export the drawing again");
  }

  template <class Number>
  Number take() {
    Number value{};
    if (bytes_.size() - at_ < sizeof value) refuse_here("the drawing is cut off: no EOF");
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  int next_code() {
    constexpr int escape = 255;  // a code of two bytes follows
    if (!has_short_codes_) return take<std::int16_t>();
    const int code = take<std::uint8_t>();
    return code == escape ? take<std::int16_t>() : code;
  }

  ValueType type_of(int code) const {
    const auto* const range =
        std::find_if(code_ranges.begin(), code_ranges.end(),
                     [&](const CodeRange& r) { return code >= r.first && code <= r.last; });
    if (range == code_ranges.end()) refuse_here(fmt::format("{} is not a group code", code));
    return range->type;
  }

  template <class Number>
  void append_number() {
    fmt::format_to(std::back_inserter(text_), "{}", take<Number>());
  }

  void append_value(ValueType type) {
    switch (type) {
      case ValueType::text:
        return append_text();
      case ValueType::number:
        return append_number<double>();
      case ValueType::int16:
        return append_number<std::int16_t>();
      case ValueType::int32:
        return append_number<std::int32_t>();
      case ValueType::int64:
        return append_number<std::int64_t>();
      case ValueType::byte:
        return append_number<std::uint8_t>();
      case ValueType::chunk:
        break;
    }
    const std::size_t size = take<std::uint8_t>();
    if (bytes_.size() - at_ < size) refuse_here("the drawing is cut off: no EOF");
    at_ += size;
  }

  /// A text ends with a zero byte. Line ends in it would divide the line.
  void append_text() {
    const std::size_t end = bytes_.find('\0', at_);
    if (end == std::string_view::npos) refuse_here("the drawing is cut off: no EOF");
    for (const char c : bytes_.substr(at_, end - at_)) text_ += c == '\n' || c == '\r' ? ' ' : c;
    at_ = end + 1;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::size_t at_;
  bool has_short_codes_ = false;
  std::string text_;
};

}  // namespace

bool is_binary_dxf(std::string_view bytes) { return bytes.starts_with(sentinel); }

std::string text_of_binary_dxf(const std::filesystem::path& file, std::string_view bytes) {
  return BinaryDxf(file, bytes).text();
}

}  // namespace lamplock::model
