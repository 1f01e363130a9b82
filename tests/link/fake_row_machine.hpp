// A machine that only counts: accepts rows of pixels, runs lines as time passes.
//
// Its table of runs is as large as the board's, and what does not fit is refused as by the board: a
// sender that counts wrongly is detected by `refused_frames`.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string_view>
#include <vector>

#include "firmware/link/link.hpp"
#include "host/job/rows.hpp"
#include "tests/bad_cable.hpp"

namespace lamplock::test {

/// Sink of a link with queued lines and a table of runs that fills and drains.
class FakeRowMachine {
 public:
  static constexpr std::uint32_t table_places = 1024, max_lines = 32;

  // Called by the link.
  void on_realtime(std::uint8_t byte) {
    const bool running = state == wire::MachineState::run;
    if (running && byte == '!') hold(wire::HoldReason::realtime);
    if (running && byte == 0x18) {
      hold(wire::HoldReason::reset);
      state = wire::MachineState::idle;  // dark lines cannot be resumed
    }
    const bool held_by_host = reason == wire::HoldReason::host;
    if (state == wire::MachineState::hold && byte == '~' && !held_by_host) run();
  }
  void on_line(std::string_view) {}
  void on_line_too_long() {}
  Result on_begin(const wire::JobHeader& job) {
    ++begins;
    if (begin_result != Result::ok) return begin_result;
    if (state != wire::MachineState::idle) return Result::busy;
    if (job.mode != wire::mode_rows) return Result::bad_value;
    header = job;
    state_ = {};
    state_.steps = job.origin_steps;
    run();
    return Result::ok;
  }
  Result on_data(std::span<const std::uint8_t> records) {
    if (const Result room = room_for(records); room != Result::ok) {
      refused_frames += room == Result::no_space ? 1 : 0;
      return room;
    }
    const auto take_run = [this](std::uint16_t each) {
      received.runs.push_back(each);
      ++runs_;
      used_ += runs_ == 1 ? 2u : 1u;
      return Result::ok;
    };
    const auto take_line = [this](const wire::RowLine& line) {
      received.lines.push_back({line, received.runs.size() - runs_, runs_});
      runs_ = 0;
      return Result::ok;
    };
    return wire::walk_row_records(records, header.axes, state_, take_line, take_run);
  }
  Result on_end(std::uint32_t total) {
    ended = true;
    return total == header.points_total && total == received_end() ? Result::ok : Result::bad_value;
  }
  Result on_command(const wire::CommandRequest& request) {
    if (request.command == wire::Command::hold) hold(wire::HoldReason::host);
    if (request.command == wire::Command::resume) run();
    if (request.command == wire::Command::stop) state = wire::MachineState::idle;
    return Result::ok;
  }
  std::uint32_t refused_value() const { return received_end(); }
  wire::StatusSummary status_summary() const {
    wire::StatusSummary summary{state, reason, 0, false, max_lines - waiting()};
    summary.free_runs = table_places - used_;
    summary.rows = true;
    return summary;
  }
  void fill_status(wire::Status& status) const {
    static_cast<wire::StatusSummary&>(status) = status_summary();
    status.received = received_end();
    status.first_unfired = header.first_index + done_;
  }

  /// Processes up to `count` runs and headers of queued lines.
  void work(std::uint32_t count) {
    while (state == wire::MachineState::run && waiting() > 0 && count > 0) {
      const auto places = places_of(received.lines[done_]);
      const std::uint32_t now = std::min(count, places - burnt_);
      burnt_ += now;
      used_ -= now;
      count -= now;
      if (burnt_ < places) break;
      burnt_ = 0;
      ++done_;
    }
    if (state != wire::MachineState::run) return;
    if (ended && waiting() == 0) state = wire::MachineState::idle;
    if (!ended && waiting() == 0 && done_ > 1) ++waited;
  }
  void hold(wire::HoldReason why) {
    state = wire::MachineState::hold;
    reason = why;
  }
  void run() {
    state = wire::MachineState::run;
    reason = wire::HoldReason::none;
  }
  std::uint32_t done() const { return done_; }

  wire::JobHeader header;
  wire::MachineState state = wire::MachineState::idle;
  wire::HoldReason reason = wire::HoldReason::none;
  Result begin_result = Result::ok;
  bool ended = false;
  int begins = 0;
  int refused_frames = 0;  ///< no room in the table
  int waited = 0;          ///< times without a queued line, except for the first two lines
  job::Rows received;

 private:
  static std::uint32_t places_of(const job::Line& line) {
    return line.runs == 0 ? 0 : static_cast<std::uint32_t>(line.runs) + 1;
  }
  std::uint32_t received_end() const {
    return header.first_index + static_cast<std::uint32_t>(received.lines.size());
  }
  std::uint32_t waiting() const {
    return static_cast<std::uint32_t>(received.lines.size()) - done_;
  }
  /// A frame is accepted as a whole or not at all.
  Result room_for(std::span<const std::uint8_t> records) const {
    wire::RowState trial = state_;
    std::uint32_t places = 0, lines = 0, runs = static_cast<std::uint32_t>(runs_);
    const auto run = [&](std::uint16_t) {
      places += ++runs == 1 ? 2u : 1u;
      return Result::ok;
    };
    const auto line = [&](const wire::RowLine&) {
      runs = 0;
      return ++lines <= wire::max_lines_a_frame ? Result::ok : Result::bad_value;
    };
    const Result result = wire::walk_row_records(records, header.axes, trial, line, run);
    if (result != Result::ok) return result;
    const bool fits = places <= table_places - used_ && lines <= max_lines - waiting();
    return fits ? Result::ok : Result::no_space;
  }

  wire::RowState state_;
  std::size_t runs_ = 0;     ///< runs since the last line
  std::uint32_t used_ = 0;   ///< places of the table
  std::uint32_t done_ = 0;   ///< lines done
  std::uint32_t burnt_ = 0;  ///< places of the current line
};
static_assert(link::LinkSink<FakeRowMachine>);

/// A bad cable with a link and such a machine at its end.
class RowCable : public BadCable {
 public:
  using BadCable::BadCable;

  FakeRowMachine machine;
  link::Link link;
  std::uint32_t places_per_ms = 3;  ///< 0.1 mm of grey pixels at 300 mm/s

 private:
  void machine_receive(std::span<const std::uint8_t> bytes) override {
    link.receive(bytes, machine);
  }
  void machine_reconnected() override { link.new_connection(); }
  void machine_run() override {
    if (now().count() % 1000 == 0) machine.work(places_per_ms);
    link.poll(machine);
  }
  std::size_t machine_transmit(std::span<std::uint8_t> bytes) override {
    return link.transmit(bytes);
  }
};

}  // namespace lamplock::test
