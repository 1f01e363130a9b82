// Bytes waiting to be sent; each push is stored whole or not at all.
//
// In:  lines and frames from the link. Out: bytes for the board, as its port accepts them.
// Level: main loop on both sides; no allocation.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lamplock::link {

class TransmitRing {
 public:
  static constexpr std::size_t capacity = 4096;
  static_assert((capacity & (capacity - 1)) == 0, "positions wrap by masking");

  std::size_t size() const { return in_ - out_; }
  std::size_t room() const { return capacity - size(); }

  /// Appends all bytes, or none (false) if they do not fit.
  bool push(std::span<const std::uint8_t> bytes) {
    if (bytes.size() > room()) return false;
    for (const std::uint8_t byte : bytes) bytes_[in_++ % capacity] = byte;
    return true;
  }

  /// Removes up to `out.size()` bytes; returns how many.
  std::size_t pop(std::span<std::uint8_t> out) {
    const std::size_t count = std::min(out.size(), size());
    for (std::size_t i = 0; i < count; ++i) out[i] = bytes_[out_++ % capacity];
    return count;
  }

 private:
  std::array<std::uint8_t, capacity> bytes_{};
  std::size_t in_ = 0;
  std::size_t out_ = 0;
};

}  // namespace lamplock::link
