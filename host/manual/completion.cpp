#include "host/manual/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/manual/commands.hpp"

namespace lamplock::manual {
namespace {

/// A command and the words that lead to it: "", "engrave", "operate zero".
using Visit = std::function<void(const cli::Command&, const std::string& path)>;

void visit(const cli::Command& app, const std::string& path, const Visit& what) {
  what(app, path);
  for (const cli::Command& inner : app.commands())
    visit(inner, path.empty() ? inner.name() : path + " " + inner.name(), what);
}

/// All words that may be next in a command.
std::vector<std::string> next_words(const cli::Command& app) {
  std::vector<std::string> words;
  for (const cli::Command& inner : app.commands()) words.push_back(inner.name());
  for (const cli::Option* option : options_of(app))
    for (const std::string& name : option->typed_names()) words.push_back(name);
  return words;
}

/// Words offered for the arguments of a command that are no options.
std::vector<std::string> offered_words(const cli::Command& app) {
  std::vector<std::string> words;
  for (const cli::Option* option : positionals_of(app))
    words.insert(words.end(), option->completions().begin(), option->completions().end());
  return words;
}

/// The command has an argument whose values are not all known: usually files.
bool takes_names(const cli::Command& app) {
  const auto positionals = positionals_of(app);
  return std::any_of(positionals.begin(), positionals.end(),
                     [](const cli::Option* option) { return option->completions().empty(); });
}

/// The lines of bash that complete the argument of an option.
std::string bash_argument(const cli::Option& option) {
  const std::string words = fmt::format("{}", fmt::join(words_of(option), " "));
  std::string lines;
  if (takes_file(option)) lines += " _lamplock_files;";
  if (takes_port(option))
    lines += fmt::format(" _lamplock_words \"{} $(compgen -G '/dev/ttyACM*')\";", words);
  else if (!words.empty())
    lines += fmt::format(" _lamplock_words \"{}\";", words);
  return lines + " return ;;\n";
}

}  // namespace

std::string bash_completion(const cli::Command& program) {
  std::string paths, words, arguments;
  visit(program, "", [&](const cli::Command& app, const std::string& path) {
    if (!path.empty()) {
      const auto blank = path.rfind(' ');
      const std::string before = blank == std::string::npos ? "" : path.substr(0, blank);
      paths += fmt::format("      \"{} {}\") command=\"{}\" ;;\n", before, app.name(), path);
    }
    std::vector<std::string> next = next_words(app), offered = offered_words(app);
    next.insert(next.end(), offered.begin(), offered.end());
    words += fmt::format("    \"{}\") words=\"{}\"{} ;;\n", path, fmt::join(next, " "),
                         takes_names(app) ? " names=yes" : "");
    for (const cli::Option* option : options_of(app))
      if (!argument_of(*option).empty())
        for (const std::string& name : option->typed_names())
          arguments += fmt::format("    \"{} {}\")", path, name) + bash_argument(*option);
  });
  return "# bash completion for lamplock, made from the options of the program itself\n"
         "_lamplock_words() { COMPREPLY+=($(compgen -W \"$1\" -- \"$word\")); }\n"
         "_lamplock_files() {\n"
         "  local IFS=$'\\n'\n"
         "  compopt -o filenames 2>/dev/null\n"
         "  COMPREPLY+=($(compgen -f -- \"$word\"))\n"
         "}\n"
         "_lamplock() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  local command='' words='' names='' value='' i\n"
         "  COMPREPLY=()\n"
         // Bash splits words at the sign: --board = usb.
         "  if [[ $word == = ]]; then word='' value=yes\n"
         "  elif [[ $before == = ]]; then before=${COMP_WORDS[COMP_CWORD - 2]} value=yes\n"
         "  fi\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case \"$command ${COMP_WORDS[i]}\" in\n" +
         paths +
         "    esac\n"
         "  done\n"
         "  case \"$command $before\" in\n" +
         arguments +
         "  esac\n"
         "  [[ -n $value ]] && return 0\n"
         "  case $command in\n" +
         words +
         "  esac\n"
         "  _lamplock_words \"$words\"\n"
         // NAME= is followed by its value at once.
         "  [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace "
         "2>/dev/null\n"
         "  [[ -n $names && $word != -* ]] && _lamplock_files\n"
         "  return 0\n"
         "}\n"
         "complete -F _lamplock lamplock\n";
}

namespace {

/// Text in single quotes of fish.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

/// Condition for a command: its words have been typed, but none of its own commands.
std::string fish_condition(const cli::Command& app, const std::string& path) {
  if (path.empty()) return "__fish_use_subcommand";
  std::string condition;
  for (std::size_t from = 0; from != std::string::npos;) {
    const std::size_t blank = path.find(' ', from);
    condition += fmt::format("{}__fish_seen_subcommand_from {}", from == 0 ? "" : "; and ",
                             path.substr(from, blank - from));
    from = blank == std::string::npos ? blank : blank + 1;
  }
  std::vector<std::string> inner;
  for (const cli::Command& command : app.commands()) inner.push_back(command.name());
  if (inner.empty()) return condition;
  return condition + fmt::format("; and not __fish_seen_subcommand_from {}", fmt::join(inner, " "));
}

std::string fish_option(const cli::Option& option, const std::string& condition) {
  std::string line = "complete -c lamplock -n " + quoted(condition);
  for (const std::string& name : option.typed_names())
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!argument_of(option).empty()) {
    const std::string words = fmt::format("{}", fmt::join(words_of(option), " "));
    line += takes_file(option) ? " -r" : " -x";
    if (takes_port(option))
      line += " -a " + quoted(words + " (ls /dev/ttyACM* 2>/dev/null)");
    else if (!words.empty())
      line += " -a " + quoted(words);
  }
  return line + " -d " + quoted(option.help()) + "\n";
}

}  // namespace

std::string fish_completion(const cli::Command& program) {
  std::string script =
      "# fish completion for lamplock, made from the options of the program itself\n"
      "complete -c lamplock -n __fish_use_subcommand -f\n";
  visit(program, "", [&](const cli::Command& app, const std::string& path) {
    const std::string condition = fish_condition(app, path);
    for (const cli::Command& command : app.commands())
      script += fmt::format("complete -c lamplock -n {} -f -a {} -d {}\n", quoted(condition),
                            command.name(), quoted(command.description()));
    for (const cli::Option* option : options_of(app)) script += fish_option(*option, condition);
    if (const auto words = offered_words(app); !words.empty())
      script += fmt::format("complete -c lamplock -n {} -f -a {}\n", quoted(condition),
                            quoted(fmt::format("{}", fmt::join(words, " "))));
  });
  return script;
}

}  // namespace lamplock::manual
