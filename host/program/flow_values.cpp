#include "host/program/flow_values.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "firmware/program/message.hpp"
#include "host/program/interpreter_options.hpp"
#include "shared/gcode_words.hpp"

namespace lamplock::program_run {
namespace {

constexpr std::uint32_t last_local = 30;

/// A number as the board reads it.
std::string number_text(const program::Word& word) {
  std::string digits = fmt::format("{}", std::abs(word.mantissa));
  const std::size_t decimals = word.decimals;
  if (digits.size() <= decimals) digits.insert(0, decimals + 1 - digits.size(), '0');
  if (decimals != 0) digits.insert(digits.size() - decimals, 1, '.');
  return (word.mantissa < 0 ? "-" : "") + digits;
}

bool has_values(std::string_view line) {
  return line.find_first_of("#[") != std::string_view::npos;
}

program::Fault fault_at(GcodeError error, std::size_t index) {
  return {error, static_cast<std::uint16_t>(index + 1)};
}

}  // namespace

FlowValues::FlowValues(const settings::Values& values, const BoardState* state)
    : options_(program_options(values)), tool_(state != nullptr && state->loaded_tool) {
  if (state != nullptr) begin_with(*state, interpreter_, parameters_);
  state_ = &interpreter_.state();
}

program::Fault FlowValues::run(std::string_view line, std::string& with_numbers) {
  with_numbers = line;
  if (has_values(line)) {
    with_numbers.clear();
    const program::Fault fault = read_words(line, with_numbers);
    expressions_.end_line(!fault);
    if (fault) return fault;
  }
  // A line that the interpreter refuses is refused again when the program is checked or sent.
  if (!with_numbers.empty() && !interpreter_.run(with_numbers))
    for (program::Action action; interpreter_.next(action);)
      has_ended_ = has_ended_ || action.kind == program::ActionKind::program_end;
  state_ = &interpreter_.state();
  return {};
}

program::Fault FlowValues::read_words(std::string_view line, std::string& text) {
  program::WordReader reader(line);
  for (program::Word word;;) {
    if (const program::Fault fault = reader.next(word)) {
      std::uint16_t index = reader.peek() == '#' && fault.error != GcodeError::bad_number
                                ? reader.place()
                                : word.column;
      if (fault.error == GcodeError::bad_number) {
        if (!expressions_.begins_at(line, index)) return fault;
        if (const program::Fault other = expressions_.read_word(line, index, word)) return other;
      } else if (reader.peek() == '#') {
        if (const program::Fault other = expressions_.read_assignment(line, index)) return other;
        reader.go_to(index);
        continue;
      } else {
        return fault;
      }
      reader.go_to(index);
    } else if (word.letter == 0) {
      return {};
    }
    text += word.letter + number_text(word);
  }
}

std::string FlowValues::messages(std::string_view comments) {
  std::string all;
  for (TextLine text; program::take_message(comments, expressions_, text); text = {})
    all += fmt::format("(MSG,{})", text.view().substr(0, program::max_message));
  return all;
}

program::Fault FlowValues::value(std::string_view text, std::uint16_t& index, std::int64_t& e9) {
  // By an assignment, which is dropped: the value of a word would have fewer decimals.
  static constexpr std::string_view name = "o-word value";
  if (index >= text.size()) return fault_at(GcodeError::bad_expression, text.size());
  const std::string line = fmt::format("#<{}>={}", name, text.substr(index));
  const std::size_t before = line.size() - (text.size() - index);
  const program::Variables saved = expressions_.variables();
  std::uint16_t end = 0;
  program::Fault fault = expressions_.read_assignment(line, end);
  expressions_.end_line(!fault);
  expressions_.variables().find("o-wordvalue", e9);
  expressions_.set_variables(saved);
  if (fault) {
    const std::size_t column = fault.column > before ? fault.column - before + index : index + 1u;
    fault.column = static_cast<std::uint16_t>(column);
    return fault;
  }
  index = static_cast<std::uint16_t>(end - before + index);
  return {};
}

void FlowValues::set(const std::string& name, std::int64_t e9) {
  program::Variables variables = expressions_.variables();
  if (variables.assign(name, e9) == GcodeError::none) variables.commit();
  expressions_.set_variables(variables);
}

/// Adds the locals of another state, or all but them.
void FlowValues::keep(const program::Variables& from, bool locals) {
  program::Variables variables = expressions_.variables();
  for (std::uint32_t i = 0; i < from.size(); ++i) {
    const std::uint32_t number = from.number(i);
    const bool is_local = number == 0 ? !from.name(i).starts_with('_') : number <= last_local;
    if (is_local != locals) continue;
    if (number == 0)
      variables.assign(from.name(i), from.value_at(i));
    else
      variables.assign(number, from.value_at(i));
    variables.commit();
  }
  expressions_.set_variables(variables);
}

FlowValues::Locals FlowValues::enter(const std::vector<std::int64_t>& arguments_e9) {
  const program::Variables before = expressions_.variables();
  expressions_.clear();
  keep(before, false);
  program::Variables variables = expressions_.variables();
  for (std::uint32_t i = 0; i < arguments_e9.size(); ++i) {
    variables.assign(i + 1, arguments_e9[i]);
    variables.commit();
  }
  expressions_.set_variables(variables);
  return before;
}

void FlowValues::leave(const Locals& locals) {
  const program::Variables after = expressions_.variables();
  expressions_.clear();
  keep(after, false);
  keep(locals, true);
}

}  // namespace lamplock::program_run
