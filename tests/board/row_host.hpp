// A sender of row jobs.
//
// In:  lines with the runs of their cells; any transport.
// Out: frames, sent again after a loss; the machine's messages.
// Used by tests of both boards. Depends on the wire only, and sends no more than STATUS permits.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "host/link/connection.hpp"
#include "host/link/transport.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/row_records.hpp"

namespace lamplock::test {

/// A line and its cells.
struct PixelLine {
  wire::RowLine line;
  std::vector<std::uint16_t> runs;
};

struct RowFrame {
  std::vector<std::uint8_t> payload;
  std::uint32_t lines = 0;   ///< of the whole job up to its end
  std::uint32_t places = 0;  ///< for runs and headers up to its end
};

/// The frames of the lines from the header's first index, which begins at its origin.
inline std::vector<RowFrame> row_frames(const std::vector<PixelLine>& lines,
                                        const wire::JobHeader& header,
                                        std::size_t max_bytes = wire::max_payload) {
  std::vector<RowFrame> frames;
  std::array<std::uint8_t, wire::max_payload> bytes{};
  wire::ByteWriter out({});
  std::size_t in_frame = 0;
  std::uint32_t places = 0, index = header.first_index;
  wire::RowState state;
  state.steps = header.origin_steps;
  const auto begin = [&] {
    out = wire::ByteWriter(std::span(bytes).first(max_bytes));
    in_frame = 0;
  };
  const auto end = [&] {
    if (out.size() != 0)
      frames.push_back({{out.written().begin(), out.written().end()}, index, places});
    begin();
  };
  begin();
  for (std::size_t i = header.first_index; i < lines.size(); ++i) {
    std::span<const std::uint16_t> left(lines[i].runs);
    while (!left.empty()) {
      const std::uint32_t header_place = state.runs == 0 ? 1 : 0;
      const std::size_t count = wire::put_runs(out, state, left);
      if (count == 0) {
        if (out.size() == 0) throw std::logic_error("a line has too many runs");
        end();
        continue;
      }
      places += header_place + static_cast<std::uint32_t>(count);
      left = left.subspan(count);
    }
    if (in_frame == wire::max_lines_a_frame) end();
    while (!wire::put_row_line(out, state, lines[i].line, header.axes)) {
      if (out.size() == 0) throw std::logic_error("a line cannot be coded");
      end();
    }
    ++in_frame;
    ++index;
  }
  end();
  return frames;
}

class RowHost {
 public:
  RowHost(link::Transport& transport, const std::vector<PixelLine>& lines, wire::JobHeader header,
          std::uint32_t session = 77, std::size_t max_bytes = wire::max_payload)
      : transport_(transport), connection_(transport), header_(header), session_(session) {
    header_.points_total = static_cast<std::uint32_t>(lines.size());
    header_.mode = wire::mode_rows;
    frames_ = row_frames(lines, header_, max_bytes);
  }

  /// One round: receives, sends what the board has room for, and lets time pass.
  void step(std::chrono::microseconds time = std::chrono::microseconds(500)) {
    if (!transport_.connected() && !connection_.reconnect()) return transport_.wait(time);
    while (const auto message = connection_.receive()) {
      if (const auto* status = std::get_if<wire::Status>(&*message)) take(*status);
      if (const auto* refused = std::get_if<link::RefusedFrame>(&*message))
        refused_ = refused->refused;
      if (const auto* text = std::get_if<std::string>(&*message)) texts_.push_back(*text);
    }
    if (status_.session != session_) {
      begin();
    } else if (!starving_) {
      send_frames();
    }
    if (resumes_ && status_.state == wire::MachineState::hold && status_.session == session_ &&
        status_.hold_reason != wire::HoldReason::host)
      command(wire::Command::resume);
    repeat_command();
    ask();
    connection_.flush();
    transport_.wait(time);
  }
  /// Runs until the board reports all lines as run; false if it takes longer.
  bool run(double seconds) {
    const auto end = transport_.now() + std::chrono::microseconds(std::llround(seconds * 1e6));
    while (!done() && transport_.now() < end && !refused_) step();
    return done();
  }
  bool done() const {
    return status_.session == session_ && status_.next_number == frames_.size() + 2 &&
           status_.state == wire::MachineState::idle;
  }

  /// Repeats the command until the board accepts it; a later command replaces it.
  void command(wire::Command what, std::uint32_t value = 0) {
    if (command_taken()) ++command_number_;
    command_ = {what, value};
    command_at_ = {};
  }
  bool command_taken() const { return status_.last_command >= command_number_; }

  const wire::Status& status() const { return status_; }
  const std::optional<wire::Refused>& refused() const { return refused_; }
  const std::vector<std::string>& texts() const { return texts_; }
  std::uint64_t resent() const { return resent_; }
  /// While on, no frames are sent.
  void starve(bool on) { starving_ = on; }
  /// By default the host resumes after holds that it did not request; this ends that.
  void do_not_resume() { resumes_ = false; }

 private:
  using Time = std::chrono::microseconds;
  static constexpr Time patience{50'000}, look{20'000}, soon{2'000};

  void take(const wire::Status& status) {
    if (status.number <= status_.number && status_.number != 0) return;
    status_ = status;
    if (status.session != session_) return;
    // Frames sent before the last query and not received were lost.
    if (status.echo == tag_ && status.next_number <= asked_behind_) {
      if (sent_ > status.next_number - 1) resent_ += sent_ - (status.next_number - 1);
      sent_ = status.next_number - 1;
    }
    sent_ = std::max(sent_, status.next_number - 1);
  }
  void begin() {
    if (begun_at_ && transport_.now() < *begun_at_ + patience) return;
    begun_at_ = transport_.now();
    std::array<std::uint8_t, wire::max_job_header_size> payload{};
    wire::ByteWriter out(payload);
    wire::write_job_header(out, header_);
    connection_.send({wire::FrameType::begin, session_, 0}, out.written());
  }
  void send_frames() {
    constexpr std::size_t max_backlog = 2000;
    const std::uint32_t taken = status_.next_number - 1;
    const std::uint32_t lines =
        taken == 0 || taken > frames_.size() ? header_.first_index : frames_[taken - 1].lines;
    const std::uint32_t places =
        taken == 0 || taken > frames_.size() ? 0 : frames_[taken - 1].places;
    bool sent = false;
    while (sent_ < frames_.size() + 1 && sent_ < taken + 16 &&
           connection_.backlog() < max_backlog) {
      if (sent_ == frames_.size()) {
        send_end();
      } else {
        const RowFrame& frame = frames_[sent_];
        if (frame.lines > lines + status_.free_points || frame.places > places + status_.free_runs)
          break;
        connection_.send({wire::FrameType::data, session_, sent_ + 1}, frame.payload);
      }
      ++sent_;
      sent = true;
    }
    sent_since_ = sent_since_ || sent;
  }
  void send_end() {
    std::array<std::uint8_t, 4> payload{};
    wire::ByteWriter out(payload);
    out.put(header_.points_total);
    connection_.send({wire::FrameType::end, session_, sent_ + 1}, out.written());
  }
  void repeat_command() {
    if (command_taken() || (command_at_ && transport_.now() < *command_at_ + patience)) return;
    command_at_ = transport_.now();
    std::array<std::uint8_t, wire::max_command_size> payload{};
    wire::ByteWriter out(payload);
    wire::write_command(out, command_);
    connection_.send({wire::FrameType::command, session_, command_number_}, out.written());
  }
  void ask() {
    if (asked_at_ && transport_.now() < *asked_at_ + (sent_since_ ? soon : look)) return;
    sent_since_ = false;
    asked_at_ = transport_.now();
    asked_behind_ = sent_;
    connection_.send_query(session_, ++tag_);
  }

  link::Transport& transport_;
  link::Connection connection_;
  wire::JobHeader header_;
  std::uint32_t session_;
  std::vector<RowFrame> frames_;
  wire::Status status_;
  std::optional<wire::Refused> refused_;
  std::vector<std::string> texts_;
  std::uint32_t sent_ = 0, tag_ = 0, asked_behind_ = 0;
  std::uint64_t resent_ = 0;
  std::optional<Time> begun_at_, asked_at_, command_at_;
  wire::CommandRequest command_;
  std::uint32_t command_number_ = 0;
  bool starving_ = false, resumes_ = true;
  bool sent_since_ = false;  ///< frames since the last query
};

}  // namespace lamplock::test
