#include "host/manual/commands.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace lamplock::manual {
namespace {

/// Parts of an argument: alternatives, and what follows each other.
std::vector<std::string> parts_of(const CLI::Option& option) {
  std::vector<std::string> parts(1);
  for (const char c : argument_of(option))
    if (c == '|' || c == ',' || c == ' ')
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

bool has_part(const CLI::Option& option, std::initializer_list<std::string_view> wanted) {
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

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) {
    return !command->get_name().empty() && !command->get_group().empty();
  });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) {
    return !option->get_positional() && !option->get_group().empty();
  });
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) {
    return option->get_positional() && !option->get_group().empty();
  });
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  names.reserve(option.get_snames().size() + option.get_lnames().size());
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string argument_of(const CLI::Option& option) {
  return option.get_items_expected_max() == 0 ? "" : option.get_type_name();
}

std::vector<std::string> words_of(const CLI::Option& option) {
  if (argument_of(option).find('|') == std::string::npos) return {};
  std::vector<std::string> words;
  for (const std::string& part : parts_of(option))
    if (is_word(part)) words.push_back(part);
  return words;
}

bool takes_file(const CLI::Option& option) { return has_part(option, {"FILE", "DIR", "FOLDER"}); }

bool takes_port(const CLI::Option& option) { return has_part(option, {"PORT"}); }

}  // namespace lamplock::manual
