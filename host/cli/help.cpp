#include "host/cli/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "host/cli/wrapped_text.hpp"

namespace lamplock::cli {
namespace {

/// Longer lines are hard to read.
constexpr std::size_t max_width = 100;
/// In narrower terminals the descriptions are below the names.
constexpr std::size_t min_width_of_columns = 60;
constexpr std::size_t min_width = 20;
constexpr std::size_t indent = 2, column = 26, narrow_column = 6;
/// -h lists all options of a command that has no more than these.
constexpr std::size_t max_common = 14;
constexpr std::string_view example = "Example:";

/// Words between blanks; what is in quotes is one word with its neighbours if `keep_quotes`.
std::vector<std::string> words_of(std::string_view text, bool keep_quotes) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  for (const char c : text) {
    if (keep_quotes && (c == '"' || c == '\'')) quote = quote == 0 ? c : quote == c ? 0 : quote;
    if (quote != 0 || (c != ' ' && c != '\n')) {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  if (!word.empty()) words.push_back(std::move(word));
  return words;
}

/// Bytes of the begin of a long word that fits into so many columns: up to one of the marks between
/// its parts, otherwise as much as fits.
std::size_t length_that_fits(std::string_view word, std::size_t columns) {
  std::size_t end = 0;
  for (std::size_t used = 0; end < word.size() && used < columns; ++used) {
    ++end;
    while (end < word.size() && (static_cast<unsigned char>(word[end]) & 0xC0u) == 0x80u) ++end;
  }
  const std::size_t mark = word.substr(0, end).find_last_of("|,/");
  return mark == std::string_view::npos ? end : mark + 1;
}

/// Writes text to a width.
class Page {
 public:
  explicit Page(std::size_t width) : width_(std::clamp(width, min_width, max_width)) {}

  void line(std::string_view text) { (text_ += text) += '\n'; }
  void heading(std::string_view text) {
    line("");
    line(text);
  }
  void paragraph(std::string_view text, std::size_t margin = 0) { wrap("", text, margin, "", 0); }

  /// A name and what it does, in two columns.
  void entry(const std::string& name, std::string_view text) {
    const std::string head = std::string(indent, ' ') + name;
    const bool has_columns = width_ >= min_width_of_columns;
    const std::size_t margin = has_columns ? column : narrow_column;
    if (has_columns && text_columns(head) + indent <= column)
      return wrap(head + std::string(column - text_columns(head), ' '), text, margin, "", 0);
    wrap("", name, indent, "", indent);
    if (!text.empty()) wrap("", text, margin, "", 0);
  }

  /// A command to type, which stays one command for the shell if it is wrapped. Its comment is
  /// above it if it does not fit.
  void command(std::string_view text) {
    const auto comment = text.find(" # ");
    if (text_columns(text) > width_ && comment != std::string_view::npos) {
      wrap("", text.substr(comment + 1), indent, "", indent);
      text = text.substr(0, text.find_last_not_of(' ', comment) + 1);
    }
    if (text_columns(text) <= width_) return line(text);
    wrap("", text, indent, " \\", 2 * indent);
  }

  std::string take() { return std::move(text_); }

 private:
  /// Words from a margin on, after the text that begins the first line. Lines that continue have
  /// `tail` at their end and are indented by `further`.
  void wrap(std::string start, std::string_view text, std::size_t margin, std::string_view tail,
            std::size_t further) {
    std::string row = start.empty() ? std::string(margin, ' ') : std::move(start);
    const bool is_command = !tail.empty();
    bool is_begun = false;
    for (std::string word : words_of(text, is_command)) {
      if (is_begun && text_columns(row) + 1 + text_columns(word) + tail.size() > width_) {
        line(row + std::string(tail));
        row = std::string(margin + further, ' ');
        is_begun = false;
      }
      // A list of names, such as a|b|c, may be longer than a line. A command stays as it is.
      while (!is_command && !is_begun && text_columns(row) + text_columns(word) > width_) {
        const std::size_t size = length_that_fits(word, width_ - text_columns(row));
        line(row + word.substr(0, size));
        word.erase(0, size);
        row = std::string(margin + further, ' ');
      }
      row += (is_begun ? " " : "") + word;
      is_begun = true;
    }
    if (is_begun) line(row);
  }

  std::size_t width_;
  std::string text_;
};

std::string name_of(const Option& option) {
  std::string name = fmt::format("{}", fmt::join(option.typed_names(), ", "));
  if (option.is_positional()) name = option.names();
  if (option.is_flag() || option.is_positional()) return name;
  if (!option.bare().empty()) return name + "[=" + option.value_name() + "]";
  return option.value_name().empty() ? name : name + " " + option.value_name();
}

/// The description, with what the option is restricted to: "(1 to 140; default: 100)".
std::string about(const Option& option) {
  std::vector<std::string> rules;
  if (option.is_required()) rules.emplace_back("required");
  if (!option.check().range.empty()) rules.push_back(option.check().range);
  if (!option.default_text().empty()) rules.push_back("default: " + option.default_text());
  if (!option.environment().empty()) rules.push_back("environment: " + option.environment());
  if (rules.empty()) return option.help();
  return fmt::format("{} ({})", option.help(), fmt::join(rules, "; "));
}

std::string usage_of(const Command& command, const std::string& path) {
  std::string usage = "Usage: " + path + " [OPTIONS]";
  for (const Option& option : command.options()) {
    if (!option.is_positional()) continue;
    const bool is_list = std::holds_alternative<std::vector<std::string>*>(option.target());
    const std::string name = option.names() + (is_list ? "..." : "");
    usage += option.is_required() ? " " + name : " [" + name + "]";
  }
  if (!command.commands().empty()) usage += command.needs_command() ? " COMMAND" : " [COMMAND]";
  return usage;
}

/// The options without positionals and hidden ones, -h first.
std::vector<const Option*> options_of(const Command& command) {
  std::vector<const Option*> options{&help_option()};
  if (!command.version().empty()) options.push_back(&version_option());
  for (const Option& option : command.options())
    if (!option.is_positional() && !option.group().empty()) options.push_back(&option);
  return options;
}

void write_positionals(Page& page, const Command& command) {
  bool is_first = true;
  for (const Option& option : command.options()) {
    if (!option.is_positional()) continue;
    if (is_first) page.heading("Arguments:");
    is_first = false;
    page.entry(name_of(option), about(option));
  }
}

void write_all_options(Page& page, const std::vector<const Option*>& options) {
  std::vector<std::string> groups;
  for (const Option* option : options)
    if (std::find(groups.begin(), groups.end(), option->group()) == groups.end())
      groups.push_back(option->group());
  for (const std::string& group : groups) {
    page.heading(group + ":");
    for (const Option* option : options)
      if (option->group() == group) page.entry(name_of(*option), about(*option));
  }
}

void write_common_options(Page& page, const std::vector<const Option*>& options,
                          const std::string& path) {
  page.heading("Common options:");
  std::size_t others = 0;
  for (const Option* option : options)
    if (option->is_common() || option->is_required())
      page.entry(name_of(*option), about(*option));
    else
      ++others;
  page.line("");
  page.paragraph(fmt::format("{} --help lists the other {} options too.", path, others));
}

/// Paragraphs are wrapped; lines that begin with blanks are commands.
void write_footer(Page& page, std::string_view footer, bool examples_only) {
  std::string paragraph;
  bool in_examples = false;
  const auto end_paragraph = [&] {
    if (paragraph.empty()) return;
    page.line("");
    page.paragraph(paragraph);
    paragraph.clear();
  };
  while (!footer.empty()) {
    const std::size_t end = std::min(footer.find('\n'), footer.size());
    const std::string_view line = footer.substr(0, end);
    footer.remove_prefix(std::min(end + 1, footer.size()));
    const bool is_command = line.starts_with("  ");
    if (line.empty() || line == example || is_command) end_paragraph();
    if (line == example)
      page.heading(example);
    else if (is_command && (in_examples || !examples_only))
      page.command(line);
    else if (!is_command && !line.empty() && !examples_only)
      paragraph.append(paragraph.empty() ? "" : " ").append(line);
    in_examples = line == example || (in_examples && is_command);
  }
  end_paragraph();
}

}  // namespace

std::string help_text(const Command& command, const std::string& path, HelpKind kind,
                      std::size_t width) {
  Page page(width);
  page.paragraph(command.description());
  page.line("");
  page.paragraph(usage_of(command, path));
  write_positionals(page, command);
  if (!command.commands().empty()) {
    page.heading("Commands:");
    for (const Command& inner : command.commands()) page.entry(inner.name(), inner.description());
    page.line("");
    page.paragraph(
        fmt::format("{} COMMAND -h shows the common options of a command, --help all.", path));
  }
  const std::vector<const Option*> options = options_of(command);
  const bool shortened = kind == HelpKind::common && options.size() > max_common &&
                         std::any_of(options.begin() + 1, options.end(),
                                     [](const Option* option) { return option->is_common(); });
  if (shortened)
    write_common_options(page, options, path);
  else
    write_all_options(page, options);
  write_footer(page, command.footer(), shortened);
  return page.take();
}

}  // namespace lamplock::cli
