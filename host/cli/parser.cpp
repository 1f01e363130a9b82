#include "host/cli/parser.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "host/cli/arguments.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/help.hpp"
#include "host/cli/separate_program.hpp"
#include "host/cli/standard_streams.hpp"
#include "host/cli/terminal_width.hpp"
#include "host/cli/usage_error.hpp"
#include "host/cli/value_use.hpp"
#include "host/former_names.hpp"
#include "host/text.hpp"

namespace lamplock::cli {
namespace {

/// Which of our options and commands CLI11's belong to.
struct Bound {
  std::vector<std::pair<Option*, CLI::Option*>> options{};
  std::vector<std::pair<const Command*, const CLI::App*>> commands{};

  CLI::Option* parsed(const Option& option) const {
    for (const auto& [ours, theirs] : options)
      if (ours == &option) return theirs;
    return nullptr;
  }
  void set_given() const {
    for (const auto& [option, parsed] : options) option->set_given(parsed->count() > 0);
  }
};

/// Adds one option, by the kind of its value.
class Binder {
 public:
  Binder(CLI::App& app, const Option& option) : app_(app), option_(option) {}

  CLI::Option* bind() const {
    return std::visit([this](auto* place) { return add(*place); }, option_.target());
  }

 private:
  template <class Value>
  CLI::Option* add(Value& value) const {
    return app_.add_option(option_.names(), value, option_.help());
  }
  /// CLI11 takes the greatest number for one that is greater still.
  CLI::Option* add(std::uint64_t& value) const {
    const auto refusal = [](const std::string& text) -> std::string {
      const bool plus = text.starts_with('+');
      return number_of<std::uint64_t>(text.substr(plus ? 1 : 0)) ? "" : text + " is out of range";
    };
    return app_.add_option(option_.names(), value, option_.help())
        ->check(CLI::Validator(refusal, ""));
  }
  CLI::Option* add(bool& value) const {
    return app_.add_flag(option_.names(), value, option_.help());
  }
  CLI::Option* add(std::optional<bool>& value) const {
    const std::string name = option_.names();
    return app_.add_flag_function(
        fmt::format("{},!--no-{}", name, name.substr(2)),
        [&value](std::int64_t count) { value = count > 0; }, option_.help());
  }
  CLI::Option* add(std::string& value) const {
    if (option_.bare().empty()) return app_.add_option(option_.names(), value, option_.help());
    return app_.add_flag(fmt::format("{}{{{}}}", option_.names(), option_.bare()), value,
                         option_.help());
  }
  CLI::Option* add(std::optional<std::array<double, 3>>& value) const {
    return add_numbers<double>([&value](const std::vector<double>& numbers) {
      value.emplace();
      std::copy(numbers.begin(), numbers.end(), value->begin());
    });
  }
  CLI::Option* add(std::vector<double>& value) const { return add_list(value); }
  CLI::Option* add(std::vector<std::int64_t>& value) const { return add_list(value); }
  CLI::Option* add(std::vector<std::string>& value) const {
    CLI::Option* made = app_.add_option(option_.names(), value, option_.help());
    if (option_.is_comma_separated()) made->delimiter(',');
    return option_.is_positional() ? made : made->allow_extra_args(false);
  }

  template <class Number>
  CLI::Option* add_list(std::vector<Number>& value) const {
    return add_numbers<Number>([&value](const std::vector<Number>& numbers) { value = numbers; });
  }
  /// Each number is checked by itself, then their count.
  template <class Number, class Take>
  CLI::Option* add_numbers(Take take) const {
    const auto counted = [take, &option = option_](const std::vector<Number>& numbers) {
      if (const auto& count = option.count();
          count && (numbers.size() < count->min || numbers.size() > count->max))
        throw CLI::ArgumentMismatch(fmt::format("{}: takes {}: {}", option.name(),
                                                count_text(*count), option.value_name()));
      take(numbers);
    };
    return app_.add_option_function<std::vector<Number>>(option_.names(), counted, option_.help())
        ->delimiter(',')
        ->allow_extra_args(false);  // the next word is not another number
  }

  CLI::App& app_;
  const Option& option_;
};

void bind(CLI::App& app, Option& option, Bound& bound) {
  CLI::Option* made = Binder(app, option).bind();
  made->group(option.group())->required(option.is_required());
  if (!option.value_name().empty() && option.bare().empty()) made->type_name(option.value_name());
  if (!option.default_text().empty()) made->default_str(option.default_text());
  if (!option.environment().empty()) made->envname(option.environment());
  if (option.check().refusal) made->check(CLI::Validator(option.check().refusal, ""));
  bound.options.emplace_back(&option, made);
}

bool contains(const std::vector<std::string>& arguments, const std::string& name) {
  return std::find(arguments.begin(), arguments.end(), name) != arguments.end();
}

/// Inner commands that no argument names get no options: to bind those of all takes longer than the
/// rest of a short run.
void bind(CLI::App& app, Command& command, const std::vector<std::string>& arguments,
          Bound& bound) {
  if (!command.footer().empty()) app.footer(command.footer());  // else that of the outer command
  app.set_help_flag();                                          // the parser answers it first
  CLI::Option* version = nullptr;
  if (!command.version().empty())
    version =
        app.set_version_flag(version_option().names(), command.version(), version_option().help());
  for (Option& option : command.options()) {
    bind(app, option, bound);
    if (option.is_for_version()) bound.parsed(option)->needs(version);
  }
  for (const Option& option : command.options())
    if (option.needed() != nullptr) bound.parsed(option)->needs(bound.parsed(*option.needed()));
  for (const Option& option : command.options())
    for (const Option* other : option.excluded())
      bound.parsed(option)->excludes(bound.parsed(*other));
  if (command.needs_command())
    app.require_subcommand(1);
  else if (!command.commands().empty())
    app.require_subcommand(0, 1);
  bound.commands.emplace_back(&command, &app);
  for (Command& inner : command.commands()) {
    CLI::App* added = app.add_subcommand(inner.name(), inner.description());
    if (contains(arguments, inner.name())) bind(*added, inner, arguments, bound);
  }
}

/// What CLI11 found wrong, for rules that only CLI11 knows.
Error error_of_parser(const CLI::App& program, const CLI::ParseError& error) {
  const auto commands = program.get_subcommands();
  const std::string name = commands.empty() ? "lamplock" : "lamplock " + commands[0]->get_name();
  std::string where = name, what = error.what();
  const auto colon = what.find(": ");
  if (what.starts_with("-") && colon != std::string::npos) {
    where = what.substr(0, colon);
    what.erase(0, colon + 2);
  }
  return {Exit::bad_input, where, what, "see " + name + " --help"};
}

/// The innermost command that was given.
const Command& chosen(const Bound& bound) {
  const Command* chosen = bound.commands.front().first;
  for (const auto& [command, app] : bound.commands)
    if (app->parsed()) chosen = command;
  return *chosen;
}

/// The command that is a program of its own, if it is the one that is named.
const Command* separate_program(const Command& program, const std::vector<std::string>& arguments) {
  if (arguments.empty()) return nullptr;
  for (const Command& command : program.commands())
    if (command.name() == arguments[0] && !command.separate_program().empty()) return &command;
  return nullptr;
}

bool asks_for_help(const std::vector<std::string>& arguments) {
  return contains(arguments, "-h") || contains(arguments, "--help");
}

/// The command that arguments name, as far as they name one.
const Command& named(const Command& program, const std::vector<std::string>& arguments) {
  const Command* command = &program;
  for (const std::string& argument : arguments)
    for (const Command& inner : command->commands())
      if (inner.name() == argument) {
        command = &inner;
        break;
      }
  return *command;
}

bool has_option(const Command& command, std::string_view name) {
  return std::any_of(command.options().begin(), command.options().end(),
                     [name](const auto& option) {
                       const auto names = option.typed_names();
                       return std::find(names.begin(), names.end(), name) != names.end();
                     });
}

/// The arguments with the present names of options, and a note for each former one.
std::vector<std::string> with_present_names(const Command& program,
                                            std::vector<std::string> arguments) {
  const Command& command = named(program, arguments);
  for (std::string& argument : arguments) {
    const std::string former = argument.substr(0, argument.find('='));
    const std::string_view present = present_name(former);
    if (present == former || !has_option(command, present)) continue;
    note_former_name("lamplock " + command.name(), former);
    argument.replace(0, former.size(), present);
  }
  return arguments;
}

/// Prints the help of the command before the first -h or --help; false without one. A wrong name of
/// a command before it is an error.
bool print_help(const Command& program, const std::vector<std::string>& arguments) {
  const std::vector<Argument> all = understood(program, arguments);
  const auto asked = std::find_if(all.begin(), all.end(), [](const Argument& argument) {
    return argument.kind == ArgumentKind::option && argument.option == &help_option();
  });
  if (asked == all.end()) return false;
  const bool is_wrong_name = std::any_of(all.begin(), asked, [](const Argument& argument) {
    return argument.kind == ArgumentKind::unknown_command;
  });
  if (is_wrong_name)
    if (const auto error = usage_error(program, arguments)) throw Error(*error);
  const auto place = static_cast<std::size_t>(asked - all.begin());
  const HelpKind kind = asked->text == "--help" ? HelpKind::all : HelpKind::common;
  write_text(stdout,
             help_text(*asked->command, path_of(program, all, place), kind, terminal_width()));
  return true;
}

}  // namespace

Exit run(Command& program, const std::vector<std::string>& arguments) {
  if (const Command* command = separate_program(program, arguments))
    if (has_separate_program(*command) || !asks_for_help(arguments))
      run_separate_program(*command, arguments);
  const std::vector<std::string> present = with_present_names(program, arguments);
  if (print_help(program, present)) return Exit::done;
  if (const auto found = wrong_value_use(program, present)) throw Error(*found);
  CLI::App app(program.description(), program.name());
  Bound bound;
  bind(app, program, present, bound);
  std::vector<std::string> reversed = present;
  std::reverse(reversed.begin(), reversed.end());
  try {
    app.parse(reversed);
  } catch (const CLI::CallForVersion& version) {
    if (const auto found = usage_error(program, present)) throw Error(*found);
    bound.set_given();
    if (program.version_action()) return program.version_action()();
    app.exit(version);
    return Exit::done;
  } catch (const CLI::ParseError& error) {
    if (const auto found = usage_error(program, present)) throw Error(*found);
    throw error_of_parser(app, error);
  }
  bound.set_given();
  const Command& command = chosen(bound);
  check_files(command);
  return command.action()();
}

}  // namespace lamplock::cli
