// The lines of one file with O-words, with the ends of their loops and branches.
//
// In:  the lines of a file. Out: statements, each with the place where it continues.
// Who: program_flow.hpp.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/link/program_lines.hpp"
#include "host/program/flow_word.hpp"

namespace lamplock::program_run {

struct FlowStatement {
  link::ProgramLine line;
  std::optional<FlowWord> word{};
  /// Index of the statement that belongs to it: of a branch the next one, up to endif; of the begin
  /// of a loop or sub its end, of the end its begin; of break and continue the begin of their loop.
  std::size_t other = 0;
  std::size_t end = 0;  ///< of elseif and else: endif
};

struct FlowUnit {
  std::string file;
  std::vector<FlowStatement> statements;
  std::map<std::string, std::size_t> subs;      ///< index of `sub` by its label
  std::map<std::string, std::size_t> programs;  ///< index of a line O1000 by its number
};

/// Throws ProgramError: an unknown word, an end without its begin, a begin
/// without its end, two subs with one label.
FlowUnit flow_unit_of(std::vector<link::ProgramLine> lines, const std::string& file);

/// Whether a line of the program is an O-word, calls or ends a subprogram (M98, M99), or gives a
/// user command a value that the host has to compute.
bool has_flow(std::string_view text);

/// The number of a line with M98 or M99; 0 of others.
int subprogram_code(std::string_view line);

}  // namespace lamplock::program_run
