// Lines, frames and real-time bytes in one stream of bytes (docs/wire-format.md, section 1).
//
// In:  bytes from the port, in pieces of any size.
// Out: calls of `Events`: real-time bytes, whole frames with a good CRC, whole lines, and errors.
//      Damaged data is never delivered.
// The firmware and the host use the same class to receive; only the firmware takes real-time bytes
// out of text. Level: main loop; the CRC is computed at the end of a frame, at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "shared/line_comments.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::wire {

inline constexpr std::uint8_t frame_start = 0x02;  ///< STX
inline constexpr std::uint8_t frame_end = 0x03;    ///< ETX
inline constexpr std::uint8_t escape = 0x7D;
inline constexpr std::uint8_t escape_xor = 0x40;
inline constexpr std::uint8_t xon = 0x11;
inline constexpr std::uint8_t xoff = 0x13;

/// Longest content of a frame, CRC included, before stuffing [bytes].
inline constexpr std::size_t max_content = 512;
inline constexpr std::size_t crc_size = 4;
/// Longest frame on the wire [bytes].
inline constexpr std::size_t max_frame = 2 * max_content + 2;
/// Longest line without its end; comments of longer ones are dropped [characters].
inline constexpr std::size_t max_line = 256;

/// Commands of one byte: those of grbl 1.1 and grblHAL, with their whole block reserved.
[[gnu::always_inline]] constexpr bool is_realtime(std::uint8_t byte) {
  return byte == 0x18 || byte == '?' || byte == '!' || byte == '~' ||
         (byte >= 0x80 && byte <= 0xAF);
}

/// Bytes that must be escaped inside a frame.
constexpr bool must_escape(std::uint8_t byte) {
  return is_realtime(byte) || byte == frame_start || byte == frame_end || byte == escape ||
         byte == '\r' || byte == '\n' || byte == xon || byte == xoff;
}

/// Writes content and CRC as a frame. Returns its size, 0 if the content is too long or `out` too
/// small (max_frame is always enough).
constexpr std::size_t encode_frame(std::span<const std::uint8_t> content,
                                   std::span<std::uint8_t> out) {
  if (content.size() + crc_size > max_content) return 0;
  ByteWriter writer(out);
  const auto stuff = [&writer](std::uint8_t byte) {
    if (must_escape(byte)) {
      writer.put(escape);
      byte ^= escape_xor;
    }
    writer.put(byte);
  };
  writer.put(frame_start);
  for (const std::uint8_t byte : content) stuff(byte);
  const std::uint32_t crc = crc32(content);
  for (int shift = 0; shift < 32; shift += 8) stuff(static_cast<std::uint8_t>(crc >> shift & 0xff));
  writer.put(frame_end);
  return writer.ok() ? writer.size() : 0;
}

/// Letters, digits and the characters between them in numbers: they have no other meaning in a
/// line.
constexpr bool is_plain(std::uint8_t byte) {
  return (byte >= '-' && byte <= '9') || (byte >= 'A' && byte <= 'Z');
}

/// The receiving end of the wire.
enum class End { device, host };

/// Parses a stream of bytes. `Events` has
///   void on_realtime(std::uint8_t)                      (device end only)
///   void on_frame(std::span<const std::uint8_t>)        content without CRC, valid in the call
///   void on_bad_frame()                                 CRC, length or stuffing was wrong
///   void on_line(std::string_view)                      without its end, valid in the call
///   void on_lost_line()                                 a line ended that was damaged or too long
/// No byte may be pushed from within an event.
template <End end>
class StreamParser {
 public:
  template <class Events>
  void push(std::span<const std::uint8_t> bytes, Events& events) {
    const std::uint8_t* at = bytes.data();
    for (const std::uint8_t* const stop = at + bytes.size(); at != stop;) {
      if (state_ == State::line) at = append_plain(at, stop);
      if (at != stop) push(*at++, events);
    }
  }

  template <class Events>
  void push(std::uint8_t byte, Events& events) {
    if constexpr (end == End::device) {
      if (is_realtime(byte)) return events.on_realtime(byte);
    }
    if (byte == frame_start) {
      if (state_ == State::frame) events.on_bad_frame();
      begin(State::frame);
    } else if (byte == '\r' || byte == '\n') {
      end_line(byte, events);
    } else if (state_ == State::frame) {
      push_in_frame(byte, events);
    } else {
      push_in_line(byte);
    }
    after_cr_ = byte == '\r';
  }

  /// Drops incomplete data: the other end of the wire is a new one, or its user has reset it. May
  /// be called from within on_realtime().
  void reset() {
    begin(State::line);
    after_cr_ = false;
  }

  /// Characters of a line that has not ended.
  std::size_t line_size() const { return state_ == State::line ? size_ : 0; }

 private:
  enum class State : std::uint8_t { line, frame };

  void begin(State state) {
    state_ = state;
    size_ = 0;
    spoilt_ = false;
    escaped_ = false;
    comment_end_ = 0;
  }

  template <class Events>
  void end_line(std::uint8_t byte, Events& events) {
    if (byte == '\n' && after_cr_) return;
    const bool in_frame = state_ == State::frame;
    if (in_frame) events.on_bad_frame();
    const bool lost = in_frame || spoilt_;
    const std::size_t size = size_;
    begin(State::line);
    if (lost) return events.on_lost_line();
    events.on_line(std::string_view(reinterpret_cast<const char*>(buffer_.data()), size));
  }

  template <class Events>
  void push_in_frame(std::uint8_t byte, Events& events) {
    if (byte == frame_end) {
      const bool good = !spoilt_ && !escaped_ && crc_good();
      const std::size_t size = size_;
      begin(State::line);
      if (!good) return events.on_bad_frame();
      return events.on_frame(std::span<const std::uint8_t>(buffer_).first(size - crc_size));
    }
    // The rest are the real-time block (host end) and flow control: noise from outside the frame.
    if (byte != escape && must_escape(byte)) return;
    if (byte == escape) {
      spoilt_ = spoilt_ || escaped_;
      escaped_ = true;
      return;
    }
    if (escaped_) {
      byte ^= escape_xor;
      escaped_ = false;
      spoilt_ = spoilt_ || !must_escape(byte);
    }
    append(byte, max_content);
  }

  void push_in_line(std::uint8_t byte) {
    if (byte >= 0x80 || byte == 0 || byte == xon || byte == xoff) return;
    const bool printable = (byte >= 0x20 && byte != 0x7F) || byte == '\t';
    if (!printable) spoilt_ = true;
    if (end == End::device && size_ == max_line && comment_end_ == 0) make_room();
    if (comment_end_ == 0)
      append(byte, max_line);
    else if (byte == static_cast<std::uint8_t>(comment_end_))
      comment_end_ = 0;
  }

  /// Comments do not count towards the length of a line.
  void make_room() {
    const CommentFree rest = drop_comments(std::span(buffer_).first(size_));
    size_ = rest.size;
    comment_end_ = rest.comment_end;
  }

  /// Appends plain bytes to a line, nearly all of a program; returns where they end.
  const std::uint8_t* append_plain(const std::uint8_t* at, const std::uint8_t* stop) {
    const std::size_t size = size_, room = spoilt_ || comment_end_ != 0 ? 0 : max_line - size;
    const auto left = static_cast<std::size_t>(stop - at);
    const std::uint8_t* const begin = at;
    const std::uint8_t* const last = at + (left < room ? left : room);
    for (std::uint8_t* to = buffer_.data() + size; at != last && is_plain(*at);) *to++ = *at++;
    if (at == begin) return at;
    size_ = size + static_cast<std::size_t>(at - begin);
    after_cr_ = false;
    return at;
  }

  void append(std::uint8_t byte, std::size_t limit) {
    if (size_ == limit) spoilt_ = true;
    if (!spoilt_) buffer_[size_++] = byte;
  }

  bool crc_good() const {
    if (size_ < crc_size) return false;
    const std::span<const std::uint8_t> content(buffer_.data(), size_);
    ByteReader crc(content.last(crc_size));
    return crc.take<std::uint32_t>() == crc32(content.first(size_ - crc_size));
  }

  // A frame start drops the line in progress, so one buffer serves both.
  std::array<std::uint8_t, max_content> buffer_{};
  std::size_t size_ = 0;
  State state_ = State::line;
  bool spoilt_ = false;   ///< too long or damaged: dropped up to its end
  bool escaped_ = false;  ///< the last byte of the frame was the escape
  bool after_cr_ = false;
  char comment_end_ = 0;  ///< in a comment of a long line: what ends it
};

}  // namespace lamplock::wire
