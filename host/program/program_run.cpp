#include "host/program/program_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "firmware/machine/program_motion.hpp"
#include "firmware/motion/line_planner.hpp"
#include "firmware/program/interpreter.hpp"
#include "host/error.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::program_run {
namespace {

using program::Action;
using program::ActionKind;
using settings::Id;

/// Limits are those of ticks of their nominal length; which beat they are made for does not matter.
constexpr std::uint32_t some_beat_ticks = ticks_per_second / 100;
constexpr std::int64_t um_per_mm = 1000, nm_per_um = 1000;
constexpr double e7 = static_cast<double>(program::one_e7);
constexpr std::string_view axis_names = "XYZA";

program::Options options_of(const settings::Values& values) {
  program::Options options;
  options.axes = values.whole(Id::axes);
  options.arc_tolerance_e7 =
      std::int64_t{values.milli(Id::arc_tolerance)} * (program::one_e7 / um_per_mm);
  options.beat_lock = false;  // as on the board
  options.laser = values.whole(Id::laser_mode) != 0;
  return options;
}

/// Throws Error(bad_input) for a machine that cannot be.
motion::Limits limits_of(const settings::Values& values) {
  motion::Limits limits;
  std::uint16_t setting = 0;
  if (motion::make_limits(values, some_beat_ticks, full_tick_q16, limits, setting) != Result::ok)
    throw Error(Exit::bad_input, fmt::format("${}", setting), "no motion is possible with it",
                "change the profile of the machine");
  return limits;
}

motion::LineLimits line_limits_of(const settings::Values& values, const motion::Limits& limits) {
  std::int32_t coarsest = values.milli(Id::steps_per_mm_x);
  for (int a = 1; a < limits.axes; ++a)
    coarsest = std::min(coarsest, values.milli(Id::steps_per_mm_x, a));
  return motion::make_line_limits(
      limits, coarsest,
      static_cast<std::uint32_t>(values.milli(Id::junction_deviation) * nm_per_um));
}

/// The machine: planner and position.
class Machine {
 public:
  explicit Machine(const settings::Values& values)
      : values_(values), space_(work_space(values)), limits_(limits_of(values)) {
    stepper::MotionState rest;
    for (stepper::AxisState& axis : rest.axis) axis.position_q64 = stepper::middle_of_step(0);
    planner_.start(rest);
    run_.axes = values.whole(Id::axes);
  }

  ProgramRun& result() { return run_; }

  /// Does what the interpreter says; false at the end of the program.
  bool take(const Action& action, std::size_t line) {
    switch (action.kind) {
      case ActionKind::move:
      case ActionKind::probe:
        move(action, line);
        return true;
      case ActionKind::dwell:
        finish();
        run_.dwell_us += action.time_us;
        return true;
      case ActionKind::spindle:
      case ActionKind::coolant:
        if (values_.whole(Id::laser_mode) == 0) finish();
        return true;
      case ActionKind::pause:
        finish();
        ++run_.pauses;
        return true;
      case ActionKind::program_end:
        run_.ended = true;
        return false;
      case ActionKind::beat_lock:
        finish();
        return true;
    }
    return true;
  }

  /// Lets the machine come to rest.
  void finish() {
    while (step()) {
    }
  }

 private:
  bool step() {
    if (!planner_.next(made_)) return false;
    run_.ticks += made_.segment.ticks;
    return true;
  }

  void move(const Action& action, std::size_t line) {
    const motion::LineTarget target = machine::line_target(action, values_);
    const int outside = machine::axis_outside(target.steps, space_, run_.axes);
    if (outside >= 0) {
      problem_outside(action, line, outside);
      return;
    }
    note(action);
    while (!planner_.push(target)) step();
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
    (piece.rapid ? run_.rapid_mm : run_.feed_mm) += std::sqrt(squares);
    run_.pieces.push_back(piece);
  }

  const settings::Values& values_;
  const StepLimits space_;
  const motion::Limits limits_;
  const motion::LineLimits line_limits_ = line_limits_of(values_, limits_);
  std::unique_ptr<motion::LineRing> ring_ = std::make_unique<motion::LineRing>();
  motion::LinePlanner planner_{*ring_, line_limits_, limits_};
  motion::LineSegment made_;
  PerAxis<double> at_{};
  ProgramRun run_;
};

std::string text_of(GcodeError error) {
  for (const GcodeErrorRow& row : gcode_errors)
    if (row.error == error) return std::string(row.text);
  return "unknown";
}

/// Takes the next line off the front, without its end; CR, LF and both are one.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find_first_of("\r\n");
  const std::string_view line = text.substr(0, end);
  if (end == std::string_view::npos) {
    text = {};
    return line;
  }
  text.remove_prefix(end + (text.substr(end, 2) == "\r\n" ? 2 : 1));
  return line;
}

}  // namespace

double ProgramRun::seconds() const {
  return static_cast<double>(ticks) / ticks_per_second + static_cast<double>(dwell_us) / 1e6;
}

ProgramRun run_program(std::string_view text, const settings::Values& values,
                       std::size_t most_problems) {
  program::Parameters parameters;
  const program::Options options = options_of(values);
  program::Interpreter interpreter(parameters, options);
  Machine machine(values);
  ProgramRun& run = machine.result();
  bool more = true;
  for (std::size_t number = 1; more && !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    if (line.empty()) continue;
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
  return std::move(run);
}

}  // namespace lamplock::program_run
