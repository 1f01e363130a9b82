#include "host/program/program_path.hpp"

#include <fmt/format.h>

#include <cmath>

#include "firmware/program/interpreter.hpp"
#include "host/error.hpp"
#include "host/program/board_lines.hpp"
#include "host/program/file_line.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/line_fault.hpp"
#include "host/text.hpp"

namespace lamplock::program_run {
namespace {

using program::Action;
using program::ActionKind;

constexpr double place_unit = static_cast<double>(program::one_e7);

PerAxis<double> place_mm(const program::Place& place_e7) {
  PerAxis<double> mm{};
  for (std::size_t a = 0; a < mm.size(); ++a) mm[a] = static_cast<double>(place_e7[a]) / place_unit;
  return mm;
}

double distance_mm(const PerAxis<double>& from, const PerAxis<double>& to) {
  double squares = 0;
  for (std::size_t a = 0; a < from.size(); ++a) squares += (to[a] - from[a]) * (to[a] - from[a]);
  return std::sqrt(squares);
}

const char* refused_kind(ActionKind kind) {
  switch (kind) {
    case ActionKind::pixels:
      return "pixels of a row";
    case ActionKind::tool_change:
      return "a tool change";
    case ActionKind::beat_lock:
      return "points on the beat";
    case ActionKind::output:
      return "an output";
    case ActionKind::wait_input:
      return "a wait for an input";
    case ActionKind::probe:
      return "a probe";
    default:
      return nullptr;
  }
}

/// Collects the actions of a program.
class PathReader {
 public:
  PathReader(const std::string& file, bool has_laser, const PerAxis<double>& start_mm)
      : file_(file), has_laser_(has_laser), at_(start_mm) {}

  void take(const Action& action, std::size_t line) {
    if (const char* what = refused_kind(action.kind); what != nullptr)
      throw Error(Exit::bad_input, fmt::format("{}:{}", file_, line),
                  fmt::format("{} is not part of a path of lines and arcs", what),
                  "give the parts before and after this line");
    switch (action.kind) {
      case ActionKind::move:
        move(action, line);
        return;
      case ActionKind::dwell:
        dwell(action, line);
        return;
      case ActionKind::coolant:
        coolant(action);
        return;
      case ActionKind::pause:
        text("M0");
        return;
      case ActionKind::overrides:
        text(action.overrides_off ? "M49" : "M48");
        return;
      case ActionKind::program_end:
        text("M2");
        return;
      case ActionKind::spindle:
        spindle(action);
        return;
      default:
        return;
    }
  }

  std::vector<PathStep> steps() && { return std::move(steps_); }

 private:
  void text(std::string line) { steps_.push_back({{}, std::move(line), 0}); }

  /// The light of a dwell (setting 936) depends on the state before it: this is written, too.
  void dwell(const Action& action, std::size_t line) {
    PathMove light;
    light.line = line;
    if (laser_of(action) == PathLaser::constant) {
      light.laser = PathLaser::constant;
      light.s = action.speed_milli / 1e3;
      // G1 needs a feed; each of the moves brings its own.
      text(fmt::format("M3 S{:g} G1 F1", light.s));
    } else if (has_laser_ && (steps_.empty() || steps_.back().text != "M5")) {
      text("M5");
    }
    const double seconds = action.time_us / 1e6;
    steps_.push_back({light, fmt::format("G4 P{:g}", seconds), seconds});
  }

  void coolant(const Action& action) {
    text("M9");
    if (action.mist) text("M7");
    if (action.flood) text("M8");
  }

  void spindle(const Action& action) {
    if (action.spindle == program::Spindle::off)
      text("M5");
    else if (!has_laser_)
      text(fmt::format("{} S{:g}", action.spindle == program::Spindle::constant ? "M3" : "M4",
                       action.speed_milli / 1e3));
  }

  PathLaser laser_of(const Action& action) const {
    if (action.rapid || !has_laser_) return PathLaser::none;
    switch (action.spindle) {
      case program::Spindle::constant:
        return PathLaser::constant;
      case program::Spindle::proportional:
        return PathLaser::proportional;
      default:
        return PathLaser::off;
    }
  }

  void move(const Action& action, std::size_t line) {
    const PerAxis<double> to = place_mm(action.target_e7);
    if (!in_curve_) {
      PathMove begun;
      begun.line = line;
      begun.rapid = action.rapid;
      begun.laser = laser_of(action);
      begun.s = action.speed_milli / 1e3;
      begun.feed_mm_s = action.feed_um_min / 60e3;
      begun.vertices = {at_};
      steps_.push_back({begun, "", 0});
      timed_s_ = 0;
    }
    steps_.back().move.vertices.push_back(to);
    if (action.timed) set_timed_feed(action);
    at_ = to;
    in_curve_ = !action.programmed_end;
  }

  /// G93: the feed follows from the time of all chords.
  void set_timed_feed(const Action& action) {
    PathMove& move = steps_.back().move;
    timed_s_ += action.time_us / 1e6;
    double length = 0;
    for (std::size_t i = 1; i < move.vertices.size(); ++i)
      length += distance_mm(move.vertices[i - 1], move.vertices[i]);
    if (timed_s_ > 0) move.feed_mm_s = length / timed_s_;
  }

  const std::string& file_;
  const bool has_laser_;
  PerAxis<double> at_;
  bool in_curve_ = false;
  double timed_s_ = 0;
  std::vector<PathStep> steps_;
};

}  // namespace

std::vector<PathStep> program_path(std::string_view text, const settings::Values& values,
                                   const std::string& file, const PerAxis<double>& start_mm) {
  program::Parameters parameters;
  const program::Options options = program_options(values);
  program::Interpreter interpreter(parameters, options);
  program::Place start_e7{};
  for (std::size_t a = 0; a < start_e7.size(); ++a)
    start_e7[a] = std::llround(start_mm[a] * place_unit);
  interpreter.set_position(start_e7);
  PathReader reader(file, values.whole(settings::Id::laser_mode) != 0, place_mm(start_e7));
  text = without_byte_order_mark(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    if (trimmed(line).empty() || is_board_line(trimmed(line))) continue;
    const FileLine read(line);
    if (const program::Fault fault = read.run(interpreter); fault) {
      const LineFault seen =
          describe_fault(read.text(), fault, values.whole(settings::Id::axes), &interpreter);
      throw Error(Exit::bad_input, fmt::format("{}:{}", file, number),
                  fmt::format("error:{} {}", static_cast<int>(fault.error), seen.text),
                  seen.remedy.empty() ? "correct the line" : seen.remedy);
    }
    Action action;
    while (interpreter.next(action)) reader.take(action, number);
  }
  return std::move(reader).steps();
}

}  // namespace lamplock::program_run
