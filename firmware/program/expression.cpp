#include "firmware/program/expression.hpp"

#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

enum Kind : std::uint8_t { negate, fetch_parameter, bracket, first_of_two, second_of_two, exists };
constexpr std::uint8_t first_function = 8, first_operator = 32;

constexpr bool is_operator(std::uint8_t waiting) { return waiting >= first_operator; }
constexpr Operator operator_of(std::uint8_t waiting) {
  return static_cast<Operator>(waiting - first_operator);
}

struct FunctionRow {
  Letters letters;
  std::uint8_t waiting;
};
consteval FunctionRow function_row(std::string_view text, Function function) {
  return {letters_of(text), static_cast<std::uint8_t>(first_function + static_cast<int>(function))};
}
constexpr FunctionRow function_rows[] = {function_row("COS", Function::cos),
                                         function_row("SIN", Function::sin),
                                         function_row("SQRT", Function::sqrt),
                                         function_row("ROUND", Function::round),
                                         function_row("ABS", Function::abs),
                                         function_row("FIX", Function::fix),
                                         function_row("FUP", Function::fup),
                                         function_row("TAN", Function::tan),
                                         FunctionRow{letters_of("ATAN"), first_of_two},
                                         function_row("ACOS", Function::acos),
                                         function_row("ASIN", Function::asin),
                                         function_row("EXP", Function::exp),
                                         function_row("LN", Function::ln),
                                         FunctionRow{letters_of("EXISTS"), exists}};

struct OperatorRow {
  Letters letters;
  Operator op;
};
/// Those of two letters first.
constexpr OperatorRow operator_rows[] = {
    {letters_of("OR"), Operator::logical_or},    {letters_of("EQ"), Operator::equal},
    {letters_of("NE"), Operator::not_equal},     {letters_of("GT"), Operator::greater},
    {letters_of("GE"), Operator::greater_equal}, {letters_of("LT"), Operator::less},
    {letters_of("LE"), Operator::less_equal},    {letters_of("AND"), Operator::logical_and},
    {letters_of("XOR"), Operator::logical_xor},  {letters_of("MOD"), Operator::modulo}};

constexpr int precedence_of(Operator op) {
  if (op == Operator::power) return 5;
  if (op >= Operator::times) return 4;
  if (op >= Operator::plus) return 3;
  return op >= Operator::equal ? 2 : 1;
}

constexpr bool is_digit_or_point(char c) { return (c >= '0' && c <= '9') || c == '.'; }

}  // namespace

bool Expressions::fail(GcodeError error, std::uint16_t index) {
  fault_ = {error, text_.column(index)};
  return false;
}

bool Expressions::check(GcodeError error, std::uint16_t index) {
  return error == GcodeError::none || fail(error, index);
}

/// The function that is next, its bracket included.
bool Expressions::find_function(Waiting& function) {
  const std::uint16_t from = text_.index();
  const Letters letters = text_.take_letters();
  if (letters != 0)
    for (const FunctionRow& row : function_rows) {
      if (row.letters != letters) continue;
      function = row.waiting;
      if (function == exists || text_.take('[')) return true;
      break;
    }
  text_.go_to(from);
  return false;
}

bool Expressions::begins_at(std::string_view line, std::uint16_t index) {
  text_.begin(line, index);
  fault_ = {};
  int signs = 0;
  while (text_.take('+') || text_.take('-')) ++signs;
  const char c = text_.peek();
  if (c == '[' || c == '#' || (signs > 1 && is_digit_or_point(c))) return true;
  Waiting function = 0;
  return find_function(function);
}

// --- words and assignments --------------------------------------------------------------------

Fault Expressions::read_word(std::string_view line, std::uint16_t& index, Word& word) {
  text_.begin(line, index);
  fault_ = {};
  std::int64_t e9 = 0;
  if (!value(e9)) return fault_;
  constexpr std::uint32_t lost = 100, kept = 10'000'000;  // two of nine decimals
  static_assert(lost * kept == one_e9 && max_decimals == 7 && max_digits == 9);
  const auto size = static_cast<std::uint64_t>(abs64(e9)) + lost / 2;
  const auto whole = size / std::uint64_t{one_e9};
  if (whole >= std::uint64_t{one_e9}) return {GcodeError::result_too_large, word.column};
  std::uint32_t fraction = static_cast<std::uint32_t>(size - whole * std::uint64_t{one_e9}) / lost;
  std::uint32_t unit = kept;
  word.decimals = max_decimals;
  for (; word.decimals != 0 && fraction % 10 == 0; --word.decimals) {
    fraction /= 10;
    unit /= 10;
  }
  const std::uint64_t mantissa = wide_product(static_cast<std::uint32_t>(whole), unit) + fraction;
  word.mantissa =
      e9 < 0 ? -static_cast<std::int64_t>(mantissa) : static_cast<std::int64_t>(mantissa);
  index = text_.index();
  return {};
}

bool Expressions::read_parameter(std::string_view text, std::int64_t& e9) {
  text_.begin(text, 0);
  fault_ = {};
  return value(e9);
}

Fault Expressions::read_assignment(std::string_view line, std::uint16_t& index) {
  text_.begin(line, index);
  fault_ = {};
  text_.take('#');
  const bool has_name = text_.peek() == '<';
  const std::uint16_t from = text_.index();
  std::int64_t e9 = 0;
  std::uint32_t number = 0;
  if (has_name) {
    if (!check(text_.take_name(), from)) return fault_;
  } else if (text_.take_whole(number)) {
    if (!check_number(number, Variables::max_number, index)) return fault_;
  } else if (!value(e9) || !parameter_number(e9, Variables::max_number, index, number)) {
    return fault_;
  }
  if (!text_.take('=')) return {GcodeError::bad_expression, static_cast<std::uint16_t>(index + 1)};
  if (!value(e9)) return fault_;
  const std::uint16_t end = text_.index();
  if (has_name) {  // the value may have had another name
    text_.go_to(from);
    text_.take_name();
    std::int64_t unused = 0;
    if (predefined_.find(text_.name(), unused))
      return {GcodeError::out_of_range, static_cast<std::uint16_t>(index + 1)};
  }
  check(has_name ? variables_.assign(text_.name(), e9) : variables_.assign(number, e9), index);
  index = end;
  return fault_;
}

// --- values -----------------------------------------------------------------------------------

bool Expressions::value(std::int64_t& e9) {
  waiting_size_ = values_size_ = 0;
  for (bool is_over = false; !is_over;) {
    bool is_complete = false;
    if (!begin_value(is_complete)) return false;
    if (is_complete && !end_value(is_over)) return false;
  }
  e9 = values_e9_[0];
  return true;
}

/// Reads a number or a named parameter, or what waits for a value.
bool Expressions::begin_value(bool& is_complete) {
  std::int64_t e9 = 0;
  const char c = text_.peek();
  const std::uint16_t at = text_.index();
  if (is_digit_or_point(c)) {
    is_complete = true;
    return check(text_.take_number(e9), at) && push_value(e9);
  }
  if (text_.take('+')) return true;
  if (text_.take('-')) return push(negate, at);
  if (text_.take('[')) return push(bracket, at);
  if (text_.take('#')) return begin_parameter(is_complete, at);
  Waiting function = 0;
  if (!find_function(function))
    return fail(is_letter(c) ? GcodeError::unknown_operator : GcodeError::bad_expression, at);
  if (function != exists) return push(function, at);
  is_complete = true;
  return name_exists();
}

/// After #: reads a name or a plain number, or what waits for the number.
bool Expressions::begin_parameter(bool& is_complete, std::uint16_t index) {
  std::uint32_t number = 0;
  is_complete = true;
  if (text_.peek() == '<') return check(text_.take_name(), index) && push_named(index);
  if (text_.take_whole(number))
    return check_number(number, max_predefined, index) && push_value(value_of(number));
  is_complete = false;
  return push(fetch_parameter, index);
}

/// EXISTS[#<name>], after its name.
bool Expressions::name_exists() {
  const std::uint16_t at = text_.index();
  if (!text_.take('[') || !text_.take('#') || text_.peek() != '<')
    return fail(GcodeError::bad_expression, at);
  if (!check(text_.take_name(), at)) return false;
  if (!text_.take(']')) return fail(GcodeError::bad_expression, at);
  std::int64_t e9 = 0;
  const bool is_set = predefined_.find(text_.name(), e9) || variables_.find(text_.name(), e9);
  return push_value(is_set ? one_e9 : 0);
}

bool Expressions::push_named(std::uint16_t index) {
  std::int64_t e9 = 0;
  if (!predefined_.find(text_.name(), e9) && !variables_.find(text_.name(), e9))
    return fail(GcodeError::unknown_name, index);
  return push_value(e9);
}

/// After a value: what waits for it, then the next operator or the end of its bracket.
bool Expressions::end_value(bool& is_over) {
  for (;;) {
    if (!complete_value()) return false;
    is_over = waiting_size_ == 0;
    if (is_over) return true;
    if (!text_.take(']')) return add_operator();
    bool is_complete = false;
    if (!close_bracket(is_complete)) return false;
    if (!is_complete) return true;
  }
}

/// Signs and # belong to the value that follows them.
bool Expressions::complete_value() {
  std::int64_t& e9 = values_e9_[values_size_ - 1u];
  for (; waiting_size_ != 0; --waiting_size_) {
    const Waiting waiting = waiting_[waiting_size_ - 1u];
    if (waiting == negate)
      e9 = -e9;
    else if (waiting != fetch_parameter)
      return true;
    else if (!fetch(e9, places_[waiting_size_ - 1u]))
      return false;
  }
  return true;
}

/// At the end of a bracket. `is_complete`: its value is known; else that of ATAN's second bracket
/// follows.
bool Expressions::close_bracket(bool& is_complete) {
  if (!calculate_down_to(0)) return false;
  const Waiting opened = waiting_[--waiting_size_];
  const std::uint16_t at = places_[waiting_size_];
  if (opened == first_of_two) {
    if (!text_.take('/') || !text_.take('[')) return fail(GcodeError::bad_expression, at);
    return push(second_of_two, at);
  }
  is_complete = true;
  if (opened == second_of_two) {
    --values_size_;
    std::int64_t& y_e9 = values_e9_[values_size_ - 1u];
    y_e9 = arc_tangent_e9(y_e9, values_e9_[values_size_]);
    return true;
  }
  if (opened == bracket) return true;
  std::int64_t& e9 = values_e9_[values_size_ - 1u];
  return check(calculate(static_cast<Function>(opened - first_function), e9, e9), at);
}

bool Expressions::find_operator(Operator& op) {
  if (text_.take('*'))
    op = text_.take('*') ? Operator::power : Operator::times;
  else if (text_.take('/'))
    op = Operator::divide;
  else if (text_.take('+'))
    op = Operator::plus;
  else if (text_.take('-'))
    op = Operator::minus;
  else
    return find_operator_word(op);
  return true;
}

bool Expressions::find_operator_word(Operator& op) {
  const std::uint16_t from = text_.index();
  Letters letters = text_.take_letters(2);
  for (const OperatorRow& row : operator_rows) {
    constexpr Letters more_than_two = 1u << 10;
    if (row.letters >= more_than_two && letters < more_than_two) {
      if (!is_letter(text_.peek())) break;
      letters = with_letter(letters, static_cast<char>(text_.take_letters(1)));
    }
    op = row.op;
    if (row.letters == letters) return true;
  }
  text_.go_to(from);
  return false;
}

/// Index of the innermost bracket that is open.
std::uint16_t Expressions::open_bracket() const {
  std::uint32_t i = waiting_size_ - 1u;
  while (i != 0 && is_operator(waiting_[i])) --i;
  return places_[i];
}

/// Operators of the same and of higher precedence before this one are executed.
bool Expressions::add_operator() {
  const char c = text_.peek();
  const std::uint16_t at = text_.index();
  Operator op{};
  if (c == 0) return fail(GcodeError::bad_expression, open_bracket());
  if (!find_operator(op)) {
    return fail(is_letter(c) ? GcodeError::unknown_operator : GcodeError::bad_expression, at);
  }
  return calculate_down_to(precedence_of(op)) &&
         push(static_cast<Waiting>(first_operator + static_cast<int>(op)), at);
}

bool Expressions::calculate_down_to(int precedence) {
  for (; waiting_size_ != 0; --waiting_size_) {
    const Waiting waiting = waiting_[waiting_size_ - 1u];
    if (!is_operator(waiting) || precedence_of(operator_of(waiting)) < precedence) return true;
    --values_size_;
    std::int64_t& a_e9 = values_e9_[values_size_ - 1u];
    const GcodeError error = calculate(operator_of(waiting), a_e9, values_e9_[values_size_], a_e9);
    if (!check(error, places_[waiting_size_ - 1u])) return false;
  }
  return true;
}

/// A whole number from 1, of a parameter.
bool Expressions::parameter_number(std::int64_t e9, std::uint32_t max, std::uint16_t index,
                                   std::uint32_t& number) {
  if (e9 < 0) return fail(GcodeError::out_of_range, index);
  const std::int64_t rounded = (e9 + equal_tolerance_e9) / one_e9;
  if (abs64(e9 - rounded * one_e9) > equal_tolerance_e9)
    return fail(GcodeError::not_integer, index);
  number = rounded > std::int64_t{max} ? 0 : static_cast<std::uint32_t>(rounded);
  return check_number(number, max, index);
}

bool Expressions::check_number(std::uint32_t number, std::uint32_t max, std::uint16_t index) {
  return (number >= 1 && number <= max) || fail(GcodeError::out_of_range, index);
}

std::int64_t Expressions::value_of(std::uint32_t number) const {
  return number <= Variables::max_number ? variables_.value_e9(number)
                                         : predefined_.value_e9(number);
}

/// Replaces the number of a parameter by its value.
bool Expressions::fetch(std::int64_t& e9, std::uint16_t index) {
  std::uint32_t number = 0;
  if (!parameter_number(e9, max_predefined, index, number)) return false;
  e9 = value_of(number);
  return true;
}

bool Expressions::push(Waiting waiting, std::uint16_t index) {
  if (waiting_size_ == max_waiting) return fail(GcodeError::nested_too_deep, index);
  waiting_[waiting_size_] = waiting;
  places_[waiting_size_++] = index;
  return true;
}

bool Expressions::push_value(std::int64_t e9) {
  if (values_size_ == max_values) return fail(GcodeError::nested_too_deep, text_.index());
  values_e9_[values_size_++] = e9;
  return true;
}

}  // namespace lamplock::program
