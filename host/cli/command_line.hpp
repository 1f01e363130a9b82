// The command line as data: commands, their options, and where the values go.
//
// In:  descriptions by each command (command_*.cpp). Out: what the parser (parser.hpp), the manual
//      pages and the completions (host/manual) read.
// No parser is included here, so that a file that has options compiles quickly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "host/error.hpp"

namespace lamplock::cli {

/// Where the value of an option goes. Booleans are flags; an optional flag has a `--no-` form too.
/// Lists of numbers are written with commas; a list of texts takes one text each time the option is
/// given, or all texts of a positional.
using Target =
    std::variant<bool*, std::optional<bool>*, int*, std::optional<int>*, std::uint32_t*,
                 std::uint64_t*, double*, std::optional<double>*, std::string*,
                 std::optional<std::string>*, std::optional<std::array<double, 3>>*,
                 std::vector<double>*, std::vector<std::int64_t>*, std::vector<std::string>*>;

/// What a value may be.
struct Check {
  /// Empty, or what is wrong with the text. Null: every text is accepted.
  std::function<std::string(const std::string& text)> refusal{};
  std::string range{};               ///< of numbers: "1 to 140"; empty: none
  std::vector<std::string> names{};  ///< allowed texts; empty: others too
};

/// How many numbers a list takes.
struct Count {
  std::size_t min = 0, max = 0;
};
/// "2 numbers", "at most 4 numbers", "2 to 3 numbers".
std::string count_text(const Count& count);

/// What a command does with the file that a value names.
enum class FileUse : std::uint8_t {
  none,          ///< the value names no file
  read,          ///< the command reads it
  write,         ///< makes or replaces it, or appends to it
  write_report,  ///< makes the files of a report in this folder
  folder         ///< reads or fills a folder that is no report of this command
};

/// One option, flag or positional.
class Option {
 public:
  Option(std::string names, Target target, std::string help);

  /// What the help shows for the value: MM, FILE, free|path. Words in lower case are typed as they
  /// are.
  Option& value_name(std::string name);
  /// Heading of the help under which the option is listed.
  Option& group(std::string name);
  Option& check(Check check);
  Option& required(bool is_required = true);
  /// Shows the present value as the default.
  Option& show_default();
  /// Numbers that a list takes.
  Option& count(Count count);
  /// A list of texts is written with commas, as numbers are.
  Option& comma_separated();
  /// Environment variable that is used when the option is not given.
  Option& environment(std::string variable);
  /// The two cannot be given together.
  Option& excludes(const Option& other);
  /// It cannot be given without the other one.
  Option& needs(const Option& other);
  /// The option may be given without a value, as `--name` alone, and is this text then; a value is
  /// written `--name=VALUE`. Texts only.
  Option& bare(std::string text);
  /// The option can be given with --version only.
  Option& for_version();
  /// One of the dozen options of its command that -h shows.
  Option& common();
  /// Words that shells offer for the value.
  Option& completions(std::vector<std::string> words);
  Option& help(std::string text);
  /// The value names a file; all outputs of a command are checked together (file_options.hpp). An
  /// output with an `ending`, ".csv", must not have that of another kind of file.
  Option& file(FileUse use, std::string ending = "");

  const std::string& names() const { return names_; }  ///< "-o,--output" or "INPUT"
  const Target& target() const { return target_; }
  const std::string& help() const { return help_; }
  const std::string& value_name() const { return value_name_; }
  const std::string& group() const { return group_; }
  const Check& check() const { return check_; }
  bool is_required() const { return is_required_; }
  const std::string& default_text() const { return default_; }  ///< empty: shows none
  const std::optional<Count>& count() const { return count_; }
  bool is_comma_separated() const { return is_comma_separated_; }
  const std::string& environment() const { return environment_; }
  const std::vector<const Option*>& excluded() const { return excluded_; }
  const std::string& bare() const { return bare_; }
  bool is_for_version() const { return is_for_version_; }
  bool is_common() const { return is_common_; }
  const std::vector<std::string>& completions() const { return completions_; }
  FileUse file_use() const { return file_use_; }
  const Option* needed() const { return needed_; }  ///< null: none
  const std::string& file_ending() const { return file_ending_; }

  bool is_positional() const { return !names_.starts_with('-'); }
  bool is_flag() const;
  /// Names as they are typed, "-o" before "--output"; none for a positional.
  std::vector<std::string> typed_names() const;
  /// The long name, else the only one: for messages.
  std::string name() const;

  /// Set by the parser.
  bool is_given() const { return is_given_; }
  void set_given(bool is_given) { is_given_ = is_given; }

 private:
  std::string names_, help_, value_name_, group_ = "Options", default_, environment_, bare_;
  Target target_;
  Check check_;
  std::optional<Count> count_;
  std::vector<const Option*> excluded_;
  bool is_required_ = false, is_comma_separated_ = false, is_given_ = false;
  bool is_for_version_ = false, is_common_ = false;
  std::vector<std::string> completions_;
  FileUse file_use_ = FileUse::none;
  std::string file_ending_;
  const Option* needed_ = nullptr;
};

/// What a command does; returns the exit status or throws lamplock::Error.
using Action = std::function<Exit()>;

/// A command: options, and commands of its own or an action. A command with commands and without an
/// action needs one of them.
class Command {
 public:
  Command(std::string name, std::string description)
      : name_(std::move(name)), description_(std::move(description)) {}
  // Commands and options are referred to.
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  Command& add_command(std::string name, std::string description);
  /// The place of the value must outlive the parsing. An empty group hides the option.
  Option& add_option(std::string names, Target target, std::string help);
  /// Adds --json with this help.
  Option& add_json(bool& json, std::string help = "Print the result as JSON on stdout");
  /// Text after the options: explanations, and examples after a line "Example:".
  void footer(std::string text) { footer_ = std::move(text); }
  void action(Action action) { action_ = std::move(action); }
  /// The words of the command line, the program's name as it was typed first. Set by program_main()
  /// in its command.
  const std::vector<std::string>& typed() const { return typed_; }
  void set_typed(std::vector<std::string> words) { typed_ = std::move(words); }
  /// What --version prints; without it the command has no --version.
  void version(std::string text) { version_ = std::move(text); }
  /// What --version does instead of printing that text.
  void version_action(Action action) { version_action_ = std::move(action); }
  /// The command is a program of its own beside this one, which gets all of its arguments.
  void separate_program(std::string name) { separate_program_ = std::move(name); }

  const std::string& name() const { return name_; }
  const std::string& description() const { return description_; }
  const std::string& footer() const { return footer_; }
  const std::string& version() const { return version_; }
  const Action& version_action() const { return version_action_; }
  const std::string& separate_program() const { return separate_program_; }
  const std::list<Option>& options() const { return options_; }
  std::list<Option>& options() { return options_; }
  const std::list<Command>& commands() const { return commands_; }
  std::list<Command>& commands() { return commands_; }
  const Action& action() const { return action_; }
  bool needs_command() const { return !commands_.empty() && !action_; }
  /// The option with this typed name; there must be one.
  const Option& option(const std::string& name) const;

 private:
  std::string name_, description_, footer_, version_, separate_program_;
  std::vector<std::string> typed_;
  std::list<Option> options_;
  std::list<Command> commands_;
  Action action_, version_action_;
};

/// Options that the parser handles itself: -h of every command, --version of those that have one.
const Option& help_option();
const Option& version_option();

}  // namespace lamplock::cli
