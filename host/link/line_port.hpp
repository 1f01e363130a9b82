// Lines of text and real-time bytes over a transport: the part of the protocol that grbl has too.
//
// In:  lines and real-time bytes to send; bytes from the transport.
// Out: received lines of text in order, blank ones left out. Frames are skipped.
// Who: all code that talks to a board by lines: programs, settings, the console.
//
// Real-time bytes overtake lines that the transport has not taken yet: a program must not delay a
// hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/transport.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::link {

/// Real-time bytes of grbl 1.1 that the host sends.
namespace realtime {
inline constexpr std::uint8_t status = '?';
inline constexpr std::uint8_t hold = '!';
inline constexpr std::uint8_t resume = '~';
inline constexpr std::uint8_t reset = 0x18;
inline constexpr std::uint8_t door = 0x84;
inline constexpr std::uint8_t jog_cancel = 0x85;
inline constexpr std::uint8_t feed_full = 0x90;
inline constexpr std::uint8_t feed_plus_10 = 0x91;
inline constexpr std::uint8_t feed_minus_10 = 0x92;
inline constexpr std::uint8_t feed_plus_1 = 0x93;
inline constexpr std::uint8_t feed_minus_1 = 0x94;
inline constexpr std::uint8_t rapid_full = 0x95;
inline constexpr std::uint8_t rapid_half = 0x96;
inline constexpr std::uint8_t rapid_quarter = 0x97;
inline constexpr std::uint8_t power_full = 0x99;
inline constexpr std::uint8_t power_plus_10 = 0x9A;
inline constexpr std::uint8_t power_minus_10 = 0x9B;
inline constexpr std::uint8_t power_plus_1 = 0x9C;
inline constexpr std::uint8_t power_minus_1 = 0x9D;
inline constexpr std::uint8_t tool_change = 0xA3;  ///< acknowledged: later lines are the user's
}  // namespace realtime

/// Text in both directions over one transport, which must outlive it.
class LinePort {
 public:
  explicit LinePort(Transport& transport) : transport_(transport) {}

  /// Queues a line; its end is added.
  void send_line(std::string_view line);
  /// Queues a real-time byte before all lines.
  void send_realtime(std::uint8_t byte) { urgent_.push_back(byte); }
  /// Writes as much as the transport takes now.
  void flush();
  /// Drops lines that the transport has not taken; half a line may have been sent.
  void drop_lines();
  /// Drops lines of which no byte was sent; returns their number. The rest of a line that was sent
  /// in part is still sent: cut short it might mean another command.
  std::size_t drop_unbegun_lines();
  /// Bytes queued and not yet taken by the transport.
  std::size_t backlog() const { return lines_.size() + urgent_.size(); }
  /// A line was sent in part.
  bool inside_line() const { return inside_line_; }

  /// The next received line, if any.
  std::optional<std::string> receive();

  Transport& transport() { return transport_; }

  // Events of the parser.
  void on_frame(std::span<const std::uint8_t>) {}
  void on_bad_frame() {}
  void on_line(std::string_view line) {
    if (!line.empty()) received_.emplace_back(line);
  }
  void on_lost_line() {}

 private:
  void read();
  bool flush_urgent();

  Transport& transport_;
  wire::StreamParser<wire::End::host> parser_;
  std::deque<std::string> received_;
  std::vector<std::uint8_t> lines_, urgent_;
  bool inside_line_ = false;  ///< the first of lines_ was sent in part
};

}  // namespace lamplock::link
