#include "host/program/probe_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/program/parameters.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/text.hpp"

namespace lamplock::program_run {
namespace {

using program::Action;
using program::ActionKind;
using program::Place;

constexpr std::string_view answer_begin = "[MSG:probe log ";
constexpr std::size_t tool_axis = 2;

/// Runs a line as far as it can be run; whether it probes.
bool run_line(program::Interpreter& interpreter, const std::string& line) {
  if (line.empty() || line.starts_with('$') || interpreter.run(line)) return false;
  bool probes = false;
  for (Action action; interpreter.next(action);) probes |= action.kind == ActionKind::probe;
  return probes;
}

/// Two comments: an answer has at most 240 characters. The numbers of parameters: docs/gcode.md.
std::string question(std::size_t probe, std::uint8_t system) {
  constexpr int first_system = 5221, system_size = 20;
  const int row = first_system + system_size * system;
  return fmt::format(
      "(PRINT,probe log {0} a %.7f#5070 #5061 #5062 #5063 #5064 #5420 #5421 #5422 #5423)"
      "(PRINT,probe log {0} b %.7f#{1} #{2} #{3} #{4} #5210 #5211 #5212 #5213 #5214 #5403)",
      probe, row, row + 1, row + 2, row + 3);
}

/// The values of the halves, in the order of the question.
constexpr std::size_t met_value = 0, contact_values = 1, work_values = 5, first_size = 9;
constexpr std::size_t origin_values = 0, shifted_value = 4, shift_values = 5, tool_value = 9,
                      second_size = 10;

Place place_of(const std::vector<double>& values, std::size_t first, bool inches = false) {
  Place place{};
  for (std::size_t a = 0; a < place.size(); ++a)
    place[a] = std::llround(values[first + a] *
                            static_cast<double>(inches ? program::inch_e7 : program::one_e7));
  return place;
}

}  // namespace

std::vector<std::string> log_names(const std::vector<link::ProgramLine>& lines) {
  std::vector<std::string> names;
  for (const link::ProgramLine& line : lines)
    for (const std::string& log : line.logs)
      if (std::string name = link::probe_log_name(log);
          !name.empty() && std::ranges::find(names, name) == names.end())
        names.push_back(std::move(name));
  return names;
}

LoggedProgram with_probe_questions(std::vector<link::ProgramLine> lines,
                                   const settings::Values& values, const BoardState& state) {
  if (log_names(lines).empty()) return {std::move(lines), {}};
  program::Parameters parameters;
  const program::Options options = program_options(values);
  program::Interpreter interpreter(parameters, options);
  begin_with(state, interpreter, parameters);
  LoggedProgram logged;
  std::string log;
  for (link::ProgramLine& line : lines) {
    for (const std::string& comment : line.logs) log = link::probe_log_name(comment);
    const bool probes = run_line(interpreter, line.text);
    const std::size_t number = line.number, index = logged.lines.size();
    logged.lines.push_back(std::move(line));
    if (!probes) continue;
    logged.lines.push_back(
        {number, {}, question(logged.probes.size(), interpreter.modal().system)});
    logged.probes.push_back({index, log});
  }
  return logged;
}

std::string log_line(const LoggedPlace& place) {
  std::string line;
  for (const double value : place) {
    constexpr double decimals = 1e6;
    // A value that rounds to 0 has no sign.
    const double rounded = std::round(value * decimals) / decimals + 0.0;
    line += fmt::format("{}{:.6f}", line.empty() ? "" : " ", rounded);
  }
  return line;
}

ProbeAnswers::ProbeAnswers(const std::vector<link::ProgramLine>& lines,
                           const std::vector<LoggedProbe>& probes, const settings::Values& values,
                           const BoardState& state)
    : lines_(lines), probes_(probes), options_(program_options(values)) {
  begin_with(state, interpreter_, parameters_);
}

std::optional<ProbeAnswers::Answer> ProbeAnswers::take(std::string_view text) {
  if (!text.starts_with(answer_begin) || !text.ends_with(']')) return std::nullopt;
  text = text.substr(answer_begin.size(), text.size() - answer_begin.size() - 1);
  const auto take_word = [&text] {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    return word;
  };
  const auto probe = number_of<std::size_t>(take_word());
  const std::string_view half = take_word();
  if (!probe || *probe >= probes_.size() || (half != "a" && half != "b")) return std::nullopt;
  std::vector<double> values;
  while (!text.empty()) values.push_back(number_of<double>(take_word()).value_or(NAN));
  const bool is_complete =
      values.size() == (half == "a" ? first_size : second_size) &&
      std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  Answer answer{*probe};
  if (half == "a") {
    first_of_ = *probe;
    first_ = is_complete ? std::move(values) : std::vector<double>{};
    return answer;
  }
  if (!is_complete || first_of_ != *probe || first_.empty()) return answer;
  second_ = std::move(values);
  run_to(probes_[*probe].line);
  const LoggedPlace contact = place();
  if (first_[met_value] != 0) answer.place = contact;
  first_.clear();
  return answer;
}

/// Runs the lines up to this one.
void ProbeAnswers::run_to(std::size_t line) {
  for (; run_ <= line; ++run_) run_line(interpreter_, lines_[run_].text);
}

/// The contact; the interpreter gets the values of the board.
LoggedPlace ProbeAnswers::place() {
  const program::Modal& modal = interpreter_.modal();
  const Place origin = place_of(second_, origin_values), shift = place_of(second_, shift_values);
  const std::int64_t tool_e7 =
      std::llround(second_[tool_value] * static_cast<double>(program::one_e7));
  const bool is_shifted = second_[shifted_value] != 0;
  parameters_.systems_e7[modal.system] = origin;
  parameters_.shift_e7 = shift;
  if (modal.tool_length) parameters_.tool_length_e7 = tool_e7;
  Place offset = origin;
  for (std::size_t a = 0; a < offset.size(); ++a) offset[a] += is_shifted ? shift[a] : 0;
  offset[tool_axis] += tool_e7;

  const program::Rotation system = parameters_.rotation_of(modal.system), own = modal.rotation;
  const program::Rotations rotations{system, own};
  const bool inches = modal.inches;
  Place now = place_of(first_, work_values, inches);
  for (std::size_t a = 0; a < now.size(); ++a) now[a] += offset[a];
  interpreter_.set_position(rotations.turned(now));

  const Place contact = rotations.turned_back(place_of(first_, contact_values));
  const auto unit = static_cast<double>(inches ? program::inch_e7 : program::one_e7);
  LoggedPlace place{};
  for (std::size_t a = 0; a < contact.size(); ++a)
    if (static_cast<int>(a) < options_.axes)
      place[a] = static_cast<double>(contact[a] - offset[a]) / unit;
  return place;
}

}  // namespace lamplock::program_run
