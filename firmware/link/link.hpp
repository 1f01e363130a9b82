// The firmware's end of the wire: receives bytes, passes commands to the machine, sends answers
// (docs/wire-format.md).
//
// In:  received bytes in pieces of any size (`receive`), and the machine through the `LinkSink`
//      concept: what was received is passed to it at once, in order.
// Out: bytes to send (`transmit`): text of the machine (`send_text`) and STATUS/REFUSED frames.
// Who: the controller owns one Link; the board passes bytes in and reads bytes through the
//      controller. All at main-loop level; estimated, not measured: 50 cycles a byte.
//
// Guarantees: DATA reaches the machine exactly once and in order, whatever errors the wire has;
// incomplete lines and frames never reach it; an answer is sent whole or later, never in part;
// real-time bytes are recognised everywhere in the stream.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/link/transmit_ring.hpp"
#include "shared/result.hpp"
#include "shared/wire/framing.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/messages.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// Interface of the machine for the link.
///   on_realtime(byte)       any of the real-time list; must ignore unknown ones
///   on_line(text)           a line without its end, blank ones too; must send exactly one answer
///   on_line_too_long()      a line that was too long or damaged; must answer with an error
///   on_begin(header)        a new session: all data of the last job is void
///   on_data(records)        the next records: all of them are accepted, or none
///                           (Result::no_space: not yet; any other result: never)
///   on_end(total)           the last point has been sent; `total` as in the header
///   on_command(request)     hold, resume, stop or another speed, from the host's user
///   refused_value()         after a result other than ok: setting number, index of the point or
///                           value of the command
///   status_summary()        values whose change causes a STATUS; called at every poll
///   fill_status(status)     all members of Status that the link does not know
template <class Sink>
concept LinkSink = requires(Sink& sink, const Sink& reader, std::uint8_t byte,
                            std::string_view line, const wire::JobHeader& header,
                            std::span<const std::uint8_t> records, std::uint32_t total,
                            const wire::CommandRequest& request, wire::Status& status) {
  sink.on_realtime(byte);
  sink.on_line(line);
  sink.on_line_too_long();
  { sink.on_begin(header) } -> std::same_as<Result>;
  { sink.on_data(records) } -> std::same_as<Result>;
  { sink.on_end(total) } -> std::same_as<Result>;
  { sink.on_command(request) } -> std::same_as<Result>;
  { reader.refused_value() } -> std::convertible_to<std::uint32_t>;
  { reader.status_summary() } -> std::same_as<wire::StatusSummary>;
  reader.fill_status(status);
};

/// Receiver, sessions, acknowledgements, transmit ring.
class Link {
 public:
  /// Parses received bytes and passes their contents to the machine.
  template <LinkSink Sink>
  void receive(std::span<const std::uint8_t> bytes, Sink& sink) {
    Events<Sink> events{*this, sink};
    parser_.push(bytes, events);
    if (status_due_) send_status(sink);
  }

  /// Sends a STATUS that is due: one that did not fit before, or because space has become free or
  /// the machine's state has changed. To be called at least once a millisecond.
  template <LinkSink Sink>
  void poll(Sink& sink) {
    if (frames_used_ && sink.status_summary().is_news(sent_summary_)) status_due_ = true;
    if (status_due_) send_status(sink);
  }

  /// The following bytes are from another host, or from the same one after a break: an incomplete
  /// line or frame is dropped. Session, counts and unsent answers are kept: a job continues. Cheap;
  /// not from within receive().
  void new_connection() {
    parser_.reset();
    frames_used_ = false;
  }
  /// Drops an incomplete line or frame: a reset has discarded the rest of it.
  void drop_input() { parser_.reset(); }

  /// Removes bytes to send; returns how many were written to `out`.
  std::size_t transmit(std::span<std::uint8_t> out) { return ring_.pop(out); }
  std::size_t room() const { return ring_.room(); }
  /// Characters of an incomplete line.
  std::size_t line_size() const { return parser_.line_size(); }
  std::size_t transmit_size() const { return ring_.size(); }

  /// Queues text, which may be a piece of a line: no frame is inserted between the pieces. False,
  /// and counted, if it does not fit whole.
  bool send_text(std::string_view text) {
    if (text.empty()) return true;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    if (!queue({bytes, text.size()})) return false;
    line_open_ = text.back() != '\n';
    return true;
  }

  /// Reports to the host that a point accepted earlier cannot be reached.
  void refuse_point(Result result, std::uint32_t point) {
    refuse({wire::FrameType::data, session_, 0}, result, point);
  }

  /// True if a frame of any type was received since the last call: the host of a job lives.
  bool take_frame_seen() {
    const bool seen = frame_seen_;
    frame_seen_ = false;
    return seen;
  }
  /// Session of the last job begun; 0 = none.
  std::uint32_t session() const { return session_; }
  /// Drops the job: its frames are refused from now on, which informs the host.
  void forget_session() { session_ = 0; }
  const wire::LinkCounters& counters() const { return counters_; }

 private:
  /// Passes the results of the parser on.
  template <class Sink>
  struct Events {
    Link& link;
    Sink& sink;
    void on_realtime(std::uint8_t byte) { sink.on_realtime(byte); }
    void on_frame(std::span<const std::uint8_t> content) { link.handle_frame(content, sink); }
    void on_bad_frame() { ++link.counters_.bad_frames; }
    void on_line(std::string_view line) {
      link.frames_used_ = false;
      sink.on_line(line);
    }
    void on_lost_line() {
      ++link.counters_.lost_lines;
      sink.on_line_too_long();
    }
  };

  template <class Sink>
  void handle_frame(std::span<const std::uint8_t> content, Sink& sink) {
    wire::ByteReader in(content);
    const wire::FrameHeader header = wire::read_header(in);
    if (!in.ok()) {
      ++counters_.bad_frames;
      return;
    }
    frames_used_ = frame_seen_ = true;
    status_due_ = true;
    switch (header.type) {
      case wire::FrameType::query:
        echo_ = header.number;
        break;
      case wire::FrameType::begin:
        handle_begin(header, in.rest(), sink);
        break;
      case wire::FrameType::data:
      case wire::FrameType::end:
        handle_numbered(header, in.rest(), sink);
        break;
      case wire::FrameType::command:
        handle_command(header, in.rest(), sink);
        break;
      default:
        refuse(header, Result::bad_frame, 0);
    }
  }

  template <class Sink>
  void handle_begin(const wire::FrameHeader& frame, std::span<const std::uint8_t> payload,
                    Sink& sink) {
    if (frame.session == session_ && session_ != 0) return;
    wire::JobHeader header;
    header.session = frame.session;
    Result result = wire::read_job_header(payload, header);
    if (result == Result::ok && frame.session == 0) result = Result::bad_value;
    if (result != Result::ok) return refuse(frame, result, 0);
    result = sink.on_begin(header);
    if (result != Result::ok) return refuse(frame, result, sink.refused_value());
    session_ = frame.session;
    next_number_ = first_number;
    last_command_ = 0;
  }

  /// DATA and END: only the next one is accepted.
  template <class Sink>
  void handle_numbered(const wire::FrameHeader& frame, std::span<const std::uint8_t> payload,
                       Sink& sink) {
    if (frame.session != session_ || session_ == 0 || frame.number > next_number_) {
      ++counters_.out_of_order;
      return;
    }
    if (frame.number < next_number_) {
      ++counters_.duplicates;
      return;
    }
    const Result result =
        frame.type == wire::FrameType::data ? sink.on_data(payload) : end_job(payload, sink);
    if (result == Result::ok) {
      ++next_number_;
    } else if (result == Result::no_space) {
      ++counters_.out_of_order;
    } else {
      refuse(frame, result, sink.refused_value());
    }
  }

  template <class Sink>
  static Result end_job(std::span<const std::uint8_t> payload, Sink& sink) {
    wire::ByteReader in(payload);
    const auto total = in.take<std::uint32_t>();
    return in.exhausted() ? sink.on_end(total) : Result::bad_frame;
  }

  template <class Sink>
  void handle_command(const wire::FrameHeader& frame, std::span<const std::uint8_t> payload,
                      Sink& sink) {
    if (frame.session != session_ || session_ == 0) return refuse(frame, Result::no_job, 0);
    if (frame.number <= last_command_) return;
    wire::CommandRequest request;
    if (!wire::read_command(payload, request)) return refuse(frame, Result::bad_frame, 0);
    last_command_ = frame.number;
    const Result result = sink.on_command(request);
    if (result != Result::ok) refuse(frame, result, sink.refused_value());
  }

  /// Reports that a frame is refused. If the answer does not fit now, the host will repeat its
  /// frame.
  void refuse(const wire::FrameHeader& frame, Result result, std::uint32_t value) {
    std::array<std::uint8_t, wire::frame_header_size + wire::refused_size> content;
    wire::ByteWriter out(content);
    wire::write_header(out, {wire::FrameType::refused, session_, frame.number});
    wire::write_refused(out, {frame.type, result, value});
    send_frame(out.written());
  }

  template <class Sink>
  void send_status(Sink& sink) {
    if (line_open_ || ring_.room() < max_answer) return;
    wire::Status status;
    sink.fill_status(status);
    status.session = session_;
    status.number = status_number_ + 1;
    status.next_number = next_number_;
    status.echo = echo_;
    status.last_command = last_command_;
    status.link = counters_;
    std::array<std::uint8_t, wire::frame_header_size + wire::status_size> content;
    wire::ByteWriter out(content);
    wire::write_header(out, {wire::FrameType::status, session_, status.number});
    wire::write_status(out, status);
    send_frame(out.written());
    status_due_ = false;
    ++status_number_;
    sent_summary_ = status;
  }

  void send_frame(std::span<const std::uint8_t> content) {
    std::array<std::uint8_t, max_answer> frame;
    const std::size_t size = wire::encode_frame(content, frame);
    if (!line_open_) queue(std::span<const std::uint8_t>(frame).first(size));
  }

  bool queue(std::span<const std::uint8_t> bytes) {
    if (ring_.push(bytes)) return true;
    ++counters_.transmit_overflows;
    return false;
  }

  static constexpr std::uint32_t first_number = 1;
  /// Longest frame that the firmware sends, every byte escaped.
  static constexpr std::size_t max_answer =
      2 * (wire::frame_header_size + wire::status_size + wire::crc_size) + 2;

  wire::StreamParser<wire::End::device> parser_;
  TransmitRing ring_;
  wire::LinkCounters counters_;
  wire::StatusSummary sent_summary_;  ///< in the last STATUS sent
  std::uint32_t session_ = 0;
  std::uint32_t next_number_ = first_number;
  std::uint32_t last_command_ = 0;
  std::uint32_t echo_ = 0;
  std::uint32_t status_number_ = 0;
  bool frames_used_ = false;  ///< the last input of the host was a frame
  bool frame_seen_ = false;
  bool status_due_ = false;
  bool line_open_ = false;  ///< the last text sent has not ended its line
};

}  // namespace lamplock::link
