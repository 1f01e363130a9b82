#include "host/cli/value_use.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "host/cli/arguments.hpp"

namespace lamplock::cli {
namespace {

/// Values of other types are refused by their type: '' is not a number.
bool is_text(const Option& option) {
  return std::holds_alternative<std::string*>(option.target()) ||
         std::holds_alternative<std::optional<std::string>*>(option.target()) ||
         std::holds_alternative<std::vector<std::string>*>(option.target());
}

std::string what_of(const Option& option) {
  return option.file_use() == FileUse::none ? "has no value" : "has no name";
}

/// "--lines FILE", or "INPUT" of a positional.
std::string use_of(const Option& option) {
  return option.is_positional() ? option.name() : option.name() + " " + option.value_name();
}

Error refusal_of_argument(const Option& option, const std::string& path) {
  const std::string give = option.is_required()
                               ? fmt::format("give {}", use_of(option))
                               : fmt::format("give {} or leave it out", use_of(option));
  return {Exit::bad_input, option.name(), what_of(option),
          fmt::format("{}; see {} --help", give, path)};
}

Error refusal_of_environment(const Option& option, const std::string& path) {
  return {Exit::bad_input, option.environment(), what_of(option),
          fmt::format("unset this environment variable or give {}; see {} --help", use_of(option),
                      path)};
}

bool is_empty_variable(const std::string& name) {
  const char* const text = name.empty() ? nullptr : std::getenv(name.c_str());
  return text != nullptr && *text == '\0';
}

}  // namespace

std::optional<Error> wrong_value_use(const Command& program,
                                     const std::vector<std::string>& arguments) {
  const std::vector<Argument> all = understood(program, arguments);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool has_value =
        all[i].kind == ArgumentKind::value || all[i].kind == ArgumentKind::positional;
    if (has_value && all[i].text.empty() && is_text(*all[i].option))
      return refusal_of_argument(*all[i].option, path_of(program, all, i));
    // After one dash the letters are flags: -yv.
    if (all[i].kind == ArgumentKind::value && all[i].option->is_flag() &&
        all[i - 1].text.starts_with("--"))
      return Error{
          Exit::bad_input, all[i - 1].text, "takes no value",
          fmt::format("leave out '={}'; see {} --help", all[i].text, path_of(program, all, i))};
  }
  if (all.empty()) return std::nullopt;
  for (const Option& option : all.back().command->options()) {
    const bool is_given = std::any_of(all.begin(), all.end(), [&](const Argument& argument) {
      return argument.option == &option;
    });
    if (!is_given && is_empty_variable(option.environment()))
      return refusal_of_environment(option, path_of(program, all, all.size()));
  }
  return std::nullopt;
}

}  // namespace lamplock::cli
