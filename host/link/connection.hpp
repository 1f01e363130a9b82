// Frames over a transport: the host's mirror of firmware/link.
//
// In:  frames to send; bytes from the transport.
// Out: received STATUS, REFUSED and lines of text in order. Corrupt frames are only counted.
// Who: the sender; code that asks a machine for its status.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host/link/transport.hpp"
#include "shared/wire/framing.hpp"
#include "shared/wire/messages.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// REFUSED with the number of the refused frame.
struct RefusedFrame {
  std::uint32_t number = 0;
  wire::Refused refused;
};

/// A message of the firmware.
using Message = std::variant<wire::Status, RefusedFrame, std::string>;

/// Codes and decodes frames over one transport.
class Connection {
 public:
  explicit Connection(Transport& transport) : transport_(transport) {}

  /// Encodes a frame for the wire, to be sent once or again.
  static std::vector<std::uint8_t> encode(const wire::FrameHeader& header,
                                          std::span<const std::uint8_t> payload);
  /// Queues a frame, flush() sends it.
  void send(const wire::FrameHeader& header, std::span<const std::uint8_t> payload) {
    send(encode(header, payload));
  }
  void send(std::span<const std::uint8_t> frame) {
    out_.insert(out_.end(), frame.begin(), frame.end());
  }
  /// Queues a QUERY with this tag.
  void send_query(std::uint32_t session, std::uint32_t tag);

  /// Writes as much as the transport takes now.
  void flush();
  /// Bytes queued and not yet taken by the transport.
  std::size_t backlog() const { return out_.size(); }

  /// The next received message, if any.
  std::optional<Message> receive();

  /// Makes a new connection and drops all bytes in both directions. False if that fails for now.
  bool reconnect();

  /// Corrupt frames from the firmware.
  std::uint64_t bad_frames() const { return bad_frames_; }

  // Events of the parser.
  void on_frame(std::span<const std::uint8_t> content);
  void on_bad_frame() { ++bad_frames_; }
  void on_line(std::string_view line) {
    if (!line.empty()) messages_.emplace_back(std::string(line));
  }
  void on_lost_line() {}

 private:
  void read();

  Transport& transport_;
  wire::StreamParser<wire::End::host> parser_;
  std::deque<Message> messages_;
  std::vector<std::uint8_t> out_;
  std::uint64_t bad_frames_ = 0;
};

}  // namespace lamplock::link
