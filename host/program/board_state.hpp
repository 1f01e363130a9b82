// The state of a board before the first line of a program.
//
// In:  a board at rest: its status (`?`), its answers to `$#` and `$G`.
// Out: position, offsets and modal state, the initial state of an interpreter.
// Who: `lamplock send`, which checks a program before it sends it.
//
// The board reports lengths with three decimals of a millimetre (four of an inch), the feed in
// whole mm/min, and its position in steps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "firmware/program/parameters.hpp"
#include "firmware/program/value.hpp"
#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"
#include "shared/inch_axes.hpp"

namespace lamplock::program_run {

struct BoardState {
  program::Place machine_e7{};
  program::Parameters parameters;  ///< G54 to G59.3, G28, G30, G92, tools
  std::vector<std::string> modes;  ///< lines that set the modal state
  program::Place work_offset_e7{};
  /// The tool in the spindle; empty if the board does not report it. T of `$G` is no substitute: it
  /// is the tool for the next M6.
  std::optional<std::uint32_t> loaded_tool = 0;
  bool as_after_power_up = false;  ///< at machine zero, without offsets, modal state by default
};

/// A line `[T:1|0.000,0.000,41.250|3.000]` of `$#`: number, offsets, radius. Empty for another line
/// and for values that a tool table cannot have.
std::optional<program::ToolTable::Entry> parse_tool(std::string_view line, bool inches);

/// Parses the answers to `$#` and `$G`. Empty if a part is missing, or a mode
/// is active that the board reports incompletely (G68, M130).
std::optional<BoardState> parse_state(const link::BoardStatus& status,
                                      const std::vector<std::string>& offsets,
                                      const std::vector<std::string>& modes, InchAxes inches);

/// Asks a board whose status is `status`. Empty if it is not at rest or does not answer.
std::optional<BoardState> read_state(link::LinePort& port, const link::BoardStatus& status,
                                     InchAxes inches);

/// Sets the state of an interpreter and its parameters.
void begin_with(const BoardState& state, program::Interpreter& interpreter,
                program::Parameters& parameters);

}  // namespace lamplock::program_run
