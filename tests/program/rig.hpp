// An interpreter with its environment, and its actions as short texts for golden tables.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "firmware/program/interpreter.hpp"

namespace lamplock::program::test {

/// A number in units of 1e-7 as an exact decimal without trailing zeros.
inline std::string decimal(std::int64_t e7) {
  const bool negative = e7 < 0;
  const std::uint64_t n =
      negative ? 0 - static_cast<std::uint64_t>(e7) : static_cast<std::uint64_t>(e7);
  std::string text = std::to_string(n / 10'000'000);
  std::string fraction = std::to_string(n % 10'000'000);
  fraction.insert(0, 7 - fraction.size(), '0');
  while (!fraction.empty() && fraction.back() == '0') fraction.pop_back();
  if (!fraction.empty()) text += "." + fraction;
  return fmt::format("{}{}", negative ? "-" : "", text);
}

/// "1 2 3", plus the fourth axis if it is not zero.
inline std::string text_of(const Place& place) {
  const std::string text =
      fmt::format("{} {} {}", decimal(place[0]), decimal(place[1]), decimal(place[2]));
  return place[3] == 0 ? text : fmt::format("{} {}", text, decimal(place[3]));
}

/// Millimetres to e7.
constexpr std::int64_t mm(double x) {
  return static_cast<std::int64_t>(x * 1e7 + (x < 0 ? -0.5 : 0.5));
}
constexpr Place at(double x, double y, double z = 0, double a = 0) {
  return {mm(x), mm(y), mm(z), mm(a)};
}

inline std::string spindle_text(const Action& action) {
  if (action.spindle == Spindle::off) return "M5";
  return (action.spindle == Spindle::constant ? "M3 S" : "M4 S") +
         decimal(std::int64_t{action.speed_milli} * 10'000);
}

inline std::string motion_text(const Action& action) {
  std::string text = action.kind == ActionKind::probe ? "probe" : action.rapid ? "rapid" : "feed";
  if (action.probe_away) text += " away";
  if (action.probe_must) text += " must";
  if (action.timed) text += fmt::format(" {}us", action.time_us);
  if (!action.rapid && !action.timed)
    text += fmt::format(" {}", decimal(std::int64_t{action.feed_um_min} * 10'000));
  text += fmt::format(" to {}", text_of(action.target_e7));
  if (action.spindle != Spindle::off) text += fmt::format(" {}", spindle_text(action));
  if (action.beat_lock == BeatLock::path) text += " beat";
  if (action.beat_lock == BeatLock::free) text += " free";
  if (action.exact_stop) text += " stop";
  if (action.blend_um != 0) text += fmt::format(" blend {}", action.blend_um);
  if (!action.programmed_end) text += " on the way";
  if (action.line != 0) text += fmt::format(" N{}", action.line);
  return text;
}

inline std::string text_of(const Action& action) {
  switch (action.kind) {
    case ActionKind::move:
    case ActionKind::probe:
      return motion_text(action);
    case ActionKind::dwell:
      return fmt::format("dwell {}us", action.time_us);
    case ActionKind::spindle:
      return fmt::format("spindle {}", spindle_text(action));
    case ActionKind::coolant:
      return std::string("coolant") + (action.mist ? " mist" : "") + (action.flood ? " flood" : "");
    case ActionKind::tool_change:
      return "tool";
    case ActionKind::pause:
      return "pause";
    case ActionKind::program_end:
      return "end";
    case ActionKind::output:
      return fmt::format("output {} {}{}", action.io.port, action.io.level,
                         action.io.at_once ? " at once" : "");
    case ActionKind::wait_input:
      return fmt::format("input {} event {} {}us", action.io.port,
                         static_cast<int>(action.io.event), action.time_us);
    case ActionKind::pixels:
      return fmt::format("{} pixels", action.pixels);
    case ActionKind::overrides:
      return action.overrides_off ? "overrides off" : "overrides on";
    case ActionKind::beat_lock:
      return action.beat_lock == BeatLock::off    ? "beat off"
             : action.beat_lock == BeatLock::path ? "beat path"
                                                  : "beat free";
  }
  return "?";
}

inline std::string text_of(const Fault& fault) {
  return std::to_string(static_cast<int>(fault.error)) + "@" + std::to_string(fault.column);
}

/// The whole observable state of an interpreter and its parameters.
struct Seen {
  State state;
  Saved saved;
  std::array<Place, coordinate_systems> systems;
  Place g28, g30, shift;
  std::int64_t tool_length;
  ToolTable tools;
  std::uint16_t changed;
  bool busy;
  friend bool operator==(const Seen&, const Seen&) = default;
};

struct Rig {
  Parameters parameters;
  Options options;
  Interpreter interpreter{parameters, options};

  Rig() { options.axes = 4; }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  std::vector<Action> take() {
    std::vector<Action> actions;
    Action action;
    while (interpreter.next(action)) actions.push_back(action);
    return actions;
  }
  /// Actions of a line, or its fault ("22@1"), separated by "; ".
  std::string run(std::string_view line) { return result_of(interpreter.run(line)); }
  std::string jog(std::string_view line) { return result_of(interpreter.jog(line)); }
  /// Runs several lines, separated by '|'; returns the result of the last one.
  std::string run_all(std::string_view lines) {
    std::string last;
    for (;;) {
      const std::size_t bar = lines.find('|');
      last = run(lines.substr(0, bar));
      if (bar == std::string_view::npos) return last;
      lines.remove_prefix(bar + 1);
    }
  }
  std::string result_of(const Fault& fault) {
    if (fault) return text_of(fault);
    std::string text;
    for (const Action& action : take()) text += (text.empty() ? "" : "; ") + text_of(action);
    return text;
  }
  Place machine() const { return interpreter.machine_e7(); }

  Seen seen() const {
    return {interpreter.state(),       interpreter.saved(),    parameters.systems_e7,
            parameters.home_g28_e7,    parameters.home_g30_e7, parameters.shift_e7,
            parameters.tool_length_e7, parameters.tools,       parameters.changed,
            interpreter.busy()};
  }
};

/// A row of a golden table: lines, and the result of the last of them.
struct Row {
  const char* lines;
  const char* wanted;
};

/// Runs each row on a new machine.
template <std::size_t size>
void expect_rows(const Row (&rows)[size]) {
  for (const Row& row : rows) {
    Rig rig;
    EXPECT_EQ(rig.run_all(row.lines), row.wanted) << row.lines;
  }
}

}  // namespace lamplock::program::test
