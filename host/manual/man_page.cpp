#include "host/manual/man_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "host/cli/command_line.hpp"
#include "host/letter_case.hpp"
#include "host/manual/commands.hpp"

namespace lamplock::manual {
namespace {

constexpr std::size_t max_line_size = 78;

/// Escapes text: it has no escapes of roff, and its dashes are those of the keyboard.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  // At the beginning of a line these characters would be requests.
  if (result.starts_with('.') || result.starts_with('\'')) result.insert(0, "\\&");
  return result;
}

std::string bold(std::string_view text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + escaped(text) + "\\fR"; }

/// Writer of one page.
class Writer {
 public:
  void request(std::string_view line) { (text_ += line) += '\n'; }
  void section(std::string_view name) { request(fmt::format(".SH {}", in_upper_case(name))); }
  /// Writes words, broken into lines of the source.
  void words(std::string_view text) {
    std::string line;
    while (!text.empty()) {
      const std::size_t blank = std::min(text.find(' '), text.size());
      const std::string word(text.substr(0, blank));
      text.remove_prefix(std::min(blank + 1, text.size()));
      if (word.empty()) continue;
      if (!line.empty() && line.size() + 1 + word.size() > max_line_size) flush(line);
      line += (line.empty() ? "" : " ") + word;
    }
    flush(line);
  }
  /// Writes a line unchanged.
  void line(std::string_view text) { request(escaped(text)); }
  std::string take() { return std::move(text_); }

 private:
  void flush(std::string& line) {
    if (!line.empty()) request(escaped(line));
    line.clear();
  }
  std::string text_;
};

/// Writes a footer as sections: paragraphs under NOTES, lines that begin with blanks unchanged,
/// examples under EXAMPLES.
class FooterWriter {
 public:
  explicit FooterWriter(Writer& page) : page_(page) {}

  void write(std::string_view footer) {
    while (!footer.empty()) {
      const std::size_t end = std::min(footer.find('\n'), footer.size());
      take(footer.substr(0, end));
      footer.remove_prefix(std::min(end + 1, footer.size()));
    }
    end_paragraph();
    end_shown();
  }

 private:
  void take(std::string_view line) {
    if (line.starts_with(indent)) return show(line.substr(indent.size()));
    end_shown();
    if (line.empty()) return end_paragraph();
    if (line != "Example:") {
      paragraph_.append(paragraph_.empty() ? "" : " ").append(line);
      return;
    }
    end_paragraph();
    begin_section("examples");
  }

  void show(std::string_view line) {
    end_paragraph();
    if (!shown_) {
      begin_block();
      page_.request(".RS 4");
      page_.request(".nf");
    }
    shown_ = true;
    page_.line(line);
  }
  void end_shown() {
    if (!shown_) return;
    page_.request(".fi");
    page_.request(".RE");
    shown_ = false;
  }
  void end_paragraph() {
    if (paragraph_.empty()) return;
    begin_block();
    page_.words(paragraph_);
    paragraph_.clear();
  }

  void begin_section(std::string_view name) {
    page_.section(name);
    has_section_ = true;
    is_first_ = true;
  }
  /// A block after another one of its section.
  void begin_block() {
    if (!has_section_) begin_section("notes");
    if (!is_first_) page_.request(".PP");
    is_first_ = false;
  }

  static constexpr std::string_view indent = "  ";
  Writer& page_;
  std::string paragraph_{};
  bool shown_ = false, has_section_ = false, is_first_ = true;
};

std::string option_head(const cli::Option& option) {
  std::string head;
  for (const std::string& name : option.typed_names())
    head += (head.empty() ? "" : ", ") + bold(name);
  if (const std::string argument = argument_of(option); !argument.empty())
    head += " " + italic(argument);
  return head;
}

void write_option(Writer& page, const cli::Option& option) {
  page.request(".TP");
  page.request(option_head(option));
  std::string what = option.help();
  if (!what.empty() && what.back() != '.') what += '.';
  const std::string& variable = option.environment();
  if (option.is_required())
    what += variable.empty()
                ? " Required."
                : fmt::format(" Required, here or in the environment variable {}.", variable);
  if (!option.check().range.empty()) what += fmt::format(" Range: {}.", option.check().range);
  if (!option.default_text().empty()) what += fmt::format(" Default: {}.", option.default_text());
  if (!variable.empty() && !option.is_required())
    what += fmt::format(" Without it, the environment variable {} gives the value.", variable);
  page.words(what);
}

/// Options by their groups; those without a group are under `title`.
void write_options(Writer& page, const cli::Command& app, const std::string& title) {
  std::vector<std::string> groups;
  const auto options = options_of(app);
  for (const cli::Option* option : options)
    if (std::find(groups.begin(), groups.end(), option->group()) == groups.end())
      groups.push_back(option->group());
  for (const std::string& group : groups) {
    page.request(group == "Options" ? ".SH " + in_upper_case(title) : ".SS " + group);
    for (const cli::Option* option : options)
      if (option->group() == group) write_option(page, *option);
  }
}

void write_positionals(Writer& page, const cli::Command& app) {
  const auto positionals = positionals_of(app);
  if (positionals.empty()) return;
  page.section("arguments");
  for (const cli::Option* option : positionals) {
    page.request(".TP");
    page.request(italic(option->names()));
    page.words(option->help() + ".");
  }
}

/// "lamplock operate zero [OPTIONS]"
void write_synopsis(Writer& page, const cli::Command& app, const std::string& path) {
  std::string line = bold(path) + " [" + italic("OPTIONS") + "]";
  for (const cli::Option* option : positionals_of(app)) {
    const std::string name = italic(option->names());
    line += option->is_required() ? " " + name : " [" + name + "]";
  }
  if (!app.commands().empty())
    line += app.needs_command() ? " " + italic("COMMAND") : " [" + italic("COMMAND") + "]";
  page.request(line);
}

void write_head(Writer& page, const std::string& name, const Edition& edition,
                const std::string& what) {
  page.request(fmt::format(R"(.TH {} 1 "{}" "lamplock {}" "lamplock")",
                           in_upper_case(escaped(name)), edition.date, edition.version));
  page.section("name");
  page.request(escaped(name) + " \\- " + escaped(what));
}

/// Commands of a command are on its page, with their own options.
void write_inner_command(Writer& page, const cli::Command& app, const std::string& path) {
  page.section(path);
  page.words(app.description() + ".");
  page.request(".PP");
  write_synopsis(page, app, path);
  write_positionals(page, app);
  for (const cli::Option* option : options_of(app))
    if (option != &cli::help_option()) write_option(page, *option);
}

Page command_page(const cli::Command& app, const Edition& edition) {
  const std::string name = "lamplock-" + app.name(), path = "lamplock " + app.name();
  Writer page;
  write_head(page, name, edition, app.description());
  page.section("synopsis");
  write_synopsis(page, app, path);
  page.section("description");
  page.words(app.description() + ".");
  write_positionals(page, app);
  write_options(page, app, "options");
  for (const cli::Command& inner : app.commands())
    write_inner_command(page, inner, path + " " + inner.name());
  FooterWriter(page).write(app.footer());
  page.section("see also");
  page.request(bold("lamplock") + "(1)");
  return {name + ".1", page.take()};
}

/// Exit status of the program (host/error.hpp).
constexpr std::array<std::pair<const char*, const char*>, 8> exits{
    {{"0", "Done."},
     {"1",
      "The job failed, or was stopped by the machine or by a line of the computer, or an output "
      "was "
      "lost. Points may have been fired."},
     {"2",
      "Bad input or usage, an output that cannot be written, or a machine that takes no job: "
      "nothing "
      "was fired."},
     {"3", "No device, or no link to it: nothing was fired."},
     {"129", "Ended by SIGHUP: the terminal was closed."},
     {"130", "Interrupted by SIGINT (Ctrl-C), or not permitted by the user."},
     {"131", "Ended by SIGQUIT at once, without a report. Points may have been fired."},
     {"143", "Ended by SIGTERM."}}};

/// What signals do (host/cli/interrupt.hpp, host/run/job_control.hpp).
constexpr std::array<std::pair<const char*, const char*>, 5> signals{
    {{"SIGINT (130)",
      "Ctrl-C. A job of points or rows: in a terminal the first one holds the machine with the "
      "laser off, Enter resumes, the second one stops. Without terminal input - standard input is "
      "a file, a pipe, /dev/null, closed or at its end, or the program runs in the background - "
      "the "
      "first one stops. A program of G-code: holds, then resets. A simulation (lamplock sim) ends "
      "with status 0. In lamplock jog the key Ctrl-C quits with status 0."},
     {"SIGTERM (143)", "Stops at once, with any standard input."},
     {"SIGHUP (129)",
      "Stops at once, with any standard input; a program that was started by nohup ignores it."},
     {"SIGQUIT (131)",
      "Ctrl-backslash. Ends the program at once, without a report, with the terminal restored. A "
      "board whose host is silent for 2 s holds."},
     {"After a stop",
      "the machine is at rest with the laser off, and the program prints where to continue. If the "
      "machine does not report that it is at rest, the status is 1."}}};

/// What is installed; of an installation with another prefix than /usr, below that prefix.
constexpr std::array<std::pair<const char*, const char*>, 5> installed_files{
    {{"/usr/share/doc/lamplock/README.md", "What lamplock is, and the first job."},
     {"/usr/share/doc/lamplock/docs",
      "Guides and reference: install.md, wiring.md, safety.md, files.md, glass.md, gcode.md, "
      "settings.md, devices.md, pendants.md, lines.md, and others."},
     {"/usr/share/doc/lamplock/examples", "Machine profiles, job descriptions, programs."},
     {"/usr/share/lamplock", "The flash image of the RP2040 (ELF and UF2)."},
     {"/usr/lib/udev/rules.d/60-lamplock.rules, 60-lamplock-serial.rules",
      "Access to boards, boot loaders, pendants and serial chips."}}};

Page program_page(const cli::Command& program, const Edition& edition) {
  Writer page;
  write_head(page, program.name(), edition, "motion locked to the lamp of a laser");
  page.section("synopsis");
  write_synopsis(page, program, program.name());
  page.section("description");
  page.words(program.description());
  page.words("Each command has a page of its own.");
  page.section("commands");
  for (const cli::Command& app : program.commands()) {
    page.request(".TP");
    page.request(fmt::format("\\fBlamplock\\-{}\\fR(1)", escaped(app.name())));
    page.words(app.description() + ".");
  }
  write_options(page, program, "options");
  page.section("files");
  for (const auto& [file, what] : installed_files) {
    page.request(".TP");
    page.request(italic(file));
    page.words(what);
  }
  page.request(".PP");
  page.words("With another prefix than /usr, these files are below that prefix.");
  page.section("exit status");
  for (const auto& [status, what] : exits) {
    page.request(".TP");
    page.request(bold(status));
    page.words(what);
  }
  page.section("signals");
  for (const auto& [signal, what] : signals) {
    page.request(".TP");
    page.request(bold(signal));
    page.words(what);
  }
  FooterWriter(page).write(program.footer());
  return {"lamplock.1", page.take()};
}

}  // namespace

std::vector<Page> man_pages(const cli::Command& program, const Edition& edition) {
  std::vector<Page> pages{program_page(program, edition)};
  for (const cli::Command& app : program.commands()) pages.push_back(command_page(app, edition));
  return pages;
}

}  // namespace lamplock::manual
