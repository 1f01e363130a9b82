// Tools in a statement: M61, lengths (G43 to G43.2), entries of the tool table (G10 L1, L10, L11).
#include "firmware/program/statement.hpp"

namespace lamplock::program {
namespace {

constexpr int tool_axis = 2;
constexpr std::uint32_t tool_axis_bit = 1u << tool_axis;
/// The coordinate system of G10 L11: G59.3.
constexpr std::uint8_t fixture_system = coordinate_systems - 1;

}  // namespace

Fault Statement::check_users() const {
  constexpr Group refused[] = {Group::stopping, Group::overrides, Group::beat_lock, Group::cutter};
  for (const Group group : refused)
    if (block_.has(group)) return {GcodeError::tool_change_pending, block_.column(group)};
  if (plan_.has(Stage::tool_change))
    return {GcodeError::tool_change_pending, block_.column(Group::tool_change)};
  return {};
}

/// G54.1 P1 to P3, the systems after G59 as other controllers number them: G59.1 to G59.3.
bool Statement::additional_system() {
  constexpr std::uint8_t usual_systems = 6;
  std::uint32_t number = 0;
  if (!needed('P', block_.column(Group::system)) || !integer('P', number)) return false;
  if (number == 0 || number > coordinate_systems - usual_systems)
    return fail_at('P', GcodeError::no_such_system);
  after_.modal.system = static_cast<std::uint8_t>(usual_systems - 1 + number);
  return true;
}

/// A number of a tool that the table has; 0 is no tool.
bool Statement::known_tool(std::uint32_t number, std::uint16_t column) {
  Tool tool;
  return find_tool(number, tool, column);
}

bool Statement::find_tool(std::uint32_t number, Tool& tool, std::uint16_t column) {
  tool = {};
  return number == 0 || parameters_.tools.find(number, tool) ||
         fail(GcodeError::unknown_tool, column);
}

/// The number in a D or H word; without one, the tool in the spindle.
bool Statement::tool_of(const Word* word, std::uint32_t& number) {
  number = after_.modal.loaded_tool;
  if (word == nullptr) return true;
  if (const GcodeError error = whole(*word, number); error != GcodeError::none)
    return fail(error, word->column);
  return number <= max_tool || fail(GcodeError::tool_too_large, word->column);
}

/// M61 Q: the spindle has this tool.
bool Statement::set_tool() {
  std::uint32_t number = 0;
  if (!needed('Q', block_.column(Group::tool_change)) || !integer('Q', number)) return false;
  if (number > max_tool) return fail_at('Q', GcodeError::tool_too_large);
  after_.modal.tool = number;
  after_.modal.loaded_tool = static_cast<std::uint8_t>(number);
  return parameters_.tools.empty() || known_tool(number, block_.word('Q').column);
}

bool Statement::set_tool_length(std::int64_t e7, std::uint16_t column) {
  changes_.tool_length_e7 = e7;
  changes_.add(static_cast<int>(ParameterRow::tool_length));
  after_.modal.tool_length = true;
  return inside(e7, max_position_e7, GcodeError::out_of_range, column);
}

/// G43.1 Z.
bool Statement::tool_length_of_axis() {
  const std::uint32_t axes = block_.axes();
  if (axes == 0) return fail(GcodeError::tool_length_axis, block_.column(Group::tool_length));
  if (axes != tool_axis_bit) return fail_axes(GcodeError::tool_length_axis, axes & ~tool_axis_bit);
  block_.take_axes();
  return set_tool_length(axis_e7(tool_axis), block_.axis(tool_axis).column);
}

/// G43 H: the length of a tool of the table, by default of the one in the spindle; H0 is no length
/// (NIST, section 3.5.10). G43.2 H: it is added to the length in force.
bool Statement::tool_length_of_table() {
  const bool adds = block_.code(Group::tool_length) == 432;
  const Word* const word = block_.h_word();
  const std::uint16_t column = word == nullptr ? block_.column(Group::tool_length) : word->column;
  if (adds && word == nullptr) return fail(GcodeError::value_missing, column);
  block_.use(Ignored::h);
  std::uint32_t number = 0;
  Tool tool;
  if (!tool_of(word, number) || !find_tool(number, tool, column)) return false;
  if (adds && after_.modal.tool_length) tool.length_e7 += parameters_.tool_length_e7;
  return set_tool_length(tool.length_e7, column);
}

/// G10 L1: length and radius as written. L10, L11: the length with which the current position has
/// the coordinate of the Z word, in the active system, or in G59.3 without a shift. What has no
/// word keeps its value.
bool Statement::enter_tool(std::uint32_t kind, std::uint32_t number) {
  const std::uint16_t column = block_.word('P').column;
  if (number == 0) return fail(GcodeError::not_positive, column);
  if (number > max_tool) return fail(GcodeError::tool_too_large, column);
  if (!parameters_.tools.has_room(number)) return fail(GcodeError::tool_table_full, column);
  if (const std::uint32_t others = block_.axes() & ~tool_axis_bit; others != 0)
    return fail_axes(GcodeError::tool_length_axis, others);
  Tool tool;
  parameters_.tools.find(number, tool);
  if (block_.axes() != 0) {
    block_.take_axes();
    tool.length_e7 = axis_e7(tool_axis);
    if (kind != 1) {
      const Modal& modal = after_.modal;
      const std::uint8_t system = kind == 10 ? modal.system : fixture_system;
      std::int64_t origin = parameters_.systems_e7[system][tool_axis];
      if (kind == 10 && modal.shifted) origin += parameters_.shift_e7[tool_axis];
      tool.length_e7 = after_.programmed_e7[tool_axis] - origin - tool.length_e7;
    }
    if (!inside(tool.length_e7, ToolTable::max_length_e7, GcodeError::out_of_range,
                block_.axis(tool_axis).column))
      return false;
  }
  if (block_.has('R')) {
    std::int64_t radius = 0;
    if (!length('R', radius)) return false;
    if (radius < 0) return fail_at('R', GcodeError::negative_value);
    if (2 * radius > ToolTable::max_diameter_e7) return fail_at('R', GcodeError::out_of_range);
    tool.diameter_e7 = 2 * radius;
  }
  changes_.tool = ToolTable::Entry(number, tool);
  changes_.add(static_cast<int>(ParameterRow::tools));
  return true;
}

}  // namespace lamplock::program
