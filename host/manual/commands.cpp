#include "host/manual/commands.hpp"

#include "host/cli/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace lamplock::manual {
namespace {

/// Parts of an argument: alternatives and sequences.
std::vector<std::string> parts_of(const cli::Option& option) {
  std::vector<std::string> parts(1);
  for (const char c : argument_of(option))
    if (c == '|' || c == ',' || c == ' ')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

bool has_part(const cli::Option& option, std::initializer_list<std::string_view> wanted) {
  const auto parts = parts_of(option);
  return std::any_of(parts.begin(), parts.end(), [&](const std::string& part) {
    return std::any_of(wanted.begin(), wanted.end(),
                       [&](std::string_view word) { return part.starts_with(word); });
  });
}

bool is_word(const std::string& part) {
  return !part.empty() && std::islower(static_cast<unsigned char>(part[0])) != 0 &&
         part.find('.') == std::string::npos;
}

}  // namespace

std::vector<const cli::Option*> options_of(const cli::Command& command) {
  std::vector<const cli::Option*> options{&cli::help_option()};
  if (!command.version().empty()) options.push_back(&cli::version_option());
  for (const cli::Option& option : command.options())
    if (!option.is_positional() && !option.group().empty()) options.push_back(&option);
  return options;
}

std::vector<const cli::Option*> positionals_of(const cli::Command& command) {
  std::vector<const cli::Option*> positionals;
  for (const cli::Option& option : command.options())
    if (option.is_positional()) positionals.push_back(&option);
  return positionals;
}

std::string argument_of(const cli::Option& option) {
  return option.is_flag() || !option.bare().empty() ? "" : option.value_name();
}

std::vector<std::string> words_of(const cli::Option& option) {
  if (argument_of(option).find('|') == std::string::npos) return {};
  std::vector<std::string> words;
  for (const std::string& part : parts_of(option))
    if (is_word(part)) words.push_back(part);
  return words;
}

bool takes_file(const cli::Option& option) { return has_part(option, {"FILE", "DIR", "FOLDER"}); }

bool takes_port(const cli::Option& option) { return has_part(option, {"PORT"}); }

}  // namespace lamplock::manual
