// Which of the two functions on USB is heard, the serial port or the pulse stream.
//
// In:  packets as they come, whether a job is unfinished. Out: to whom the core listens, and with
//      that who gets its answers. Who: UsbSerial, in the USB interrupt.
//
// Two programs may have both functions open at once, and the core talks with one host. So that no
// frame or line is ever made of bytes of two, one function is heard and the other one's packets are
// taken from the bus and thrown away, real-time bytes too:
//   - A sender of lines that polls `?`, or a service that tries what modem this may be, must not
//     break a job beside it; senders reset what they connect to (0x18), which would end a program
//     or a job. What stops the machine from the side is a wire.
//   - They are not refused (NAK), for then they would wait and be obeyed when the job is over.
//
// The function that is heard changes when the other one speaks, and
//   - no job is unfinished: whoever is first after the bus was reset or the device configured;
//     later the pulse stream at once, since only who means this machine opens it, and the serial
//     port when the stream has been silent for a second;
//   - a job is unfinished: the function that it was begun over at once, so that a cable plugged in
//     again is nobody else's; the other one when that has been silent for ten seconds. A job's host
//     never is while it lives: it speaks four times in a dead-man time. Then the machine is held,
//     unless the dead man is off, and a user may ask over the other function what has become of it.
// A change is a new connection: nothing that was begun over the other function is finished.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/wire/framing.hpp"

namespace lamplock::rp2040::usb {

/// A pair of bulk endpoints for bytes.
enum class Function : std::uint8_t { serial, stream };
inline constexpr std::size_t function_count = 2;

constexpr std::size_t index(Function function) { return static_cast<std::size_t>(function); }
constexpr Function other(Function function) {
  return function == Function::serial ? Function::stream : Function::serial;
}

/// What is to be done with a packet.
enum class Verdict : std::uint8_t {
  take,
  take_over,         ///< as the first one of a new connection
  take_over_broken,  ///< the same, and the line or frame it goes on with was not heard from its
                     ///< begin
  drop
};

/// How a packet ends, as the parser of the stream would see it (shared/wire/framing.hpp).
enum class Tail : std::uint8_t {
  ended,  ///< with a line or a frame
  open,   ///< inside one
  none    ///< nothing in it belongs to either: what was open before still is
};

/// What a byte at the end of a packet says. Real-time bytes and flow control come between lines or
/// in the middle of one: nothing is new, and the byte before them has to be asked. Those that a
/// line drops besides (NUL, 0xb0 and above) may be data of a frame and pass for an open one.
constexpr Tail tail_of(std::uint8_t byte) {
  if (wire::is_realtime(byte) || byte == wire::xon || byte == wire::xoff) return Tail::none;
  return byte == '\n' || byte == '\r' || byte == wire::frame_end ? Tail::ended : Tail::open;
}

/// The same of the first `size` bytes of `words`. Frames have no byte that says nothing, so that
/// the last one of a packet of a job is enough.
inline Tail tail_of(const volatile std::uint32_t* words, std::uint32_t size) {
  for (std::uint32_t i = size; i-- > 0;) {
    const Tail tail = tail_of(static_cast<std::uint8_t>(words[i / 4] >> 8 * (i % 4)));
    if (tail != Tail::none) return tail;
  }
  return Tail::none;
}

/// The choice.
class Listener {
 public:
  /// How long who is heard must have been silent before the other one is, without and in a job.
  static constexpr std::uint32_t idle_lease_us = 1'000'000;
  static constexpr std::uint32_t job_lease_us = 10'000'000;

  /// The connection is a new one. `now_us` may wrap.
  void reset(std::uint32_t now_us) {
    heard_ = Function::serial;
    spoken_ = false;
    in_the_middle_ = {};
    since_us_ = now_us;
  }

  /// Who gets the answers; the serial port if nobody has spoken.
  Function heard() const { return heard_; }

  /// A packet of the function that is heard waits for room: its host is not silent.
  void speaks_on(std::uint32_t now_us) { since_us_ = now_us; }

  /// A packet came, not an empty one. `tied`: a job is unfinished.
  Verdict packet(Function from, Tail tail, std::uint32_t now_us, bool tied) {
    const bool begins = from != heard_ || !spoken_;
    const bool broken = in_the_middle_[index(from)];
    if (tail != Tail::none) in_the_middle_[index(from)] = tail == Tail::open;
    if (begins && !may_begin(from, now_us - since_us_, tied)) return Verdict::drop;
    const bool other_was_heard = from != heard_;
    heard_ = from;
    spoken_ = true;
    since_us_ = now_us;
    if (!tied) job_of_ = from;
    if (begins && broken) return Verdict::take_over_broken;
    return other_was_heard ? Verdict::take_over : Verdict::take;
  }

 private:
  bool may_begin(Function from, std::uint32_t silent_us, bool tied) const {
    if (tied) return from == job_of_ || silent_us >= job_lease_us;
    return from == Function::stream || !spoken_ || silent_us >= idle_lease_us;
  }

  Function heard_ = Function::serial;
  Function job_of_ = Function::serial;  ///< over which the job was begun, if there is one
  bool spoken_ = false;
  std::array<bool, function_count> in_the_middle_{};  ///< of a line or frame, heard or not
  std::uint32_t since_us_ = 0;  ///< when who is heard spoke last, or the connection began
};

}  // namespace lamplock::rp2040::usb
