// Values of a program with O-words: its parameters, and its lines with numbers in place of values.
//
// In:  lines without O-words, values of O-words. Out: the same lines with plain numbers, values.
// Who: program_flow.hpp. The firmware's interpreter runs the lines, so that expressions and values
// of the machine (#5420, #<_x>) are those of the board; the board itself gets numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/machine/activities/program_reader.hpp"
#include "firmware/program/expression.hpp"
#include "firmware/program/interpreter.hpp"
#include "host/program/board_state.hpp"
#include "host/program/loaded_tool.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

class FlowValues {
 public:
  /// `state`: of the board before the program, null if unknown.
  FlowValues(const settings::Values& values, const BoardState* state);

  /// The line with numbers; empty if nothing but assignments was in it. Runs it: after an error
  /// nothing of it has an effect.
  program::Fault run(std::string_view line, std::string& with_numbers);
  /// What the line needs of the tool in the spindle while the board has not reported it; empty if
  /// nothing. Once for each line, before it runs.
  std::string unknown_tool(std::string_view line) { return tool_.pass(line); }
  /// The program has ended by M2 or M30.
  bool has_ended() const { return has_ended_; }
  const program::Interpreter& interpreter() const { return interpreter_; }
  const program::Modal& modal() const { return interpreter_.modal(); }
  /// G20 is in force.
  bool inches() const { return interpreter_.modal().inches; }

  /// The messages of these comments with their values, as comments.
  std::string messages(std::string_view comments);
  /// The value that begins at this index of the text; the index is after it.
  program::Fault value(std::string_view text, std::uint16_t& index, std::int64_t& e9);
  /// Sets a name.
  void set(const std::string& name, std::int64_t e9);

  using Locals = program::Variables;
  /// A sub begins with these values as #1, #2 ...; returns what is in force until then.
  Locals enter(const std::vector<std::int64_t>& arguments_e9);
  /// It ends: parameters that are local are again those of the caller.
  void leave(const Locals& locals);

 private:
  program::Fault read_words(std::string_view line, std::string& text);
  void keep(const program::Variables& from, bool locals);

  program::Parameters parameters_;
  const program::Options options_;
  program::Interpreter interpreter_{parameters_, options_};
  const program::State* state_ = &interpreter_.state();
  program::Expressions expressions_{state_, parameters_, options_.rotary};
  LoadedTool tool_;
  bool has_ended_ = false;
};

}  // namespace lamplock::program_run
