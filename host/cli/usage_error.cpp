#include "host/cli/usage_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string_view>
#include <type_traits>

#include "host/cli/arguments.hpp"
#include "host/cli/number_slip.hpp"
#include "host/suggestion.hpp"
#include "host/text.hpp"

namespace lamplock::cli {
namespace {

template <class Value>
constexpr bool is_whole =
    std::is_same_v<Value, int> || std::is_same_v<Value, std::uint32_t> ||
    std::is_same_v<Value, std::uint64_t> || std::is_same_v<Value, std::optional<int>> ||
    std::is_same_v<Value, std::vector<std::int64_t>>;
template <class Value>
constexpr bool is_number =
    is_whole<Value> || std::is_same_v<Value, double> ||
    std::is_same_v<Value, std::optional<double>> || std::is_same_v<Value, std::vector<double>> ||
    std::is_same_v<Value, std::optional<std::array<double, 3>>>;
template <class Value>
constexpr bool is_number_list = std::is_same_v<Value, std::vector<double>> ||
                                std::is_same_v<Value, std::vector<std::int64_t>> ||
                                std::is_same_v<Value, std::optional<std::array<double, 3>>>;

/// True for numbers that are written with commas.
bool takes_numbers(const Option& option) {
  return std::visit(
      [](auto* place) { return is_number_list<std::remove_pointer_t<decltype(place)>>; },
      option.target());
}

bool repeats(const Option& option) {
  return option.is_flag() || std::holds_alternative<std::vector<std::string>*>(option.target());
}

std::vector<std::string> parts_of(const Option& option, const std::string& text) {
  if (!takes_numbers(option) && !option.is_comma_separated()) return {text};
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

bool is_digits(std::string_view text) {
  if (text.starts_with('-')) text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// A number that is too large or too small for the type: 1e999, or a thousand digits.
bool exceeds_type(const std::string& text) {
  const std::size_t sign = text.starts_with('+') || text.starts_with('-') ? 1 : 0;
  const bool is_decimal = text.size() > sign && text[sign] >= '0' && text[sign] <= '9' &&
                          text.find_first_not_of("0123456789.eE+-") == std::string::npos;
  if (!is_decimal) return false;
  char* end = nullptr;
  errno = 0;
  std::strtod(text.c_str(), &end);
  return errno == ERANGE && *end == '\0';
}

/// The numbers that a type of whole numbers has, if the text is none of them.
template <class Value>
std::string range_of_type(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto range = [text](auto type) -> std::string {
    using Number = decltype(type);
    using Limits = std::numeric_limits<Number>;
    if (number_of<Number>(text)) return "";
    return fmt::format("{} to {}", Limits::min(), Limits::max());
  };
  if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, std::optional<int>>)
    return range(int{});
  else if constexpr (std::is_same_v<Value, std::uint32_t> || std::is_same_v<Value, std::uint64_t>)
    return range(Value{});
  else if constexpr (std::is_same_v<Value, std::vector<std::int64_t>>)
    return range(std::int64_t{});
  else
    return "";
}

/// Empty, or why the text is no value of this type.
std::string type_refusal(const Option& option, const std::string& text) {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const bool number = number_of<double>(digits).has_value();
  const bool whole =
      number_of<std::int64_t>(digits) || number_of<std::uint64_t>(digits).has_value();
  return std::visit(
      [&](auto* place) -> std::string {
        using Value = std::remove_pointer_t<decltype(place)>;
        if (is_number<Value> && !number && exceeds_type(text))
          return fmt::format("{} is out of range", text);
        if (is_number<Value> && !number) return fmt::format("'{}' is not a number", text);
        if (is_whole<Value> && !whole && is_digits(digits))
          return fmt::format("{} is out of range", text);
        if (is_whole<Value> && !whole) return fmt::format("'{}' is not a whole number", text);
        return range_of_type<Value>(text).empty() ? "" : fmt::format("{} is out of range", text);
      },
      option.target());
}

struct Unit {
  std::string_view name;  ///< of the value in the help
  std::string_view text;
};
constexpr std::array units{
    Unit{"MM", "mm"},       Unit{"HZ", "Hz"},       Unit{"US", "us"},
    Unit{"MS", "ms"},       Unit{"S", "s"},         Unit{"M_S", "m/s"},
    Unit{"M_S2", "m/s2"},   Unit{"MM_S2", "mm/s2"}, Unit{"MM_MIN", "mm/min"},
    Unit{"MM_MM", "mm/mm"}, Unit{"DEG", "degrees"}, Unit{"PERCENT", "percent"},
    Unit{"BEATS", "beats"}, Unit{"BAUD", "baud"}};

/// " mm", from the name of the value; empty for numbers without a unit.
std::string unit_of(const Option& option) {
  const std::string name = option.value_name().substr(0, option.value_name().find(','));
  for (const Unit& unit : units)
    if (unit.name == name) return fmt::format(" {}", unit.text);
  return "";
}

/// "-x"
bool is_one_letter(std::string_view option) { return option.size() == 2; }

class Usage {
 public:
  Usage(const Command& program, const std::vector<std::string>& typed)
      : program_(program), arguments_(understood(program, typed)) {}

  std::optional<Error> error() {
    for (at_ = 0; at_ < arguments_.size(); ++at_)
      if (auto error = error_at(arguments_[at_])) return error;
    if (auto error = contradiction()) return error;
    if (is_given(version_option())) return std::nullopt;  // which needs nothing else
    const Command& command = arguments_.empty() ? program_ : *arguments_.back().command;
    if (command.needs_command())
      return refusal(here(), "a command is missing", give_command(command));
    return missing(command);
  }

 private:
  static Error refusal(const std::string& where, const std::string& what,
                       const std::string& remedy) {
    return {Exit::bad_input, where, what, remedy};
  }
  /// "lamplock engrave" of the argument that is judged.
  std::string here() const {
    return path_of(program_, arguments_, std::min(at_ + 1, arguments_.size()));
  }
  std::string see_help() const { return fmt::format("see {} --help", here()); }

  std::optional<Error> error_at(const Argument& argument) const {
    switch (argument.kind) {
      case ArgumentKind::unknown_option:
        return refusal(here(), fmt::format("unknown option '{}'", argument.text),
                       remedy_for_option(argument));
      case ArgumentKind::unknown_command:
        return refusal(here(), fmt::format("unknown command '{}'", argument.text),
                       remedy_for_command(argument));
      case ArgumentKind::surplus:
        return surplus(argument);
      case ArgumentKind::option:
        return option_error(argument);
      case ArgumentKind::value:
      case ArgumentKind::positional:
        return value_error(argument);
      case ArgumentKind::command:
        return std::nullopt;
    }
    return std::nullopt;
  }

  /// Names that may have been meant by an option.
  static std::vector<std::string> names_in(const Command& command) {
    std::vector<std::string> names = help_option().typed_names();
    if (!command.version().empty()) names.push_back(version_option().name());
    for (const Option& option : command.options())
      if (!option.group().empty())
        for (const std::string& name : option.typed_names()) names.push_back(name);
    for (const Command& inner : command.commands()) names.push_back(inner.name());
    return names;
  }

  std::string remedy_for_option(const Argument& argument) const {
    const std::string question =
        question_of(similar_names(argument.text, names_in(*argument.command)));
    if (!question.empty()) return question;
    const std::string of_inner = remedy_of_inner(argument);
    if (!of_inner.empty()) return of_inner;
    for (const Command& other : program_.commands())
      if (find_option(other, argument.text) != nullptr)
        return fmt::format("lamplock {} has it; {}", other.name(), see_help());
    return see_help();
  }

  /// For an option that the commands of a group have, not the group itself: the command that was
  /// given later, else the first one that has it. Empty if none has it or a similar one.
  std::string remedy_of_inner(const Argument& argument) const {
    std::vector<std::string> names;
    for (const Command& inner : argument.command->commands()) {
      if (find_option(inner, argument.text) != nullptr) {
        const Command* named = &inner;
        for (const Argument& later : arguments_)
          for (const Command& other : argument.command->commands())
            if (later.text == other.name() && find_option(other, argument.text) != nullptr)
              named = &other;
        return fmt::format("write it after a command: {} {} {}; {}", here(), named->name(),
                           argument.text, see_help());
      }
      if (is_one_letter(argument.text)) continue;  // it is no slip of another name
      for (const std::string& name : names_in(inner))
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    const std::string question = question_of(similar_names(argument.text, names));
    return question.empty() ? ""
                            : fmt::format("{} Write it after a command; {}", question, see_help());
  }

  std::string remedy_for_command(const Argument& argument) const {
    std::vector<std::string> names;
    for (const Command& inner : argument.command->commands()) names.push_back(inner.name());
    std::error_code ignored;
    const bool is_file = std::filesystem::is_regular_file(argument.text, ignored);
    if (is_file)
      return fmt::format("give the command before the file, such as {} {} {}; {}", here(),
                         names.size() > 1 ? "engrave" : names.front(), argument.text, see_help());
    return did_you_mean(argument.text, names, give_command(*argument.command));
  }

  /// The commands of a group; the program itself has too many.
  std::string give_command(const Command& command) const {
    if (&command == &program_) return see_help();
    std::vector<std::string> names;
    for (const Command& inner : command.commands()) names.push_back(inner.name());
    return fmt::format("give {}; {}", fmt::join(names, ", "), see_help());
  }

  std::optional<Error> surplus(const Argument& argument) const {
    std::vector<std::string> words;
    for (const Argument& one : arguments_)
      if (one.kind == ArgumentKind::surplus) words.push_back(fmt::format("'{}'", one.text));
    std::vector<std::string> names;
    for (const Option& option : argument.command->options())
      for (const std::string& name : option.typed_names())
        if (name == "--" + argument.text) names.push_back(name);
    return refusal(
        here(),
        fmt::format("unexpected argument{} {}", words.size() == 1 ? "" : "s",
                    fmt::join(words, " ")),
        names.empty() ? "quote names that have blanks; " + see_help() : question_of(names));
  }

  std::optional<Error> option_error(const Argument& argument) const {
    const Option& option = *argument.option;
    if (takes_value(option) &&
        (at_ + 1 == arguments_.size() || arguments_[at_ + 1].kind != ArgumentKind::value))
      return missing_value(option, argument.text);
    if (repeats(option)) return std::nullopt;
    for (std::size_t i = 0; i < at_; ++i)
      if (arguments_[i].kind == ArgumentKind::option && arguments_[i].option == &option)
        return refusal(argument.text, "is given twice", "give it once");
    return std::nullopt;
  }

  Error missing_value(const Option& option, const std::string& name) const {
    return refusal(name, "its value is missing",
                   fmt::format("write {} {}; {}", name, option.value_name(), see_help()));
  }

  std::optional<Error> value_error(const Argument& argument) const {
    const Option& option = *argument.option;
    if (argument.kind == ArgumentKind::value && argument.text.starts_with("--") &&
        find_option(*argument.command, argument.text.substr(0, argument.text.find('='))) != nullptr)
      return missing_value(option, option.name());
    const std::vector<std::string> parts = parts_of(option, argument.text);
    for (const std::string& part : parts) {
      std::string wrong = type_refusal(option, part);
      if (wrong.empty() && option.check().refusal) wrong = option.check().refusal(part);
      if (!wrong.empty()) return refusal(option.name(), wrong, remedy_for_value(option, part));
    }
    if (const auto& count = option.count();
        takes_numbers(option) && count && (parts.size() < count->min || parts.size() > count->max))
      return refusal(
          option.name(),
          fmt::format("{} {} given", parts.size(), parts.size() == 1 ? "number is" : "numbers are"),
          fmt::format("give {}: {}", count_text(*count), option.value_name()));
    return std::nullopt;
  }

  /// How to write the number in "0,3" or "0.3mm"; empty for other texts.
  static std::string number_meant(const Option& option, const std::string& text) {
    if (type_refusal(option, text).empty()) return "";
    if (const std::string point = with_decimal_point(text); !point.empty())
      return fmt::format("write a decimal point: {} {}; ", option.name(), point);
    const std::string number = without_unit(text);
    if (number.empty() || !type_refusal(option, number).empty()) return "";
    return fmt::format("leave the unit out: {} {}; ", option.name(), number);
  }

  std::string remedy_for_value(const Option& option, const std::string& text) const {
    const Check& check = option.check();
    if (!check.names.empty())
      return did_you_mean(text, check.names,
                          fmt::format("give {}; {}", fmt::join(check.names, ", "), see_help()));
    const std::string written = takes_numbers(option) ? "" : number_meant(option, text);
    const bool is_huge = is_digits(text.starts_with('+') ? text.substr(1) : text);
    const std::string of_type = std::visit(
        [&](auto* place) {
          return is_huge ? range_of_type<std::remove_pointer_t<decltype(place)>>(text) : "";
        },
        option.target());
    // A range without an upper end does not say why a huge number is refused.
    const bool by_type = check.range.empty() || (!of_type.empty() && check.refusal(text).empty());
    const std::string range = by_type ? of_type : check.range;
    if (!range.empty())
      return fmt::format("{}give {}{}; {}", written, range, unit_of(option), see_help());
    return written + see_help();
  }

  bool is_given(const Option& option) const {
    return std::any_of(arguments_.begin(), arguments_.end(),
                       [&](const Argument& one) { return one.option == &option; });
  }

  /// Options that cannot be given together, or not alone.
  std::optional<Error> contradiction() const {
    for (const Argument& argument : arguments_) {
      if (argument.kind != ArgumentKind::option) continue;
      for (const Option* other : argument.option->excluded())
        if (is_given(*other))
          return refusal(argument.text,
                         fmt::format("cannot be given together with {}", other->name()),
                         "leave out one of them");
      if (const Option* needed = argument.option->needed(); needed != nullptr && !is_given(*needed))
        return refusal(
            argument.text, fmt::format("needs {}", needed->name()),
            fmt::format("give {} {}; {}", needed->name(), needed->value_name(), see_help()));
      if (argument.option->is_for_version() && !is_given(version_option()))
        return refusal(
            argument.text, fmt::format("needs {}", version_option().name()),
            fmt::format("write {} --version {}; {}", program_.name(), argument.text, see_help()));
    }
    return std::nullopt;
  }

  std::optional<Error> missing(const Command& command) const {
    std::vector<std::string> names, uses;
    for (const Option& option : command.options()) {
      const bool in_environment =
          !option.environment().empty() && std::getenv(option.environment().c_str()) != nullptr;
      if (!option.is_required() || is_given(option) || in_environment) continue;
      names.push_back(option.name());
      uses.push_back(option.is_positional() ? option.name()
                                            : option.name() + " " + option.value_name());
    }
    if (names.empty()) return std::nullopt;
    return refusal(
        here(),
        fmt::format("{} {} missing", fmt::join(names, " and "), names.size() == 1 ? "is" : "are"),
        fmt::format("give {}; {}", fmt::join(uses, " "), see_help()));
  }

  const Command& program_;
  const std::vector<Argument> arguments_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<Error> usage_error(const Command& program,
                                 const std::vector<std::string>& arguments) {
  return Usage(program, arguments).error();
}

}  // namespace lamplock::cli
