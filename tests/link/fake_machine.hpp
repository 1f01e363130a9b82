// A machine that only counts: receives the pulse stream, fires points as time passes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/link/link.hpp"
#include "firmware/motion/point_queue.hpp"
#include "firmware/program/pulse_decoder.hpp"
#include "shared/work_space.hpp"

namespace lamplock::test {

/// Sink of a link with a queue that drains.
class FakeMachine {
 public:
  // Called by the link.
  void on_realtime(std::uint8_t byte) {
    realtime.push_back(byte);
    if (state == wire::MachineState::run && byte == '!') hold(wire::HoldReason::realtime);
    const bool unfinished = state == wire::MachineState::run || state == wire::MachineState::hold;
    if (unfinished && byte == 0x18) hold(wire::HoldReason::reset);
    // A stray byte may stop the machine but must not resume it after a stop by the host.
    const bool held_by_host = reason == wire::HoldReason::host;
    if (state == wire::MachineState::hold && byte == '~' && !held_by_host) run();
  }
  void on_line(std::string_view line) { lines.emplace_back(line); }
  void on_line_too_long() { ++lost_lines; }
  Result on_begin(const wire::JobHeader& job) {
    ++begins;
    shots = 0;
    if (begin_result != Result::ok) return begin_result;
    if (state != wire::MachineState::idle) return Result::busy;
    header = job;
    decoder.begin(job);
    queue.reset(job.first_index);
    ended = false;
    run();
    return Result::ok;
  }
  Result on_data(std::span<const std::uint8_t> records) {
    if (data_result != Result::ok) return data_result;
    const std::uint32_t before = queue.end();
    const Result result = decoder.decode(records, queue, limits);
    for (std::uint32_t i = before; i != queue.end(); ++i) received.push_back(queue.at(i));
    refused = decoder.refused_index();
    return result;
  }
  Result on_end(std::uint32_t total) {
    ended = true;
    return total == header.points_total && total == queue.end() ? Result::ok : Result::bad_value;
  }
  Result on_command(const wire::CommandRequest& request) {
    const wire::Command command = request.command;
    commands.push_back(request);
    if (command == wire::Command::job_speed) job_speed = request.value;
    if (command == wire::Command::hold) hold(wire::HoldReason::host);
    if (command == wire::Command::resume) run();
    if (command == wire::Command::stop) state = wire::MachineState::idle;
    if (command == wire::Command::lamp_frequency) return Result::unsupported;
    return Result::ok;
  }
  std::uint32_t refused_value() const { return refused; }
  wire::StatusSummary status_summary() const {
    return {state, reason, alarm, lamp_locked, queue.free()};
  }
  void fill_status(wire::Status& status) const {
    ++statuses;
    static_cast<wire::StatusSummary&>(status) = status_summary();
    status.received = queue.end();
    status.first_unfired = queue.begin();
    status.shots = shots;
  }

  void fire(std::uint32_t count) {
    while (state == wire::MachineState::run && count-- > 0 && queue.size() > 0) {
      const std::uint32_t point = queue.begin();
      fired.push_back(point);
      shots += queue.at(point).shots;
      while (queue.size() > 0 && queue.begin() == point) queue.mark_done(point);
    }
    if (state == wire::MachineState::run && ended && queue.size() == 0)
      state = wire::MachineState::idle;
  }
  void hold(wire::HoldReason why) {
    state = wire::MachineState::hold;
    reason = why;
  }
  void run() {
    state = wire::MachineState::run;
    reason = wire::HoldReason::none;
  }

  motion::PointQueue queue;
  program::PulseDecoder decoder;
  StepLimits limits = work_space(settings::Values{});
  wire::JobHeader header;
  wire::MachineState state = wire::MachineState::idle;
  wire::HoldReason reason = wire::HoldReason::none;
  std::uint8_t alarm = 0;
  bool lamp_locked = false;
  mutable int statuses = 0;  ///< requested
  Result begin_result = Result::ok;
  Result data_result = Result::ok;
  std::uint32_t refused = 0;
  bool ended = false;
  int begins = 0;
  int lost_lines = 0;
  std::vector<std::uint8_t> realtime;
  std::vector<std::string> lines;
  std::vector<wire::CommandRequest> commands;
  std::uint32_t job_speed = 100;
  std::uint32_t shots = 0;
  std::vector<wire::Target> received;
  std::vector<std::uint32_t> fired;
};
static_assert(link::LinkSink<FakeMachine>);

}  // namespace lamplock::test
