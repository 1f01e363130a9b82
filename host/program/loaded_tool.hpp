// Whether a program uses the tool in the spindle before it is known.
//
// In:  what the board has reported, the lines of the program in their order.
// Out: the first word or parameter of a line whose meaning depends on an unknown tool.
// Who: the host, before it computes values, positions or the space of a program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/program_lines.hpp"
#include "host/program/board_state.hpp"

namespace lamplock::program_run {

class LoadedTool {
 public:
  /// `is_known`: at the begin of the program.
  explicit LoadedTool(bool is_known) : is_known_(is_known) {}

  bool is_known() const { return is_known_; }
  /// What the line uses of an unknown tool: `G43` without H, `G41` without D, `#5400` and the like;
  /// empty if nothing. Notes M6 and M61, after which the tool is known.
  std::string pass(std::string_view line);

 private:
  bool is_known_;
};

/// The board has reported the tool in its spindle.
bool knows_tool(const std::optional<BoardState>& state);

/// A line of the program uses the tool in the spindle before it is known.
bool uses_unknown_tool(const std::vector<link::ProgramLine>& lines,
                       const std::optional<BoardState>& state);

inline constexpr std::string_view unknown_tool_remedy =
    "write M61 Q and the number of the tool before it, or G43 H, G41 D, G42 D";

}  // namespace lamplock::program_run
