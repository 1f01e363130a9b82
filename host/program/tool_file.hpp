// The tool table of a machine in a file, for a check without the machine.
//
// In:  the text of a file: lines `G10 L1 P2 Z38.6 R1.5` as they are sent to a board, or the answer
//      of a board to `$#`, of which lines `[T:2|0.000,0.000,38.600|1.500]` count, in millimetres.
// Out: the table. Who: `check --tools`.
#pragma once

#include <string>
#include <string_view>

#include "firmware/program/tool_table.hpp"

namespace lamplock::program_run {

/// Throws Error(bad_input) about FILE:LINE for what is neither, for values out of range and for
/// more tools than a board has room for; about FILE if it has no tool.
program::ToolTable tools_of(std::string_view text, const std::string& file);

}  // namespace lamplock::program_run
