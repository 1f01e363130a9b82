// Small text of the machine: integers and millimetres into a fixed buffer, no formatting library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lamplock {

/// A line being written; text that does not fit is cut (lines are shorter than the buffer by
/// design).
class TextLine {
 public:
  /// Characters: a status report of four axes with all its fields.
  static constexpr std::size_t capacity = 352;

  TextLine& add(std::string_view text) {
    for (const char c : text) put(c);
    return *this;
  }
  TextLine& add(std::int64_t value) {
    if (value < 0) put('-');
    return digits(static_cast<std::uint64_t>(value < 0 ? -value : value), 1);
  }
  /// A number in thousandths, with three decimals.
  TextLine& add_milli(std::int64_t milli) {
    if (milli < 0) put('-');
    const auto magnitude = static_cast<std::uint64_t>(milli < 0 ? -milli : milli);
    digits(magnitude / 1000, 1);
    put('.');
    return digits(magnitude % 1000, 3);
  }
  std::string_view view() const { return {buffer_.data(), size_}; }

 private:
  void put(char c) {
    if (size_ < buffer_.size()) buffer_[size_++] = c;
  }
  TextLine& digits(std::uint64_t value, std::size_t least) {
    std::array<char, 20> reversed{};
    std::size_t n = 0;
    while (value != 0 || n < least) {
      reversed[n++] = static_cast<char>('0' + value % 10);
      value /= 10;
    }
    while (n > 0) put(reversed[--n]);
    return *this;
  }

  std::array<char, capacity> buffer_{};
  std::size_t size_ = 0;
};

}  // namespace lamplock
