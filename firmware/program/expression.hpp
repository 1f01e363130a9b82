// Expressions and assignments of a line: [#1 * SIN[30]], #<width> = 12.
//
// In:  a line, the place of a value in it; parameters (variables.hpp), values of the machine
//      (predefined.hpp).
// Out: the value, 10^-9, and the place after it; assignments go to the parameters. Or an error and
//      its column.
// Who: the block (block.hpp), for words that are no plain numbers; main loop. Lines without them
//      never come here.
//
// Language: RS-274/NGC as LinuxCNC reads it. A value is a number, an expression in square brackets,
// a parameter, a function, or one of them after a sign. ** before * / MOD before + - before
// EQ NE GT GE LT LE before AND OR XOR, from left to right; a sign belongs to its value: -2**2 is 4.
//
// Instead of recursion there are two stacks, of values and of what waits for a value: signs and #,
// which the next value completes, and brackets and operators, which a later operator or the end of
// the bracket does ("shunting yard", Dijkstra 1961).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/program/decimal.hpp"
#include "firmware/program/predefined.hpp"
#include "firmware/program/value_text.hpp"
#include "firmware/program/variables.hpp"
#include "shared/gcode_words.hpp"

namespace lamplock::program {

class Expressions {
 public:
  /// As Predefined.
  Expressions(const State* const& state, const Parameters& parameters, const std::uint8_t& rotary)
      : predefined_(state, parameters, rotary) {}

  /// Whether a value that is not a plain number begins at this index of the line.
  [[gnu::cold]] bool begins_at(std::string_view line, std::uint16_t index);
  /// Reads such a value as the number of a word: seven decimals, below 10^9. `index` is after it.
  [[gnu::cold]] Fault read_word(std::string_view line, std::uint16_t& index, Word& word);
  /// Reads an assignment, which begins with `#` at the index. `index` is after it.
  [[gnu::cold]] Fault read_assignment(std::string_view line, std::uint16_t& index);

  /// The value of a parameter, of which the text is the whole; false if it has none.
  [[gnu::cold]] bool read_parameter(std::string_view text, std::int64_t& e9);

  const Variables& variables() const { return variables_; }
  /// Replaces all parameters; not within a line.
  void set_variables(const Variables& variables) { variables_ = variables; }
  bool has_assignments() const { return variables_.has_assignments(); }
  /// The line is over: its assignments are in force, or dropped after an error.
  [[gnu::cold]] void end_line(bool is_valid) {
    if (is_valid)
      variables_.commit();
    else
      variables_.drop();
  }
  /// All parameters are unset.
  void clear() { variables_.clear(); }
  Results& results() { return predefined_.results; }

 private:
  /// What waits for a value: a Kind; or a function, which is an open bracket as well, or an
  /// operator, in the order of their enumerations.
  using Waiting = std::uint8_t;

  // Every step returns false after an error, which is then in fault_.
  bool fail(GcodeError error, std::uint16_t index);
  bool check(GcodeError error, std::uint16_t index);

  bool find_function(Waiting& function);

  bool value(std::int64_t& e9);
  bool begin_value(bool& is_complete);
  bool begin_parameter(bool& is_complete, std::uint16_t index);
  bool name_exists();
  bool push_named(std::uint16_t index);
  bool end_value(bool& is_over);
  bool complete_value();
  bool close_bracket(bool& is_complete);
  std::uint16_t open_bracket() const;
  bool add_operator();
  bool find_operator(Operator& op);
  bool find_operator_word(Operator& op);
  bool calculate_down_to(int precedence);
  bool parameter_number(std::int64_t e9, std::uint32_t max, std::uint16_t index,
                        std::uint32_t& number);
  bool check_number(std::uint32_t number, std::uint32_t max, std::uint16_t index);
  std::int64_t value_of(std::uint32_t number) const;
  bool fetch(std::int64_t& e9, std::uint16_t index);
  bool push(Waiting waiting, std::uint16_t index);
  bool push_value(std::int64_t e9);

  static constexpr std::uint32_t max_waiting = 48, max_values = 24;

  Variables variables_;
  Predefined predefined_;
  ValueText text_;
  Fault fault_;
  std::uint8_t waiting_size_ = 0, values_size_ = 0;
  std::array<Waiting, max_waiting> waiting_;
  std::array<std::uint16_t, max_waiting> places_;  ///< index in the line of each, for its error
  std::array<std::int64_t, max_values> values_e9_;
};

}  // namespace lamplock::program
