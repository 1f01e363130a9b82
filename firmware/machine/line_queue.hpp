// Lines of the host that wait for their turn.
//
// In:  whole lines, in order, from the link. Out: the same, one at a time.
// Who: the controller, main loop. What the host is told of its room is the truth: a line takes its
//      characters and one for its end, as on the wire, until it is taken out. There is more than is
//      told: a host that has filled its window still has to be heard, for what it sends then are
//      real-time bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace lamplock::machine {

class LineQueue {
 public:
  /// Bytes that a sender may have under way.
  static constexpr std::uint32_t window = 1024;
  /// All there is: a longest line more.
  static constexpr std::uint32_t capacity = window + 256;

  bool empty() const { return size_ == 0; }
  std::uint32_t free() const { return capacity - size_; }

  /// How many lines there are.
  std::uint32_t lines() const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < size_; ++i) {
      const std::uint32_t at = begin_ + i;
      if (bytes_[at < capacity ? at : at - capacity] == end_of_line) ++count;
    }
    return count;
  }
  /// The first character of the oldest line; there is one. A blank line begins with its end.
  char front() const { return bytes_[begin_]; }
  /// False if it does not fit.
  bool push(std::string_view line) {
    if (line.size() + 1 > free()) return false;
    for (const char c : line) put(c);
    put(end_of_line);
    return true;
  }

  /// Takes the oldest line; there is one. `room` holds the longest there can be.
  std::string_view pop(std::span<char> room) {
    std::size_t size = 0;
    for (char c = take(); c != end_of_line; c = take()) room[size++] = c;
    return {room.data(), size};
  }

  void clear() { size_ = 0; }

 private:
  static constexpr char end_of_line = '\n';

  void put(char c) {
    const std::uint32_t end = begin_ + size_++;
    bytes_[end < capacity ? end : end - capacity] = c;
  }
  char take() {
    const char c = bytes_[begin_];
    begin_ = begin_ + 1 < capacity ? begin_ + 1 : 0;
    --size_;
    return c;
  }

  std::array<char, capacity> bytes_{};
  std::uint32_t begin_ = 0, size_ = 0;
};

}  // namespace lamplock::machine
