// Selects the function on USB that is heard, the serial port or the pulse stream.
//
// In:  received packets, whether a job is unfinished. Out: the function that the core receives from
//      and answers to. Who: UsbSerial, in the USB interrupt.
//
// Two programs may have both functions open at once, and the core talks with one host. So that a
// frame or line never contains bytes of both, one function is heard, and packets of the other one
// are taken from the bus and discarded, real-time bytes too:
//   - A sender of lines that polls `?`, or a service that probes for a modem, must not break a job
//     that runs; senders reset the machine when they connect (0x18), which would end a program or a
//     job. To stop the machine independently of its host, use a wired input.
//   - They are not refused (NAK), because they would then wait and be executed after the job.
//
// The heard function changes when the other one sends a packet, and
//   - no job is unfinished: to the first sender after the bus was reset or the device configured;
//     later to the pulse stream at once, since only programs for this machine open it, and to the
//     serial port when the stream has been silent for a second;
//   - a job is unfinished: to the function that began it at once, so that the host continues its
//     job when its cable is plugged in again; to the other one when that has been silent for ten
//     seconds. A live host of a job never is: it sends four times in a dead-man time. Then the
//     machine is held, unless the dead man is off; a user may query the job over the other one.
// A change is a new connection: a frame or line begun over the other function is never completed.
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

/// What to do with a packet.
enum class Verdict : std::uint8_t {
  take,
  take_over,         ///< as the first one of a new connection
  take_over_broken,  ///< the same, and it continues a line or frame whose begin was not heard
  drop
};

/// End of a packet for the parser of the stream (shared/wire/framing.hpp).
enum class Tail : std::uint8_t {
  ended,  ///< with a line or a frame
  open,   ///< inside one
  none    ///< no byte belongs to either: the state is unchanged
};

/// Effect of a byte at the end of a packet. Real-time bytes and flow control occur between lines or
/// within one: they do not count, and the byte before them decides. Other bytes that a line drops
/// (NUL, 0xb0 and above) may be data of a frame and count as an open one.
constexpr Tail tail_of(std::uint8_t byte) {
  if (wire::is_realtime(byte) || byte == wire::xon || byte == wire::xoff) return Tail::none;
  return byte == '\n' || byte == '\r' || byte == wire::frame_end ? Tail::ended : Tail::open;
}

/// The same for the first `size` bytes of `words`. Every byte of a frame counts, so that for a
/// packet of a job the last one is enough.
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
  /// Silence of the heard function before the other one may be heard, without and in a job.
  static constexpr std::uint32_t idle_lease_us = 1'000'000;
  static constexpr std::uint32_t job_lease_us = 10'000'000;

  /// A new connection begins. `now_us` may wrap.
  void reset(std::uint32_t now_us) {
    heard_ = Function::serial;
    has_received_ = false;
    in_the_middle_ = {};
    since_us_ = now_us;
  }

  /// The function that gets the answers; the serial port before the first packet.
  Function heard() const { return heard_; }

  /// A packet of the heard function waits for room: its host is not silent.
  void speaks_on(std::uint32_t now_us) { since_us_ = now_us; }

  /// A packet was received, not an empty one. `tied`: a job is unfinished.
  Verdict packet(Function from, Tail tail, std::uint32_t now_us, bool tied) {
    const bool begins = from != heard_ || !has_received_;
    const bool broken = in_the_middle_[index(from)];
    if (tail != Tail::none) in_the_middle_[index(from)] = tail == Tail::open;
    if (begins && !may_begin(from, now_us - since_us_, tied)) return Verdict::drop;
    const bool other_was_heard = from != heard_;
    heard_ = from;
    has_received_ = true;
    since_us_ = now_us;
    if (!tied) job_of_ = from;
    if (begins && broken) return Verdict::take_over_broken;
    return other_was_heard ? Verdict::take_over : Verdict::take;
  }

 private:
  bool may_begin(Function from, std::uint32_t silent_us, bool tied) const {
    if (tied) return from == job_of_ || silent_us >= job_lease_us;
    return from == Function::stream || !has_received_ || silent_us >= idle_lease_us;
  }

  Function heard_ = Function::serial;
  Function job_of_ = Function::serial;  ///< function that began the job, if there is one
  bool has_received_ = false;
  std::array<bool, function_count> in_the_middle_{};  ///< of a line or frame, heard or not
  std::uint32_t since_us_ = 0;  ///< last packet of the heard function, or start of the connection
};

}  // namespace lamplock::rp2040::usb
