#include "host/program/program_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/machine/runners/program_motion.hpp"
#include "firmware/program/interpreter.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/board_lines.hpp"
#include "host/program/file_line.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/line_fault.hpp"
#include "host/program/line_thread.hpp"
#include "host/text.hpp"
#include "shared/units.hpp"
#include "shared/wire/run_pace.hpp"
#include "shared/wire/runs.hpp"
#include "shared/work_space.hpp"

namespace lamplock::program_run {
namespace {

using program::Action;
using program::ActionKind;
using settings::Id;

constexpr double e7 = static_cast<double>(program::one_e7);
/// A board reports position and offsets in thousandths of a millimetre: error of their sum, 10^-7
/// mm.
constexpr std::int64_t report_tolerance_e7 = 20'000;

/// The machine: its lines, and its position.
class Machine {
 public:
  explicit Machine(const settings::Values& values)
      : values_(values), space_(work_space(values)), lines_(values) {
    run_.axes = values.whole(Id::axes);
    run_.rotary = is_rotary(values, rotary_axis);
  }

  ProgramRun& result() { return run_; }

  /// Starts at the position that a board reports.
  void begin_at(const program::Place& place_e7) {
    tolerance_e7_ = report_tolerance_e7;
    for (std::size_t a = 0; a < at_.size(); ++a) at_[a] = static_cast<double>(place_e7[a]) / e7;
    run_.bounds = {at_, at_};
    Action there;
    there.rapid = true;
    there.target_e7 = place_e7;
    motion::LineTarget target;
    machine::find_target(there, values_, target);
    if (target.steps == StepPosition{}) return;
    lines_.take(target);
    lines_.finish();
    ticks_before_ = lines_.wait().ticks();
  }
  /// Motion outside of the work space is only counted, not reported as a problem.
  void pass_outside() { passes_outside_ = true; }

  void change_speed(const std::vector<SpeedChange>& changes) {
    lines_.wait().change_speed(changes);
  }

  /// A line of the text arrives over the cable.
  void receive(std::size_t bytes) { lines_.receive(bytes); }

  /// Whether a line that is a curve or a cycle stays inside; if not, it is a problem of the line.
  bool inside(const program::Extent& extent, std::size_t line) {
    if (passes_outside_) return true;
    for (const program::Place& corner : {extent.low(), extent.high()}) {
      const int outside = axis_outside(corner, machine::steps_of(corner, values_));
      if (outside < 0) continue;
      problem_outside(corner, line, outside);
      return false;
    }
    return true;
  }

  bool has_moved() const { return !dwelt_us_.empty() || run_.outside != 0; }

  /// After each line without an error.
  void note_modes(const program::Modal& modal, std::size_t line) {
    if (modal.spindle != program::Spindle::off && modal.speed_milli != 0) note_light(line);
    if (modal.system != 0 && run_.system_line == 0) run_.system_line = line;
  }

  /// Executes an action of the interpreter.
  void take(const Action& action, std::size_t line) {
    const bool has_light = action.spindle != program::Spindle::off && action.speed_milli != 0;
    if (has_light || action.beat_lock != program::BeatLock::off ||
        action.kind == ActionKind::output)
      note_light(line);
    switch (action.kind) {
      case ActionKind::move:
      case ActionKind::probe:
        move(action, line);
        row_.clear();
        return;
      case ActionKind::pixels:
        row_.push_back(action);
        return;
      case ActionKind::dwell:
        lines_.dwell(action.time_us);
        run_.dwell_us += action.time_us;
        return;
      case ActionKind::spindle:
      case ActionKind::coolant:
        if (values_.whole(Id::laser_mode) == 0) finish();
        return;
      case ActionKind::pause:
      case ActionKind::tool_change:
        finish();
        ++run_.pauses;
        return;
      case ActionKind::program_end:
        finish();
        run_.ended = true;
        return;
      case ActionKind::beat_lock:
      case ActionKind::wait_input:
        finish();
        return;
      case ActionKind::output:
      case ActionKind::overrides:
        return;
    }
  }

  void finish() { lines_.finish(); }

  /// At the end of the program: its time, and that of each move.
  void note_times() {
    const LineRun& lines = lines_.wait();
    run_.ticks = lines.ticks() - ticks_before_;
    const std::size_t moves = std::min(dwelt_us_.size(), lines.line_ends().size());
    run_.move_ends_s.reserve(moves);
    for (std::size_t i = 0; i < moves; ++i) {
      const auto ticks = static_cast<double>(lines.line_ends()[i] - ticks_before_);
      run_.move_ends_s.push_back(ticks / ticks_per_second +
                                 static_cast<double>(dwelt_us_[i]) / 1e6);
    }
  }

 private:
  void note_light(std::size_t line) {
    if (run_.light_line == 0) run_.light_line = line;
  }

  void move(const Action& action, std::size_t line) {
    motion::LineTarget target;
    machine::find_target(action, values_, target);
    if (target.pixels) set_row_time(action, target);
    target.pixels = target.pulses = false;
    const int outside = axis_outside(action.target_e7, target.steps);
    if (outside >= 0) {
      if (passes_outside_)
        ++run_.outside;
      else
        problem_outside(action.target_e7, line, outside);
      return;
    }
    note_row(action, line);
    dwelt_us_.push_back(run_.dwell_us);
    target.line = static_cast<std::uint32_t>(dwelt_us_.size());
    lines_.take(target);
  }

  /// First axis that is outside by more than the tolerance; -1 if there is none.
  int axis_outside(const program::Place& place_e7, const StepPosition& steps) const {
    const int outside = machine::axis_outside(steps, space_, run_.axes);
    if (outside < 0 || tolerance_e7_ == 0) return outside;
    program::Place inner = place_e7;
    for (std::size_t a = 0; a < inner.size(); ++a)
      inner[a] += steps[a] > space_.max[a]   ? -tolerance_e7_
                  : steps[a] < space_.min[a] ? tolerance_e7_
                                             : 0;
    return machine::axis_outside(machine::steps_of(inner, values_), space_, run_.axes);
  }

  void problem_outside(const program::Place& place_e7, std::size_t line, int axis) {
    // A rotary axis has no limit within the numbers of a program.
    const double low = values_.milli(Id::min_corner_x, axis) / 1e3;
    run_.problems.push_back(
        {line, 0, 0,
         fmt::format("{} {:.3f} mm is outside of the work space, {:.3f} to {:.3f} mm",
                     axis_letters[index(axis)], static_cast<double>(place_e7[index(axis)]) / e7,
                     low, low + values_.milli(Id::travel_x, axis) / 1e3)});
  }

  /// The minimum time of a move with pixels, as on the board.
  void set_row_time(const Action& move, motion::LineTarget& target) const {
    wire::RunPace pace;
    const auto add = [&pace](std::uint32_t cells) {
      while (cells != 0) {
        const std::uint32_t part = wire::run_cells(wire::max_run(0, cells));
        pace.add(part);
        cells -= part;
      }
    };
    for (const Action& run : row_) add(run.pixels);
    add(move.pixels);
    if (!target.timed || target.time_us < pace.min_us()) target.time_us = pace.min_us();
  }

  /// Records a move, or each run of equal pixels of one.
  void note_row(const Action& move, std::size_t line) {
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
      note(piece, line);
    }
    note(move, line);
  }

  void note(const Action& action, std::size_t line) {
    Piece piece;
    piece.line = line;
    piece.move = dwelt_us_.size();
    piece.from = at_;
    piece.rapid = action.rapid;
    if (action.spindle != program::Spindle::off) piece.s = action.speed_milli / 1e3;
    if (action.spindle != program::Spindle::off && !action.rapid)
      piece.power =
          machine::power_of(action.speed_milli, values_) / static_cast<double>(motion::full_power);
    double squares = 0;
    for (std::size_t a = 0; a < at_.size(); ++a) {
      at_[a] = static_cast<double>(action.target_e7[a]) / e7;
      if (!is_rotary(values_, static_cast<int>(a)))
        squares += (at_[a] - piece.from[a]) * (at_[a] - piece.from[a]);
      run_.bounds.low[a] = std::min(run_.bounds.low[a], at_[a]);
      run_.bounds.high[a] = std::max(run_.bounds.high[a], at_[a]);
    }
    piece.to = at_;
    constexpr double us_per_min = 60e6;
    if (!action.rapid)
      piece.feed_mm_min = action.timed ? std::sqrt(squares) * us_per_min / action.time_us
                                       : action.feed_um_min / 1e3;
    ++run_.moves;
    if (action.beat_lock != program::BeatLock::off) ++run_.locked;
    (piece.rapid ? run_.rapid_mm : run_.feed_mm) += std::sqrt(squares);
    run_.pieces.push_back(piece);
  }

  const settings::Values& values_;
  const StepLimits space_;
  LineThread lines_;
  PerAxis<double> at_{};
  std::int64_t tolerance_e7_ = 0;
  std::uint64_t ticks_before_ = 0;  ///< of the move to the program's begin
  bool passes_outside_ = false;
  std::vector<Action> row_;              ///< of pixels, without the last ones
  std::vector<std::uint64_t> dwelt_us_;  ///< before each move
  ProgramRun run_;
};

/// How far the position of a program may be from the one that a board reports in steps.
std::int64_t beside_e7(const settings::Values& values, int axis) {
  constexpr std::int64_t half_e7 = program::one_e7 * 1000 / 2, report_e7 = program::one_e7 / 2000;
  return half_e7 / values.milli(Id::steps_per_mm_x, axis) + report_e7;
}

/// An arc as the first motion may be valid only from a place beside the one that the board reports,
/// where its program is. An arc that ends where it begins is not: it would be valid by chance.
program::Fault run_beside(program::Interpreter& interpreter, std::string_view line,
                          const program::Fault& fault, const program::Place& start_e7,
                          const settings::Values& values) {
  constexpr int places = 27;
  const int axes = std::min(3, values.whole(Id::axes));
  const auto ends_away = [&] {
    const program::Place end_e7 = interpreter.machine_e7();
    for (int axis = 0; axis < axes; ++axis)
      if (std::abs(end_e7[index(axis)] - start_e7[index(axis)]) > beside_e7(values, axis))
        return true;
    return false;
  };
  for (int i = 0; i < places; ++i) {
    program::Place place = start_e7;
    for (int axis = 0, rest = i; axis < axes; ++axis, rest /= 3)
      place[index(axis)] += (rest % 3 - 1) * beside_e7(values, axis);
    interpreter.set_position(place);
    if (interpreter.run(line)) continue;
    if (interpreter.has_extent() && ends_away()) return {};
    Action ignored;
    while (interpreter.next(ignored)) {
    }
  }
  interpreter.set_position(start_e7);
  return fault;
}

void note_ignored(ProgramRun& run, unsigned words) {
  for (std::size_t i = 0; i < std::size(program::ignored_words); ++i)
    if ((words >> i & 1u) != 0) run.ignored.emplace_back(program::ignored_words[i]);
}

/// Why a sender would refuse a line of a file before the interpreter reads it; empty if it would
/// not. Notes that the program is not blank.
std::string text_fault(std::string_view line, ProgramRun& run, bool only_board_lines) {
  const std::string text = link::text_to_send(line);
  if (text.find_first_not_of("% \t") != std::string::npos) run.is_blank = false;
  std::string fault = link::realtime_fault(text);
  if (fault.empty() && (!only_board_lines || is_sleep(text))) fault = board_line_fault(text);
  return fault;
}

/// Runs a program through the interpreter: of a file, or as a board will run it.
ProgramRun run_lines(std::string_view text, const settings::Values& values,
                     std::size_t max_problems, const OnBoard* board,
                     const program::ToolTable& tools) {
  const std::string_view whole = text;
  program::Parameters parameters;
  parameters.tools = tools;
  const program::Options options = program_options(values);
  program::Interpreter interpreter(parameters, options);
  Machine machine(values);
  const BoardState* state = board != nullptr && board->state ? &*board->state : nullptr;
  if (state != nullptr) {
    begin_with(*state, interpreter, parameters);
    machine.begin_at(state->machine_e7);
  }
  if (board != nullptr && (state == nullptr || !board->space_known)) machine.pass_outside();
  if (board != nullptr) machine.change_speed(board->changes);
  const auto run_line = [&](const FileLine& line) {
    const program::Fault fault = line.run(interpreter);
    const bool of_arc =
        fault.error == GcodeError::bad_target || fault.error == GcodeError::bad_radius;
    if (!of_arc || state == nullptr || machine.has_moved()) return fault;
    return run_beside(interpreter, line.text(), fault, state->machine_e7, values);
  };
  ProgramRun& run = machine.result();
  std::size_t last_line = 0;
  bool nurbs_is_reported = false;
  const bool only_board_lines = board == nullptr && has_only_board_lines(text);
  text = without_byte_order_mark(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    machine.receive(line.size() + 1);
    last_line = number;
    if (trimmed(line).empty()) continue;
    const std::string fault_of_text =
        board == nullptr ? text_fault(line, run, only_board_lines) : "";
    if (!fault_of_text.empty()) run.problems.push_back({number, 0, 0, fault_of_text});
    if (run.problems.size() >= max_problems) break;
    if (is_board_line(trimmed(line)) || !fault_of_text.empty()) continue;
    ++run.lines;
    const FileLine read(line);
    const program::Fault fault = run_line(read);
    if (fault) {
      const LineFault seen = describe_fault(read.text(), fault, run.axes, &interpreter);
      run.problems.push_back({number, static_cast<unsigned>(read.column(fault.column)),
                              static_cast<int>(fault.error), seen.text, seen.remedy});
      nurbs_is_reported =
          interpreter.state().nurbs.count != 0 && fault.error == GcodeError::unsupported;
      // Otherwise every line after a corner that is too narrow would have its error.
      if (interpreter.modal().cutter != program::Cutter::off)
        interpreter.set_position(interpreter.machine_e7());
    }
    if (!fault) machine.note_modes(interpreter.modal(), number);
    if (interpreter.has_ignored()) note_ignored(run, interpreter.take_ignored());
    const bool outside =
        !fault && interpreter.has_extent() && !machine.inside(interpreter.extent(), number);
    if (outside) interpreter.set_position(interpreter.machine_e7());
    Action action;
    while (interpreter.next(action)) machine.take(action, number);
    if (run.problems.size() >= max_problems) break;
  }
  if (interpreter.holds_move())
    run.problems.push_back({last_line, 0, 0,
                            "the program ends with cutter compensation on, and its last move waits",
                            "end it with G40 or M2"});
  if (interpreter.state().nurbs.count != 0 && !nurbs_is_reported)
    run.problems.push_back({last_line, 0, 0,
                            "the program ends in a NURBS, which is not drawn before its G5.3",
                            "write G5.3 after the last control point"});
  machine.finish();
  machine.note_times();
  const bool as_after_power_up = state == nullptr ? tools.empty() : state->as_after_power_up;
  if (run.locked != 0 && run.problems.empty() && run.outside == 0 && as_after_power_up)
    run.beats = run_locked(whole, values);
  return std::move(run);
}

}  // namespace

double ProgramRun::seconds() const {
  if (beats.seconds > 0) return beats.seconds;
  return static_cast<double>(ticks) / ticks_per_second + static_cast<double>(dwell_us) / 1e6;
}

ProgramRun run_program(std::string_view text, const settings::Values& values,
                       std::size_t max_problems, const program::ToolTable& tools) {
  return run_lines(text, values, max_problems, nullptr, tools);
}

ProgramRun run_on_board(std::string_view text, const settings::Values& values,
                        const OnBoard& board) {
  return run_lines(text, values, 1, &board, {});
}

}  // namespace lamplock::program_run
