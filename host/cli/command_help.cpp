// `lamplock help`: the help of a command, as `lamplock COMMAND --help`.
#include <memory>
#include <string>
#include <vector>

#include "host/cli/arguments.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/separate_program.hpp"
#include "host/cli/standard_streams.hpp"
#include "host/cli/terminal_width.hpp"
#include "host/cli/usage_error.hpp"

namespace lamplock::cli {
namespace {

Exit help(const Command& program, const std::vector<std::string>& words) {
  const std::vector<Argument> arguments = understood(program, words);
  for (const Argument& argument : arguments)
    if (argument.kind == ArgumentKind::unknown_command ||
        argument.kind == ArgumentKind::unknown_option)
      if (const auto error = usage_error(program, words)) throw Error(*error);
  const Command& command = arguments.empty() ? program : *arguments.back().command;
  if (!command.separate_program().empty() && has_separate_program(command))
    run_separate_program(command, {command.name(), "--help"});
  write_text(stdout, help_text(command, path_of(program, arguments, arguments.size()),
                               HelpKind::all, terminal_width()));
  return Exit::done;
}

}  // namespace

void add_help(Command& program) {
  Command& app = program.add_command("help", "Show the help of a command");
  app.footer("Example:\n  lamplock help engrave\n  lamplock help settings get");
  const auto words = std::make_shared<std::vector<std::string>>();
  std::vector<std::string> names;
  for (const Command& command : program.commands()) names.push_back(command.name());
  app.add_option("COMMAND", words.get(), "Command, and a command of it; default: the overview")
      .completions(names);
  app.action([&program, words] { return help(program, *words); });
}

}  // namespace lamplock::cli
