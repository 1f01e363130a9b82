#include "host/program/board_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "host/error.hpp"
#include "host/link/dialog.hpp"
#include "host/text.hpp"
#include "host/units.hpp"

namespace lamplock::program_run {
namespace {

using program::Place;

constexpr std::size_t z_axis = 2;

constexpr std::array<std::string_view, program::coordinate_systems> system_names{
    "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"};
/// Every grbl has these, but not G59.1 to G59.3.
constexpr std::size_t needed_systems = 6;

constexpr std::array<std::string_view, 11> power_up_modes{"G0", "G54", "G17", "G21", "G90", "G94",
                                                          "M5", "M9",  "T0",  "F0",  "S0"};
/// Modes whose numbers `$G` does not report: rotation, scaling, diameters, points on the beat.
constexpr std::array<std::string_view, 4> partly_reported{"G68", "G51", "G7", "M130"};
/// Words without effect here: tool length, which `$#` reports; stops and tool changes.
constexpr std::array<std::string_view, 8> passed_over{"G43.1", "G49", "M0", "M1",
                                                      "M2",    "M30", "M6", "M60"};
/// Modal motion modes that need words that the board does not report.
constexpr std::array<std::string_view, 16> cycles{"G5",  "G5.1", "G38.2", "G38.3", "G38.4", "G38.5",
                                                  "G73", "G80",  "G81",   "G82",   "G83",   "G85",
                                                  "G86", "G89",  "G76",   "G33"};

template <class List>
bool has(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

std::int64_t to_e7(double value, bool inches) {
  return std::llround(value * static_cast<double>(inches ? program::inch_e7 : program::one_e7));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const auto end = text.find(separator);
    if (end != 0) parts.push_back(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return parts;
}

/// The text between "[NAME:" and "]"; empty if there is no such line.
std::optional<std::string_view> value_of(const std::vector<std::string>& lines,
                                         std::string_view name) {
  const std::string begin = fmt::format("[{}:", name);
  for (const std::string_view line : lines)
    if (line.starts_with(begin) && line.ends_with(']'))
      return line.substr(begin.size(), line.size() - begin.size() - 1);
  return std::nullopt;
}

bool take_place(const std::vector<std::string>& lines, std::string_view name, InchAxes inches,
                Place& place) {
  const auto text = value_of(lines, name);
  if (!text) return false;
  const auto numbers = split(*text, ',');
  for (std::size_t a = 0; a < std::min(numbers.size(), place.size()); ++a) {
    const auto number = number_of<double>(numbers[a]);
    if (!number) return false;
    place[a] = to_e7(*number, inches.has(static_cast<int>(a)));
  }
  return !numbers.empty();
}

/// grbl reports one number, grblHAL one for each axis.
bool take_tool_length(const std::vector<std::string>& lines, InchAxes inches, std::int64_t& e7) {
  Place place{};
  if (!take_place(lines, "TLO", inches, place)) return false;
  const bool one = value_of(lines, "TLO")->find(',') == std::string_view::npos;
  e7 = place[one ? 0 : z_axis];
  return true;
}

/// Tools that the board reports as lamplock and grblHAL do; others have none.
void take_tools(const std::vector<std::string>& lines, bool inches, program::ToolTable& tools) {
  for (const std::string_view line : lines)
    if (const auto tool = parse_tool(line, inches)) tools.set(*tool);
}

/// Rotations that the board reports as lamplock does; others have none.
void take_rotations(const std::vector<std::string>& lines, program::Parameters& parameters) {
  const auto numbers = split(value_of(lines, "ROT").value_or(""), ',');
  auto& rotations_e7 = parameters.rotations_e7;
  for (std::size_t i = 0; i < std::min(numbers.size(), rotations_e7.size()); ++i)
    rotations_e7[i] = to_e7(number_of<double>(numbers[i]).value_or(0), false);
}

bool take_offsets(const std::vector<std::string>& lines, InchAxes inches,
                  program::Parameters& parameters) {
  for (std::size_t i = 0; i < system_names.size(); ++i)
    if (!take_place(lines, system_names[i], inches, parameters.systems_e7[i]) && i < needed_systems)
      return false;
  take_place(lines, "G28", inches, parameters.home_g28_e7);
  take_place(lines, "G30", inches, parameters.home_g30_e7);
  take_tools(lines, inches.any(), parameters.tools);
  take_rotations(lines, parameters);
  return take_place(lines, "G92", inches, parameters.shift_e7) &&
         take_tool_length(lines, inches, parameters.tool_length_e7);
}

/// A line that sets the motion mode of the board. G1 needs a feed and an arc its words: the line is
/// a full circle, which ends at its begin.
std::string motion_line(const std::vector<std::string_view>& words) {
  if (has(words, "G0")) return "G0";
  if (has(words, "G1")) return "G94 G1 F1000";
  if (has(words, "G2")) return "G17 G91 G94 G2 X0 I1 F1000";
  if (has(words, "G3")) return "G17 G91 G94 G3 X0 I1 F1000";
  return "G80";
}

/// The tool for the next M6.
std::string_view selected_tool(const std::vector<std::string_view>& words) {
  for (const std::string_view word : words)
    if (word.starts_with('T')) return word.substr(1);
  return "0";
}

/// The tool in the spindle, from a line of `$#` that is there unless it and T are 0.
std::optional<std::uint32_t> parse_loaded_tool(const std::vector<std::string>& offsets,
                                               std::string_view selected) {
  if (const auto text = value_of(offsets, "TOOL")) return number_of<std::uint32_t>(*text);
  return selected == "0" ? std::optional(0u) : std::nullopt;
}

std::vector<std::string> lines_of(const std::vector<std::string_view>& words, bool inches,
                                  std::optional<std::uint32_t> loaded_tool) {
  // A change of the feed mode clears the feed of the motion line.
  std::vector<std::string> lines{"G21 G90 G91.1 G17", motion_line(words), "G93", "G94", "G90"};
  const bool inverse_time = has(words, "G93"), per_turn = has(words, "G95");
  if (inverse_time) lines.emplace_back("G93");
  if (per_turn) lines.emplace_back("G95");
  constexpr std::array<std::string_view, 7> done{"G0", "G1", "G2", "G3", "G93", "G94", "G95"};
  for (const std::string_view word : words) {
    if (word.starts_with('F')) {
      const double feed = number_of<double>(word.substr(1)).value_or(0);
      if (feed > 0 && !inverse_time)
        lines.insert(lines.begin() + (per_turn ? 6 : 5),
                     fmt::format("G21 F{:.6f}", feed * (inches ? mm_per_inch : 1)));
    } else if (!has(done, word) && !has(cycles, word) && !has(passed_over, word)) {
      lines.emplace_back(word);
    }
  }
  // `$#` reports the active shift of G92.
  lines.emplace_back("G92.3");
  // M61 sets T as well, so it comes first. An unknown tool counts as that of T: the program can be
  // planned.
  const std::string_view selected = selected_tool(words);
  lines.insert(lines.begin(), loaded_tool ? fmt::format("M61 Q{}", *loaded_tool)
                                          : fmt::format("M61 Q{}", selected));
  return lines;
}

bool is_zero(const Place& place) { return place == Place{}; }

bool has_offsets(const program::Parameters& parameters) {
  return parameters.tool_length_e7 != 0 || !parameters.tools.empty() ||
         !is_zero(parameters.shift_e7) || !is_zero(parameters.home_g28_e7) ||
         !is_zero(parameters.home_g30_e7) ||
         parameters.rotations_e7 != program::Parameters{}.rotations_e7 ||
         !std::all_of(parameters.systems_e7.begin(), parameters.systems_e7.end(), is_zero);
}

std::size_t system_of(const std::vector<std::string_view>& words) {
  for (std::size_t i = 0; i < system_names.size(); ++i)
    if (has(words, system_names[i])) return i;
  return 0;
}

}  // namespace

std::optional<program::ToolTable::Entry> parse_tool(std::string_view line, bool inches) {
  constexpr std::string_view begin = "[T:";
  if (!line.starts_with(begin) || !line.ends_with(']')) return std::nullopt;
  const auto parts = split(line.substr(begin.size(), line.size() - begin.size() - 1), '|');
  if (parts.size() < 3) return std::nullopt;
  const auto offsets = split(parts[1], ',');
  const auto number = number_of<std::uint32_t>(parts[0]);
  const auto length =
      offsets.size() > z_axis ? number_of<double>(offsets[z_axis]) : std::optional<double>{};
  const auto radius = number_of<double>(parts[2]);
  if (!number || !length || !radius || *number == 0 || *number > program::max_tool)
    return std::nullopt;
  constexpr double max_mm = 1e6;  // far above the limits below, and inside of 64 bits
  if (!(std::abs(*length) < max_mm && std::abs(*radius) < max_mm)) return std::nullopt;
  const program::Tool tool{to_e7(*length, inches), 2 * to_e7(*radius, inches)};
  if (std::abs(tool.length_e7) > program::ToolTable::max_length_e7 || tool.diameter_e7 < 0 ||
      tool.diameter_e7 > program::ToolTable::max_diameter_e7)
    return std::nullopt;
  return program::ToolTable::Entry(*number, tool);
}

std::optional<BoardState> parse_state(const link::BoardStatus& status,
                                      const std::vector<std::string>& offsets,
                                      const std::vector<std::string>& modes, InchAxes inches) {
  BoardState state;
  const auto text = value_of(modes, "GC");
  if (!text || status.position.empty() || !take_offsets(offsets, inches, state.parameters))
    return std::nullopt;
  const auto words = split(*text, ' ');
  for (const std::string_view word : words)
    if (has(partly_reported, word.substr(0, word.find(':')))) return std::nullopt;
  state.loaded_tool = parse_loaded_tool(offsets, selected_tool(words));
  state.modes = lines_of(words, inches.any(), state.loaded_tool);
  const program::Parameters& parameters = state.parameters;
  state.work_offset_e7 = parameters.systems_e7[system_of(words)];
  for (std::size_t a = 0; a < state.machine_e7.size(); ++a)
    state.work_offset_e7[a] += parameters.shift_e7[a];
  state.work_offset_e7[z_axis] += parameters.tool_length_e7;
  for (std::size_t a = 0; a < std::min(status.position.size(), state.machine_e7.size()); ++a)
    state.machine_e7[a] = to_e7(status.position[a], inches.has(static_cast<int>(a))) +
                          (status.of_work ? state.work_offset_e7[a] : 0);
  state.as_after_power_up =
      is_zero(state.machine_e7) && !has_offsets(parameters) &&
      std::equal(words.begin(), words.end(), power_up_modes.begin(), power_up_modes.end());
  return state;
}

std::optional<BoardState> read_state(link::LinePort& port, const link::BoardStatus& status,
                                     InchAxes inches) {
  if (!status.rests()) return std::nullopt;
  try {
    const link::Answer offsets = link::ask(port, "$#"), modes = link::ask(port, "$G");
    if (offsets.error == 0 && modes.error == 0)
      return parse_state(status, offsets.lines, modes.lines, inches);
  } catch (const Error&) {
    link::expect_connected(port);
  }
  return std::nullopt;
}

void begin_with(const BoardState& state, program::Interpreter& interpreter,
                program::Parameters& parameters) {
  parameters = state.parameters;
  // A board may have a tool in the spindle, or chosen, that its table no longer has.
  parameters.tools = {};
  interpreter.reset();
  for (const std::string& line : state.modes) {
    interpreter.run(line);  // boards of another firmware report words unknown to this interpreter
    for (program::Action action; interpreter.next(action);) {
    }
  }
  parameters.tools = state.parameters.tools;
  interpreter.set_position(state.machine_e7);
}

}  // namespace lamplock::program_run
