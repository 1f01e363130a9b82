// O-words of a line: sub, call, if, while and so on, as LinuxCNC has them ("O Codes").
//
// In:  a line without comments. Out: what the line is, its label and its arguments.
// Who: flow_unit.hpp. Upper and lower case and blanks do not differ.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace lamplock::program_run {

enum class Flow {
  sub,
  endsub,
  call,
  returning,
  branch,       ///< if
  else_branch,  ///< elseif
  otherwise,    ///< else
  endif,
  loop,  ///< while at the begin of a loop
  endwhile,
  do_loop,
  do_while,  ///< while at the end of a loop that do begins: known by its place
  repeat,
  endrepeat,
  breaking,
  continuing
};

struct FlowWord {
  Flow flow{};
  std::string label{};      ///< a number, <name>, or of a call a value: #1, [expression]
  std::string arguments{};  ///< values in square brackets, one after the other
  /// Where they begin in the line without its blanks.
  std::size_t label_at = 0, arguments_at = 0;
};

/// What is no O-word, and what to do.
struct FlowWordFault {
  std::string what, remedy;
};

/// Empty if the line is none; O1000 alone is a program number. Without a flow if its word is
/// unknown or its values are not in brackets: `fault` then says so.
std::optional<FlowWord> flow_word_of(std::string_view line, std::optional<FlowWordFault>& fault);

/// As in a program: `if`.
std::string_view name_of(Flow flow);

}  // namespace lamplock::program_run
