// Bytes of the host that wait for the virtual board's main loop, as in the real board's ring
// (firmware/boards/rp2040/base/byte_rings.hpp): commands of one byte are removed where they arrive,
// a reset discards earlier bytes, and the end of jogs leaves a mark.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

#include "shared/wire/realtime_inbox.hpp"

namespace lamplock::sim {

class ReceiveQueue {
 public:
  /// Includes the buffers of the host's computer: the bytes of a host that does not count them
  /// arrive at once, and so does a stop that it sends after them.
  static constexpr std::size_t capacity = std::size_t{4} << 20;

  /// Bytes from the host; returns how many were taken.
  std::size_t write(std::span<const std::uint8_t> bytes) {
    std::size_t taken = 0;
    for (const std::uint8_t byte : bytes) {
      if (wire::is_realtime(byte))
        take_realtime(byte);
      else if (waiting_.size() < capacity)
        waiting_.push_back(byte);
      else
        break;
      ++taken;
    }
    return taken;
  }

  /// Takes the oldest command of one byte; false if there is none.
  bool pop_realtime(std::uint8_t& byte) { return inbox_.pop(byte); }
  /// Takes other bytes; returns how many. Bytes before and after the end of jogs come in separate
  /// calls.
  std::size_t pop(std::span<std::uint8_t> out) {
    before_jog_cancel_ = to_jog_cancel_ != 0;
    const std::size_t waiting = before_jog_cancel_ ? to_jog_cancel_ : waiting_.size();
    const std::size_t count = std::min(out.size(), waiting);
    const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(waiting_.begin(), end, out.begin());
    waiting_.erase(waiting_.begin(), end);
    if (before_jog_cancel_) to_jog_cancel_ -= count;
    return count;
  }
  bool before_jog_cancel() const { return before_jog_cancel_; }

  void clear() {
    waiting_.clear();
    to_jog_cancel_ = 0;
  }

 private:
  void take_realtime(std::uint8_t byte) {
    inbox_.push(byte);
    if (wire::ends_jogs(byte)) to_jog_cancel_ = waiting_.size();
    if (byte == wire::byte_reset) clear();
  }

  std::deque<std::uint8_t> waiting_;
  std::size_t to_jog_cancel_ = 0;   ///< bytes before the last end of jogs
  bool before_jog_cancel_ = false;  ///< of the last pop()
  wire::RealtimeInbox inbox_;
};

}  // namespace lamplock::sim
