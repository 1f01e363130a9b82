#include "host/cli/command_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <type_traits>

namespace lamplock::cli {
namespace {

template <class Value>
std::string text_of(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>)
    return fmt::format("{}", value);
  else
    return "";
}

/// What the help shows for a value that has no name of its own.
struct ValueName {
  template <class Value>
  const char* operator()(const Value*) const {
    return "N";
  }
  const char* operator()(const std::string*) const { return "TEXT"; }
  const char* operator()(const std::optional<std::string>*) const { return "TEXT"; }
  const char* operator()(const std::vector<std::string>*) const { return "TEXT"; }
  const char* operator()(const bool*) const { return ""; }
  const char* operator()(const std::optional<bool>*) const { return ""; }
};

}  // namespace

std::string count_text(const Count& count) {
  if (count.min == count.max)
    return fmt::format("{} number{}", count.min, count.min == 1 ? "" : "s");
  if (count.min == 0) return fmt::format("at most {} numbers", count.max);
  return fmt::format("{} to {} numbers", count.min, count.max);
}

Option::Option(std::string names, Target target, std::string help)
    : names_(std::move(names)), value_name_(std::visit(ValueName(), target)), target_(target) {
  this->help(std::move(help));
}

Option& Option::value_name(std::string name) {
  value_name_ = std::move(name);
  return *this;
}

Option& Option::group(std::string name) {
  group_ = std::move(name);
  return *this;
}

Option& Option::check(Check check) {
  check_ = std::move(check);
  return *this;
}

Option& Option::required(bool is_required) {
  is_required_ = is_required;
  return *this;
}

Option& Option::show_default() {
  default_ = std::visit([](const auto* value) { return text_of(*value); }, target_);
  return *this;
}

Option& Option::count(Count count) {
  count_ = count;
  return *this;
}

Option& Option::comma_separated() {
  is_comma_separated_ = true;
  return *this;
}

Option& Option::environment(std::string variable) {
  environment_ = std::move(variable);
  return *this;
}

Option& Option::excludes(const Option& other) {
  excluded_.push_back(&other);
  return *this;
}

Option& Option::bare(std::string text) {
  bare_ = std::move(text);
  return *this;
}

Option& Option::needs(const Option& other) {
  needed_ = &other;
  return *this;
}

Option& Option::for_version() {
  is_for_version_ = true;
  return *this;
}

Option& Option::common() {
  is_common_ = true;
  return *this;
}

Option& Option::completions(std::vector<std::string> words) {
  completions_ = std::move(words);
  return *this;
}

Option& Option::file(FileUse use, std::string ending) {
  file_use_ = use;
  file_ending_ = std::move(ending);
  return *this;
}

Option& Option::help(std::string text) {
  constexpr std::string_view begin_of_default = "; default: ";
  help_ = std::move(text);
  if (const auto at = help_.rfind(begin_of_default); at != std::string::npos) {
    default_ = help_.substr(at + begin_of_default.size());
    help_.resize(at);
  }
  return *this;
}

bool Option::is_flag() const {
  return std::holds_alternative<bool*>(target_) ||
         std::holds_alternative<std::optional<bool>*>(target_);
}

std::vector<std::string> Option::typed_names() const {
  if (is_positional()) return {};
  std::vector<std::string> names;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = names_.find(',', begin);
    names.push_back(names_.substr(begin, end == std::string::npos ? end : end - begin));
  }
  if (std::holds_alternative<std::optional<bool>*>(target_))
    names.push_back("--no-" + names.back().substr(2));
  return names;
}

std::string Option::name() const {
  const auto names = typed_names();
  const auto is_long = [](const std::string& name) { return name.starts_with("--"); };
  const auto found = std::find_if(names.begin(), names.end(), is_long);
  return found == names.end() ? names_ : *found;
}

Command& Command::add_command(std::string name, std::string description) {
  return commands_.emplace_back(std::move(name), std::move(description));
}

Option& Command::add_option(std::string names, Target target, std::string help) {
  return options_.emplace_back(std::move(names), target, std::move(help));
}

Option& Command::add_json(bool& json, std::string help) {
  return add_option("--json", &json, std::move(help)).common();
}

const Option& Command::option(const std::string& name) const {
  for (const Option& option : options_) {
    const auto names = option.typed_names();
    if (std::find(names.begin(), names.end(), name) != names.end()) return option;
  }
  throw std::logic_error("lamplock " + name_ + " has no option " + name);
}

const Option& help_option() {
  static bool is_asked = false;
  static const Option option =
      Option("-h,--help", &is_asked, "Show the common options (-h) or all options (--help)")
          .common();
  return option;
}

const Option& version_option() {
  static bool is_asked = false;
  static const Option option("--version", &is_asked, "Show the version of the program");
  return option;
}

}  // namespace lamplock::cli
