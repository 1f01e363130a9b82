// The values of a PLY file in order, as text or in either byte order. In: the bytes after the
// header. Out: numbers. Called by the PLY reader (ply.cpp).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

#include "host/bytes.hpp"
#include "host/model/ply.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {

/// The values after the header in order, in any format.
class PlyValues {
 public:
  PlyValues(std::string_view data, PlyFormat format)
      : rest_(data),
        ascii_(format == PlyFormat::ascii),
        line_end_(data.find('\n') == std::string_view::npos ? '\r' : '\n'),
        order_(format == PlyFormat::big_endian ? std::endian::big : std::endian::little) {}

  /// Empty at the end of the data or of the line, or if the text is not a number.
  std::optional<double> next(PlyType type) {
    if (ascii_) return next_in_line();
    const std::size_t size = size_of(type);
    if (rest_.size() < size) return std::nullopt;
    const char* bytes = rest_.data();
    rest_.remove_prefix(size);
    switch (type) {
      case PlyType::int8:
        return load<std::int8_t>(bytes, order_);
      case PlyType::uint8:
        return load<std::uint8_t>(bytes, order_);
      case PlyType::int16:
        return load<std::int16_t>(bytes, order_);
      case PlyType::uint16:
        return load<std::uint16_t>(bytes, order_);
      case PlyType::int32:
        return load<std::int32_t>(bytes, order_);
      case PlyType::uint32:
        return load<std::uint32_t>(bytes, order_);
      case PlyType::float32:
        return load<float>(bytes, order_);
      case PlyType::float64:
        return load<double>(bytes, order_);
    }
    return std::nullopt;
  }

  /// True if the text that was no number has a decimal comma.
  bool failed_at_comma() const { return failed_at_comma_; }

  /// Text: moves to the next line that is not blank. False if numbers are left in this one.
  bool end_element() {
    if (!ascii_) return true;
    skip_blanks();
    if (!rest_.empty() && rest_.front() != line_end_) return false;
    const std::size_t next = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(std::min(next, rest_.size()));
    return true;
  }

 private:
  void skip_blanks() {
    const std::string_view blanks = line_end_ == '\n' ? " \t\r" : " \t";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  }

  std::optional<double> next_in_line() {
    skip_blanks();
    if (rest_.empty() || rest_.front() == line_end_) return std::nullopt;
    const std::string_view field = next_field(rest_);
    const auto number = to_double(field);
    failed_at_comma_ = !number && has_decimal_comma(field);
    return number;
  }

  static std::size_t size_of(PlyType type) {
    switch (type) {
      case PlyType::int8:
      case PlyType::uint8:
        return 1;
      case PlyType::int16:
      case PlyType::uint16:
        return 2;
      case PlyType::int32:
      case PlyType::uint32:
      case PlyType::float32:
        return 4;
      case PlyType::float64:
        break;
    }
    return 8;
  }

  std::string_view rest_;
  bool ascii_;
  char line_end_;  ///< of text; CR only in a text without LF
  bool failed_at_comma_ = false;
  std::endian order_;
};

}  // namespace lamplock::model
