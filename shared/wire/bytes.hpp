// Converts numbers to bytes and back, little endian, byte by byte: no struct is ever overlaid on a
// buffer.
//
// Both ends use these for every payload. Neither exceeds its buffer: a writer that is full and a
// reader that is empty store the error, so that one check at the end is enough.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace lamplock::wire {

/// Appends numbers to a buffer.
class ByteWriter {
 public:
  explicit constexpr ByteWriter(std::span<std::uint8_t> out) : out_(out) {}

  /// Appends a number with the size of its type; nothing if it does not fit whole.
  template <std::integral T>
  constexpr void put(T value) {
    if (out_.size() - size_ < sizeof(T)) {
      ok_ = false;
      return;
    }
    auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8)
      out_[size_++] = static_cast<std::uint8_t>(bits & 0xff);
  }
  constexpr void put_bytes(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) put(byte);
  }

  constexpr bool ok() const { return ok_; }  ///< everything fitted
  constexpr std::size_t size() const { return size_; }
  constexpr std::size_t room() const { return out_.size() - size_; }
  constexpr std::span<const std::uint8_t> written() const { return out_.first(size_); }

 private:
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
  bool ok_ = true;
};

/// Reads numbers from a buffer.
class ByteReader {
 public:
  explicit constexpr ByteReader(std::span<const std::uint8_t> in) : in_(in) {}

  /// Reads a number; 0 if there are too few bytes left.
  template <std::integral T>
  constexpr T take() {
    if (left() < sizeof(T)) {
      ok_ = false;
      at_ = in_.size();
      return T{};
    }
    std::make_unsigned_t<T> value{};
    for (std::size_t i = 0; i < sizeof(T); ++i)
      value = static_cast<std::make_unsigned_t<T>>(
          value | static_cast<std::make_unsigned_t<T>>(
                      static_cast<std::make_unsigned_t<T>>(in_[at_++]) << (8 * i)));
    return static_cast<T>(value);
  }
  /// All bytes not read yet.
  constexpr std::span<const std::uint8_t> rest() const { return in_.subspan(at_); }
  constexpr std::size_t left() const { return in_.size() - at_; }
  constexpr bool ok() const { return ok_; }  ///< no read exceeded the buffer
  /// All reads succeeded and no byte is left.
  constexpr bool exhausted() const { return ok_ && left() == 0; }

 private:
  std::span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace lamplock::wire
