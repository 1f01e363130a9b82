// Passes commands of one byte from the place where they are received to the machine.
//
// In:  real-time bytes, where the board reads its port: an interrupt, or a simulator.
// Out: the same bytes, in order, to the main loop. So a stop never waits until lines have room.
// One writer and one reader; each index has one writer. No masking.
//
// A host may send them faster than the main loop handles them. A redundant command (the same one
// again, a further `?`) is dropped; when the inbox is full, others are dropped, and a command that
// stops replaces the newest one, unless that stops more.
#pragma once

#include <array>
#include <cstdint>

#include "shared/wire/framing.hpp"

namespace lamplock::wire {

// Commands of grbl 1.1 that stop, and the status request.
inline constexpr std::uint8_t byte_status = '?';
inline constexpr std::uint8_t byte_hold = '!';
inline constexpr std::uint8_t byte_resume = '~';
inline constexpr std::uint8_t byte_reset = 0x18;
inline constexpr std::uint8_t byte_door = 0x84;
inline constexpr std::uint8_t byte_jog_cancel = 0x85;
/// grblHAL's acknowledgement of a tool change: lines after it are the user's, not the program's.
inline constexpr std::uint8_t byte_tool = 0xa3;

/// How much of the machine's work a command ends; 0 = it stops nothing.
constexpr int stop_rank(std::uint8_t byte) {
  switch (byte) {
    case byte_reset:
      return 4;
    case byte_door:
      return 3;
    case byte_hold:
      return 2;
    case byte_jog_cancel:
      return 1;
    default:
      return 0;
  }
}

/// Jogs that were sent before it are void; so the place of this byte among the others is kept.
[[gnu::always_inline]] constexpr bool ends_jogs(std::uint8_t byte) {
  return byte == byte_jog_cancel || byte == byte_hold || byte == byte_door || byte == byte_tool;
}

/// Real-time bytes that wait for the main loop.
class RealtimeInbox {
 public:
  static constexpr std::uint32_t capacity = 32;

  /// Called where bytes are received. `byte` is a real-time byte.
  void push(std::uint8_t byte) {
    if (byte == byte_status) {
      status_asked_ = true;
      return;
    }
    const std::uint32_t end = end_;
    const bool empty = end == begin_;
    volatile std::uint8_t& newest = bytes_[(end - 1) % capacity];
    if (!empty && byte == newest && (stop_rank(byte) != 0 || byte == byte_resume)) return;
    if (end - begin_ == capacity) {
      if (stop_rank(byte) > stop_rank(newest)) newest = byte;
      return;
    }
    bytes_[end % capacity] = byte;
    end_ = end + 1;
  }

  /// A command waits.
  bool waits() const { return begin_ != end_ || status_asked_; }

  /// Main loop: removes the oldest command; false if there is none. A status request is last, so
  /// that the answer shows the effect of the others.
  bool pop(std::uint8_t& byte) {
    const std::uint32_t begin = begin_;
    if (begin != end_) {
      byte = bytes_[begin % capacity];
      begin_ = begin + 1;
      return true;
    }
    if (!status_asked_) return false;
    status_asked_ = false;
    byte = byte_status;
    return true;
  }

 private:
  std::array<volatile std::uint8_t, capacity> bytes_{};
  volatile std::uint32_t begin_ = 0;  ///< written by the reader
  volatile std::uint32_t end_ = 0;    ///< written by the writer
  volatile bool status_asked_ = false;
};

}  // namespace lamplock::wire
