// Lines of the host that wait for their turn.
//
// In:  whole lines, in order, from the link. Out: the same, one at a time.
// Who: the controller, main loop. The room reported to the host is exact: until it is taken out, a
//      line occupies its characters and one for its end, as on the wire. There is room for one line
//      of maximum length more than reported: for the line that is being received.
//
// During a tool change the lines of the program are set aside: they stay where they are, and lines
// of the user use the room after them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace lamplock::machine {

class LineQueue {
 public:
  /// Bytes that a sender may have in flight.
  static constexpr std::uint32_t window = 1024;
  /// Total size: one line of maximum length more.
  static constexpr std::uint32_t capacity = window + 256;

  bool empty() const { return size_ == 0; }
  std::uint32_t free() const { return capacity - size_ - aside_; }

  std::uint32_t lines() const {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < size_; ++i)
      if (at(i) == end_of_line) ++count;
    return count;
  }
  /// A waiting line ends its program: it has an M2 or M30 outside comments.
  [[gnu::cold]] bool ends_program() const;
  /// The first character of the oldest line; the queue must not be empty. A blank line begins with
  /// its end.
  char front() const { return bytes_[begin_]; }
  /// False if it does not fit.
  bool push(std::string_view line) {
    if (line.size() + 1 > free()) return false;
    std::uint32_t at = begin_ + size_;
    if (at >= capacity) at -= capacity;
    char* to = bytes_.data() + at;
    const char* from = line.data();
    // Two loops: one that looks for the end of the ring takes twice as long.
    const std::uint32_t to_end = capacity - at, size = static_cast<std::uint32_t>(line.size());
    for (const char* const stop = from + (size < to_end ? size : to_end); from != stop;)
      *to++ = *from++;
    if (size >= to_end) to = bytes_.data();
    for (const char* const stop = line.data() + size; from != stop;) *to++ = *from++;
    *to = end_of_line;
    size_ += static_cast<std::uint32_t>(line.size()) + 1;
    return true;
  }

  /// Removes the oldest line; the queue must not be empty. `room` holds a line of maximum length.
  std::string_view pop(std::span<char> room) {
    const char* from = bytes_.data() + begin_;
    const char* const end = bytes_.data() + capacity;
    char* to = room.data();
    while (*from != end_of_line) {
      *to++ = *from++;
      if (from == end) from = bytes_.data();
    }
    if (++from == end) from = bytes_.data();
    const auto size = static_cast<std::size_t>(to - room.data());
    begin_ = static_cast<std::uint32_t>(from - bytes_.data());
    size_ -= static_cast<std::uint32_t>(size) + 1;
    if (aside_ != 0) [[unlikely]]
      keep_aside(static_cast<std::uint16_t>(size + 1));
    return {room.data(), size};
  }

  void clear() { size_ = aside_ = kept_ = 0; }

  /// Lines that wait are set aside, and later ones come first.
  [[gnu::cold]] void set_aside() {
    aside_ = kept_ = static_cast<std::uint16_t>(size_);
    begin_ = wrapped(begin_ + size_);
    size_ = 0;
  }
  /// The lines set aside wait again, and later ones are dropped.
  [[gnu::cold]] void bring_back() {
    begin_ = wrapped(begin_ + capacity - aside_);
    size_ = kept_;
    aside_ = kept_ = 0;
  }

 private:
  static constexpr char end_of_line = '\n';

  char at(std::uint32_t i) const { return bytes_[wrapped(begin_ + i)]; }
  static constexpr std::uint32_t wrapped(std::uint32_t place) {
    return place < capacity ? place : place - capacity;
  }
  /// After a line was taken: its room is free again when there is no later one.
  [[gnu::cold]] void keep_aside(std::uint16_t taken) {
    aside_ = static_cast<std::uint16_t>(aside_ + taken);
    if (size_ != 0) return;
    begin_ = wrapped(begin_ + capacity - (aside_ - kept_));
    aside_ = kept_;
  }

  std::array<char, capacity> bytes_{};
  std::uint32_t begin_ = 0, size_ = 0;
  std::uint16_t kept_ = 0;   ///< bytes of the lines set aside
  std::uint16_t aside_ = 0;  ///< the same, and of lines taken since, before begin_
};

}  // namespace lamplock::machine
