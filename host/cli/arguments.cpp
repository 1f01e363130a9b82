#include "host/cli/arguments.hpp"

#include <algorithm>
#include <cctype>

namespace lamplock::cli {
namespace {

bool has_name(const Option& option, const std::string& name) {
  const auto names = option.typed_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

const Command* find_command(const Command& command, const std::string& name) {
  for (const Command& inner : command.commands())
    if (inner.name() == name) return &inner;
  return nullptr;
}

bool is_list(const Option& positional) {
  return std::holds_alternative<std::vector<std::string>*>(positional.target());
}

/// "-5" is a number.
bool looks_like_option(const std::string& text) {
  return text.size() > 1 && text[0] == '-' && text != "--" &&
         std::isdigit(static_cast<unsigned char>(text[1])) == 0;
}

class Walk {
 public:
  Walk(const Command& program, const std::vector<std::string>& arguments)
      : command_(&program), rest_(arguments) {}

  std::vector<Argument> take_all() {
    bool only_names = false;
    for (; at_ < rest_.size(); ++at_) {
      const std::string& text = rest_[at_];
      if (!only_names && text == "--")
        only_names = true;
      else if (!only_names && looks_like_option(text))
        take_option(text);
      else
        take_word(text);
    }
    return std::move(found_);
  }

 private:
  void add(ArgumentKind kind, std::string text, const Option* option = nullptr) {
    found_.push_back({kind, std::move(text), command_, option});
  }

  void take_option(const std::string& text) {
    const bool is_long = text.starts_with("--");
    const auto equals = is_long ? text.find('=') : std::string::npos;
    const std::string name = is_long ? text.substr(0, equals) : text.substr(0, 2);
    const Option* option = find_option(*command_, name);
    // "-output" is not "-o utput".
    const bool lacks_dash = !is_long && text.size() > 2 && find_option(*command_, '-' + text);
    if (option == nullptr || lacks_dash)
      return add(ArgumentKind::unknown_option, is_long ? name : text);
    add(ArgumentKind::option, name, option);
    const std::string attached =
        is_long ? equals == std::string::npos ? "" : text.substr(equals + 1) : text.substr(2);
    // "--output=" has an empty value; it does not take the next word.
    const bool has_empty_value = equals != std::string::npos && !option->is_flag();
    if (!attached.empty() || has_empty_value)
      add(ArgumentKind::value, attached, option);
    else if (takes_value(*option) && at_ + 1 < rest_.size())
      add(ArgumentKind::value, rest_[++at_], option);
  }

  void take_word(const std::string& text) {
    if (const Command* inner = find_command(*command_, text)) {
      command_ = inner;
      positionals_ = 0;
      return add(ArgumentKind::command, text);
    }
    if (const Option* positional = next_positional())
      return add(ArgumentKind::positional, text, positional);
    add(command_->commands().empty() ? ArgumentKind::surplus : ArgumentKind::unknown_command, text);
  }

  const Option* next_positional() {
    std::size_t place = 0;
    for (const Option& option : command_->options()) {
      if (!option.is_positional()) continue;
      if (place++ < positionals_ && !is_list(option)) continue;
      ++positionals_;
      return &option;
    }
    return nullptr;
  }

  const Command* command_;
  const std::vector<std::string>& rest_;
  std::size_t at_ = 0, positionals_ = 0;
  std::vector<Argument> found_{};
};

}  // namespace

std::vector<Argument> understood(const Command& program,
                                 const std::vector<std::string>& arguments) {
  return Walk(program, arguments).take_all();
}

const Option* find_option(const Command& command, const std::string& name) {
  if (has_name(help_option(), name)) return &help_option();
  if (!command.version().empty() && has_name(version_option(), name)) return &version_option();
  for (const Option& option : command.options())
    if (has_name(option, name)) return &option;
  return nullptr;
}

bool takes_value(const Option& option) { return !option.is_flag() && option.bare().empty(); }

std::string path_of(const Command& program, const std::vector<Argument>& arguments,
                    std::size_t count) {
  std::string path = program.name();
  for (std::size_t i = 0; i < count; ++i)
    if (arguments[i].kind == ArgumentKind::command) path += ' ' + arguments[i].text;
  return path;
}

}  // namespace lamplock::cli
