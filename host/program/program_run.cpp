#include "host/program/program_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "firmware/machine/input_wait.hpp"
#include "firmware/machine/line_work.hpp"
#include "firmware/machine/program_horizon.hpp"
#include "firmware/machine/program_motion.hpp"
#include "firmware/machine/program_reader.hpp"
#include "firmware/program/interpreter.hpp"
#include "host/error.hpp"
#include "host/text.hpp"
#include "shared/boards/pico_pins.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::program_run {
namespace {

using program::Action;
using program::ActionKind;
using settings::Id;

/// Limits are those of ticks of their nominal length; which beat they are made for does not matter.
constexpr std::uint32_t some_beat_ticks = ticks_per_second / 100;
/// A board that takes all that the cable brings, USB at full speed: 19 packets of 64 bytes in a
/// millisecond, looked at four times in it; and the ticks that it has filled.
constexpr std::uint64_t round_ticks = ticks_per_second / 4000;
constexpr std::size_t bytes_per_round = 19 * 64 / 4;
constexpr std::uint64_t filled_ticks = 9 * round_ticks;
constexpr double e7 = static_cast<double>(program::one_e7);
constexpr std::string_view axis_names = "XYZA";

/// For a machine that cannot be.
Error no_motion(const settings::Values& values) {
  motion::Limits limits;
  std::uint16_t setting = 0;
  motion::make_limits(values, some_beat_ticks, full_tick_q16, limits, setting);
  return {Exit::bad_input, fmt::format("${}", setting), "no motion is possible with it",
          "change the profile of the machine"};
}

/// Lines on their way through the planner as the board feeds it: how many it knows of when it plans
/// a batch is what a plan depends on beside the lines themselves.
class Lines {
 public:
  /// Throws Error(bad_input).
  explicit Lines(const settings::Values& values) {
    stepper::MotionState rest;
    for (stepper::AxisState& axis : rest.axis) axis.position_q64 = stepper::middle_of_step(0);
    if (work_->begin(values, some_beat_ticks, full_tick_q16, rest, no_powers_) != Result::ok)
      throw no_motion(values);
  }

  /// So many bytes come over the cable.
  void receive(std::size_t bytes) {
    bytes_ += bytes;
    for (; bytes_ > bytes_per_round; bytes_ -= bytes_per_round) round();
  }
  void take(const motion::LineTarget& line) {
    while (work_->inbox().full()) round();
    work_->inbox().push(line);
  }
  /// Lets the machine come to rest.
  void finish() {
    while (!work_->drained() || now_ < end_) round();
  }
  void dwell(std::uint32_t us) {
    finish();
    now_ += us / us_per_tick;
  }
  /// In motion.
  std::uint64_t ticks() const { return ticks_; }

 private:
  static constexpr std::uint32_t us_per_tick = 1'000'000 / ticks_per_second;

  /// Of the main loop: see ProgramRunner::wants_batch() and start_tick().
  void round() {
    now_ += round_ticks;
    const std::uint64_t head = now_ + filled_ticks;
    const bool rests = work_->ends_at_rest();
    if (work_->drained() || (!rests && end_ >= head + machine::horizon_ticks)) return;
    if (rests) end_ = std::max(end_, head + machine::start_margin_ticks);
    work_->start({});
    while (work_->advance()) {
    }
    for (std::uint32_t i = 0; i < work_->count(); ++i) {
      ticks_ += work_->segment(i).segment.ticks;
      end_ += work_->segment(i).segment.ticks;
    }
    work_->accept();
  }

  /// What the laser does along a line does not change how it is run.
  const stepper::PowerTable no_powers_;
  std::unique_ptr<machine::LineWork> work_ = std::make_unique<machine::LineWork>();
  std::size_t bytes_ = 0;  ///< that have come in this round
  std::uint64_t now_ = 0, end_ = 0, ticks_ = 0;
};

/// The machine: its lines, and its position.
class Machine {
 public:
  explicit Machine(const settings::Values& values)
      : values_(values), space_(work_space(values)), lines_(values) {
    run_.axes = values.whole(Id::axes);
  }

  ProgramRun& result() { return run_; }

  /// A line of the text comes over the cable.
  void receive(std::size_t bytes) { lines_.receive(bytes); }

  /// Does what the interpreter says; false at the end of the program.
  bool take(const Action& action, std::size_t line) {
    switch (action.kind) {
      case ActionKind::move:
      case ActionKind::probe:
        move(action, line);
        row_.clear();
        return true;
      case ActionKind::pixels:
        row_.push_back(action);
        return true;
      case ActionKind::dwell:
        lines_.dwell(action.time_us);
        run_.dwell_us += action.time_us;
        return true;
      case ActionKind::spindle:
      case ActionKind::coolant:
        if (values_.whole(Id::laser_mode) == 0) finish();
        return true;
      case ActionKind::pause:
      case ActionKind::tool_change:
        finish();
        ++run_.pauses;
        return true;
      case ActionKind::program_end:
        run_.ended = true;
        return false;
      case ActionKind::beat_lock:
      case ActionKind::wait_input:
        finish();
        return true;
      case ActionKind::output:
        return true;
    }
    return true;
  }

  void finish() {
    lines_.finish();
    run_.ticks = lines_.ticks();
  }

 private:
  void move(const Action& action, std::size_t line) {
    motion::LineTarget target = machine::line_target(action, values_);
    target.pixels = target.pulses = false;
    const int outside = machine::axis_outside(target.steps, space_, run_.axes);
    if (outside >= 0) {
      problem_outside(action, line, outside);
      return;
    }
    note_row(action);
    lines_.take(target);
  }

  void problem_outside(const Action& action, std::size_t line, int axis) {
    const double low = values_.milli(Id::min_corner_x, axis) / 1e3;
    run_.problems.push_back(
        {line, 0, 0,
         fmt::format("{} {:.3f} mm is outside of the work space, {:.3f} to {:.3f} mm",
                     axis_names[index(axis)],
                     static_cast<double>(action.target_e7[index(axis)]) / e7, low,
                     low + values_.milli(Id::travel_x, axis) / 1e3)});
  }

  /// A move, or each run of equal pixels of one.
  void note_row(const Action& move) {
    double all = 0, passed = 0;
    for (const Action& run : row_) all += run.pixels;
    all += move.pixels;
    const PerAxis<double> from = at_;
    for (const Action& run : row_) {
      passed += run.pixels;
      Action piece = run;
      for (std::size_t a = 0; a < from.size(); ++a) {
        const auto to = static_cast<double>(move.target_e7[a]);
        piece.target_e7[a] = std::llround(from[a] * e7 + (to - from[a] * e7) * passed / all);
      }
      note(piece);
    }
    note(move);
  }

  void note(const Action& action) {
    Piece piece;
    piece.from = at_;
    piece.rapid = action.rapid;
    if (action.spindle != program::Spindle::off && !action.rapid)
      piece.power =
          machine::power_of(action.speed_milli, values_) / static_cast<double>(motion::full_power);
    double squares = 0;
    for (std::size_t a = 0; a < at_.size(); ++a) {
      at_[a] = static_cast<double>(action.target_e7[a]) / e7;
      squares += (at_[a] - piece.from[a]) * (at_[a] - piece.from[a]);
      run_.bounds.low[a] = std::min(run_.bounds.low[a], at_[a]);
      run_.bounds.high[a] = std::max(run_.bounds.high[a], at_[a]);
    }
    piece.to = at_;
    ++run_.moves;
    if (action.beat_lock != program::BeatLock::off) ++run_.locked;
    (piece.rapid ? run_.rapid_mm : run_.feed_mm) += std::sqrt(squares);
    run_.pieces.push_back(piece);
  }

  const settings::Values& values_;
  const StepLimits space_;
  Lines lines_;
  PerAxis<double> at_{};
  std::vector<Action> row_;  ///< of pixels, but for the last ones
  ProgramRun run_;
};

std::string text_of(GcodeError error) {
  for (const GcodeErrorRow& row : gcode_errors)
    if (row.error == error) return std::string(row.text);
  return "unknown";
}

/// Of the board that the settings are for.
machine::ProgramPorts ports_of(const settings::Values& values) {
  const auto map = static_cast<boards::PinMap>(values.whole(Id::pin_map));
  const bool has_input = boards::find_gpio(map, boards::Role::aux_in).has_value();
  return {boards::program_outputs(map),
          machine::program_inputs(machine::set_of(machine::Input::probe) |
                                  (has_input ? machine::set_of(machine::Input::aux) : 0u))};
}

}  // namespace

double ProgramRun::seconds() const {
  if (beats.seconds > 0) return beats.seconds;
  return static_cast<double>(ticks) / ticks_per_second + static_cast<double>(dwell_us) / 1e6;
}

ProgramRun run_program(std::string_view text, const settings::Values& values,
                       std::size_t most_problems) {
  const std::string_view whole = text;
  program::Parameters parameters;
  const program::Options options = machine::program_options(values, true, ports_of(values));
  program::Interpreter interpreter(parameters, options);
  Machine machine(values);
  ProgramRun& run = machine.result();
  bool more = true;
  text = without_byte_order_mark(text);
  for (std::size_t number = 1; more && !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    machine.receive(line.size() + 1);
    if (line.empty() || line.starts_with('$')) continue;
    ++run.lines;
    program::Fault fault;
    if (line.size() > wire::max_line)
      fault = {GcodeError::line_too_long, static_cast<std::uint16_t>(wire::max_line + 1)};
    else
      fault = interpreter.run(line);
    if (fault)
      run.problems.push_back(
          {number, fault.column, static_cast<int>(fault.error), text_of(fault.error)});
    Action action;
    while (more && interpreter.next(action)) more = machine.take(action, number);
    if (run.problems.size() >= most_problems) break;
  }
  machine.finish();
  if (run.locked != 0 && run.problems.empty()) run.beats = run_locked(whole, values);
  return std::move(run);
}

}  // namespace lamplock::program_run
