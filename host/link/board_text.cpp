#include "host/link/board_text.hpp"

#include <fmt/format.h>

#include <array>

#include "host/text.hpp"
#include "shared/gcode_errors.hpp"

namespace lamplock::link {
namespace {

/// Texts of alarms by their number; those of grbl 1.1, and of grblHAL where grbl has none.
constexpr std::array<std::string_view, 18> alarm_texts{
    "",
    "a limit switch engaged, the position is lost",
    "the target is outside the work space",
    "reset while moving, the position is lost",
    "the probe was already in its final state",
    "the probe found nothing",
    "reset while homing",
    "the door was opened while homing",
    "the limit switch stays engaged after pull-off",
    "homing found no limit switch",
    "emergency stop, the position is lost",
    "the machine must be homed",
    "a limit switch is engaged",
    "the probe is protected",
    "the spindle does not reach its speed",
    "the second switch of an axis was not found",
    "the self test failed",
    "a drive reports a fault",
};

/// Removes and returns the text before the next separator.
std::string_view take_part(std::string_view& text, char separator) {
  const auto end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  return part;
}

std::vector<double> numbers(std::string_view text) {
  std::vector<double> result;
  while (!text.empty()) {
    const auto value = number_of<double>(take_part(text, ','));
    if (!value) return {};
    result.push_back(*value);
  }
  return result;
}

void take_state(std::string_view text, BoardStatus& status) {
  status.state = take_part(text, ':');
  if (const auto number = number_of<int>(text)) status.substate = *number;
}

void take_field(std::string_view field, BoardStatus& status) {
  const std::string_view name = take_part(field, ':');
  if (name == "MPos" || name == "WPos") {
    status.position = numbers(field);
    status.of_work = name == "WPos";
  } else if (name == "WCO") {
    status.work_offset = numbers(field);
  } else if (name == "Bf") {
    status.free_lines = number_of<std::size_t>(take_part(field, ','));
    if (const auto bytes = number_of<std::size_t>(field)) status.free_bytes = bytes;
  } else if (name == "FS") {
    const std::vector<double> rates = numbers(field);
    if (rates.size() != 2) return;
    status.feed = rates[0];
    status.speed = rates[1];
  } else if (name == "Ln") {
    status.line = number_of<std::size_t>(field).value_or(0);
  } else if (name == "Ov") {
    status.overrides.clear();
    while (!field.empty())
      status.overrides.push_back(number_of<int>(take_part(field, ',')).value_or(0));
  }
}

std::optional<int> number_behind(std::string_view line, std::string_view prefix) {
  if (!line.starts_with(prefix)) return std::nullopt;
  return number_of<int>(line.substr(prefix.size()));
}

}  // namespace

std::optional<BoardStatus> parse_status(std::string_view line) {
  if (line.size() < 3 || line.front() != '<' || line.back() != '>') return std::nullopt;
  line = line.substr(1, line.size() - 2);
  BoardStatus status;
  take_state(take_part(line, '|'), status);
  while (!line.empty()) take_field(take_part(line, '|'), status);
  return status;
}

std::optional<int> parse_answer(std::string_view line) {
  if (line == "ok") return 0;
  return number_behind(line, "error:");
}

std::optional<int> parse_alarm(std::string_view line) { return number_behind(line, "ALARM:"); }

bool is_banner(std::string_view line) {
  return line.starts_with("Grbl ") || line.starts_with("GrblHAL ");
}

bool take_identity(std::string_view line, BoardIdentity& identity) {
  const bool version = line.starts_with("[VER:"), options = line.starts_with("[OPT:");
  if ((!version && !options) || line.back() != ']') return false;
  line = line.substr(5, line.size() - 6);
  if (version) {
    identity.version = line;
    return true;
  }
  identity.options = take_part(line, ',');
  identity.planner_lines = number_of<std::size_t>(take_part(line, ',')).value_or(0);
  if (const auto bytes = number_of<std::size_t>(take_part(line, ',')))
    identity.window_bytes = *bytes;
  return true;
}

std::string message_text(std::string_view line) {
  constexpr std::string_view begin = "[MSG:";
  if (line.starts_with(begin) && line.ends_with(']'))
    return std::string(line.substr(begin.size(), line.size() - begin.size() - 1));
  if (const auto alarm = parse_alarm(line)) return alarm_text(*alarm);
  return std::string(line);
}

std::string error_text(int number) {
  constexpr int most = 255;
  const GcodeErrorRow* row =
      number < 0 || number > most ? nullptr : find_gcode_error(static_cast<std::uint8_t>(number));
  return fmt::format("error:{} {}", number, row == nullptr ? "unknown to this program" : row->text);
}

std::string alarm_text(int number) {
  const auto place = static_cast<std::size_t>(number);
  const bool known = number > 0 && place < alarm_texts.size();
  return fmt::format("ALARM:{} {}", number, known ? alarm_texts[place] : "unknown to this program");
}

}  // namespace lamplock::link
