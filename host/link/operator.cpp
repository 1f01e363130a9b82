#include "host/link/operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>
#include <string_view>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/line_console.hpp"
#include "host/link/not_ready.hpp"
#include "host/link/not_stopped.hpp"
#include "shared/units.hpp"

namespace lamplock::link {
namespace {

/// Positions are reported with three decimals; a step may lie between them.
constexpr double same_place_mm = 0.01;
/// A dwell is answered when everything before it has been done.
constexpr const char* wait_for_rest = "G4 P0";
constexpr const char* home_line = "$H";

using Time = std::chrono::microseconds;
/// A hold or reset byte may be lost and is repeated; max_stop_time includes braking.
constexpr Time state_poll_interval{1'000}, repeat_stop{50'000}, max_stop_time{5'000'000};

/// Numbers of "[G54:1.000,2.000,0.000]"; empty if the line is another one.
std::optional<std::vector<double>> parse_place(std::string_view line, std::string_view name) {
  if (!line.starts_with('[') || !line.ends_with(']')) return std::nullopt;
  line = line.substr(1, line.size() - 2);
  if (!line.starts_with(name) || line.substr(name.size(), 1) != ":") return std::nullopt;
  std::vector<double> place;
  const char *at = line.data() + name.size() + 1, *end = line.data() + line.size();
  for (;;) {
    double value = 0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc{}) return std::nullopt;
    place.push_back(value);
    if (rest == end || *rest != ',') return place;
    at = rest + 1;
  }
}

std::vector<double> place_in(const Answer& answer, std::string_view name) {
  for (const std::string& line : answer.lines)
    if (auto place = parse_place(line, name)) return *place;
  throw Error(Exit::job_failed, "machine", fmt::format("does not report position {}", name),
              "check that its firmware supports $#");
}

/// The machine position, from a report of machine or work position ($10).
std::vector<double> machine_place(const BoardStatus& status) {
  std::vector<double> place = status.position;
  if (status.of_work) {
    if (status.work_offset.size() != place.size())
      throw Error(Exit::job_failed, "machine", "reports its position without the work offset",
                  "set $10=1");
    for (std::size_t a = 0; a < place.size(); ++a) place[a] += status.work_offset[a];
  }
  if (place.empty())
    throw Error(Exit::job_failed, "machine", "does not report its position", "set $10=1");
  return place;
}

/// True if G92 or a tool length is in force.
bool is_shifted(const Answer& answer) {
  const auto not_zero = [](double mm) { return mm != 0; };
  for (const std::string& line : answer.lines)
    for (const char* name : {"G92", "TLO"})
      if (const auto place = parse_place(line, name))
        if (std::any_of(place->begin(), place->end(), not_zero)) return true;
  return false;
}

/// Positions in inches would be read as mm, and the machine would move to wrong positions.
void require_mm(LinePort& port) {
  constexpr std::uint32_t report_inches = 13;  // $13, grbl 1.1
  const BoardSettings kept = read_settings(port);
  const auto found = kept.texts.find(report_inches);
  if (found == kept.texts.end() || found->second == "0") return;
  throw Error(Exit::job_failed, "machine", "reports positions in inches", "set $13=0");
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return std::fabs(x - y) < same_place_mm; });
}

std::string with_zeros(std::string line, std::size_t axes) {
  for (std::size_t a = 0; a < axes; ++a) line += fmt::format(" {}0", axis_letters[a]);
  return line;
}

std::string teaching_line(const Places& places, const std::string& axes) {
  const std::size_t count = std::min(places.machine.size(), axis_letters.size());
  if (axes.empty()) return with_zeros("G10 L20 P1", count);
  std::string line = "G10 L20 P1";
  for (const char letter : axes) {
    if (axis_letters.substr(0, count).find(letter) == std::string_view::npos)
      throw Error(Exit::bad_input, fmt::format("--axes {}", axes),
                  fmt::format("the machine has no axis '{}'", letter),
                  fmt::format("use letters of {}", axis_letters.substr(0, count)));
    if (line.find(letter, line.find('P')) != std::string::npos)
      throw Error(Exit::bad_input, fmt::format("--axes {}", axes), "names an axis twice",
                  "name each axis once");
    line += fmt::format(" {}0", letter);
  }
  return line;
}

/// Moves to `target` with the laser off by the line `there`. Stores the current position as G30,
/// unless the machine is at the target already, as after the same command.
std::vector<std::string> leave_for(const std::vector<double>& target, const std::string& there,
                                   const Places& places) {
  std::vector<std::string> lines{"M5"};
  if (!same(places.machine, target)) lines.emplace_back("G30.1");
  lines.push_back(there);
  lines.emplace_back(wait_for_rest);
  return lines;
}

/// Reads reports for `time`; true if the last one says that the machine is at rest.
bool seen_standing(LinePort& port, Time time) {
  bool at_rest = false;
  const Time end = port.transport().now() + time;
  while (port.transport().now() < end) {
    port.flush();
    while (const auto line = port.receive()) {
      const auto status = parse_status(*line);
      if (status) at_rest = status->is_at_rest();
    }
    port.transport().wait(state_poll_interval);
  }
  return at_rest;
}

/// Holds the machine until it reports that it is at rest, or resets it while it homes, because
/// homing ignores a hold. Throws Error(job_failed) if it does not stop.
void stop(LinePort& port, bool homes) {
  port.drop_unbegun_lines();
  const Time end = port.transport().now() + max_stop_time;
  bool was_at_rest = false;
  while (port.transport().now() < end) {
    if (!was_at_rest) port.send_realtime(homes ? realtime::reset : realtime::hold);
    port.send_realtime(realtime::status);
    const bool at_rest = seen_standing(port, repeat_stop);
    // The board may have sent the first report before it read the byte.
    if (at_rest && was_at_rest) return;
    was_at_rest = at_rest;
  }
  throw NotStopped(Exit::job_failed, "machine", "could not be stopped; it may still move",
                   "press its emergency stop");
}

}  // namespace

Places ask_places(LinePort& port) {
  require_mm(port);
  Places places;
  const BoardStatus status = greet(port).status;
  places.state = status.state;
  places.machine = machine_place(status);
  const Answer answer = ask(port, "$#");
  if (answer.error != 0)
    throw Error(Exit::job_failed, "machine",
                fmt::format("does not report its stored positions: {}", error_text(answer.error)),
                "wait until it is idle");
  places.zero = place_in(answer, "G54");
  places.sample = place_in(answer, "G28");
  places.left = place_in(answer, "G30");
  places.shifted = is_shifted(answer);
  return places;
}

void require_unshifted(const Places& places) {
  if (places.shifted)
    throw Error(Exit::job_failed, "machine", "G92 or a tool length offset shifts its coordinates",
                "send G92.1 and G49 first");
}

std::vector<std::string> lines_of(Operation operation, const Places& places,
                                  const std::string& axes) {
  if (operation == Operation::zero || operation == Operation::init) require_unshifted(places);
  switch (operation) {
    case Operation::home:
      return {home_line};
    case Operation::zero:
      return {teaching_line(places, axes)};
    case Operation::init:
      return leave_for(
          places.zero,
          with_zeros("G90 G54 G0", std::min(places.machine.size(), axis_letters.size())), places);
    case Operation::sample:
      return leave_for(places.sample, "G28", places);
    case Operation::teach_sample:
      return {"G28.1"};
    case Operation::restore:
      return {"M5", "G30", wait_for_rest};
  }
  return {};
}

void require_ready(LinePort& port, Operation operation) {
  const BoardStatus status = greet(port).status;
  if (status.rests() || (operation == Operation::home && status.is("Alarm"))) return;
  const NotReady reason = why_not_ready(status, port.transport().board(), ask_homing(port));
  throw Error(Exit::job_failed, "machine", reason.what, reason.remedy);
}

namespace {

/// Throws the failure of a line, with the way out of an alarm. Nothing was done if the first line
/// was refused.
[[noreturn]] void throw_failure(LinePort& port, const std::string& line, bool is_first,
                                const std::string& text) {
  const std::string what = fmt::format("'{}': {}", line, text);
  if (text.find("ALARM:") == std::string::npos)
    throw Error(is_first ? Exit::bad_input : Exit::job_failed, "machine", what,
                text.starts_with("error:5 ") ? "lamplock settings set homing=1 switches it on"
                : is_first                   ? "nothing was done"
                                             : "later lines were not sent");
  const std::string cause = line == home_line
                                ? "check the limit switches, their wiring and the settings of "
                                  "homing ($23 to $27)"
                                : "find the cause";
  throw Error(
      Exit::job_failed, "machine", what,
      fmt::format("{}, then {}", cause, way_to_unlock(port.transport().board(), ask_homing(port))));
}

}  // namespace

void run_lines(LinePort& port, const std::vector<std::string>& lines,
               const std::function<bool()>& is_cancelled) {
  LineConsole talk(port, true, [](const std::string&) {});
  for (const std::string& line : lines) talk.type(line);
  while (!talk.failure() && !talk.done()) {
    talk.step();
    if (!is_cancelled()) continue;
    const bool homes = std::find(lines.begin(), lines.end(), home_line) != lines.end();
    stop(port, homes);
    if (homes)
      throw Error(Exit::interrupted, "machine", "was reset during homing", "home it again");
    const NotReady held = why_held(port.transport().board());
    throw Error(Exit::interrupted, "machine", held.what, held.remedy);
  }
  if (!talk.failure()) return;
  const std::size_t failed = talk.failure()->line - 1;
  throw_failure(port, lines[failed], failed == 0, talk.failure()->text);
}

}  // namespace lamplock::link
