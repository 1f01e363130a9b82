#include "host/link/program_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "host/error.hpp"
#include "host/gcode_comments.hpp"
#include "host/letter_case.hpp"
#include "host/text.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::link {
namespace {

constexpr char del = 0x7F;

/// The number after a letter, with optional white space between them.
std::optional<double> number_at(std::string_view text) {
  text = trimmed(text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  return value;
}

/// Calls `use` with the number of each word of this letter.
template <class Use>
void each_word(std::string_view line, char letter, Use use) {
  const char small = lower_case(letter);
  line = line.substr(0, line.find('('));  // messages
  for (std::size_t i = 0; i < line.size(); ++i)
    if (line[i] == letter || line[i] == small)
      if (const auto number = number_at(line.substr(i + 1))) use(*number);
}

/// The texts of the comments in brackets that are closed; a `$` line has none.
std::vector<std::string_view> comments_of(std::string_view line) {
  std::vector<std::string_view> comments;
  if (trimmed(line).starts_with('$')) return comments;
  while (true) {
    const auto start = line.find_first_of("(;");
    if (start == std::string_view::npos || line[start] == ';') return comments;
    const auto end = line.find(')', start);
    if (end == std::string_view::npos) return comments;
    comments.push_back(line.substr(start + 1, end - start - 1));
    line.remove_prefix(end + 1);
  }
}

/// A message for the user, which a board reports.
bool is_message(std::string_view comment) {
  comment = trimmed(comment);
  const std::string kind = in_lower_case(comment.substr(0, comment.find(',')));
  return kind.size() < comment.size() && (kind == "msg" || kind == "debug" || kind == "print");
}

/// The messages of a line, in brackets, each as far as a board's line has room for it; without
/// bytes that it would execute as real-time commands.
std::string messages_of(std::string_view line) {
  std::string messages;
  for (const std::string_view comment : comments_of(line)) {
    if (!is_message(comment)) continue;
    const std::size_t begin = messages.size();
    messages += '(';
    for (const char c : comment)
      if (realtime_fault({&c, 1}).empty()) messages += c;
    messages.resize(std::min(messages.size(), begin + wire::max_line - 2));
    messages += ')';
  }
  return messages;
}

/// A comment that opens or closes a probe log, as LinuxCNC has them.
bool is_log_comment(std::string_view comment) {
  constexpr std::string_view blanks = " \t";
  const std::string word = in_lower_case(comment.substr(0, comment.find_first_of(blanks)));
  return word == "probeopen" || (word == "probeclose" && word.size() == comment.size());
}

/// Throws Error for a name that could lead out of the folder of the logs.
void check_log(std::string_view comment, const std::string& where) {
  const std::string name = probe_log_name(comment);
  constexpr std::string_view opens = "probeopen";
  if (name.empty() && comment.size() > opens.size()) return;  // probeclose
  const bool is_path = name.find_first_of("/\\") != std::string::npos;
  const bool is_printed = std::ranges::all_of(
      name, [](char c) { return static_cast<unsigned char>(c) >= ' ' && c != del; });
  if (!name.empty() && name != "." && name.find("..") == std::string::npos && !is_path &&
      is_printed)
    return;
  throw Error(Exit::bad_input, where,
              fmt::format("'({})': a probe log needs the plain name of a file, without / \\ and ..",
                          comment),
              "write (probeopen NAME); the folder is that of lamplock send --probe-logs");
}

/// The comments of a line about probe logs.
std::vector<std::string> logs_of(std::string_view line, const std::string& where) {
  std::vector<std::string> logs;
  for (const std::string_view each : comments_of(line)) {
    const std::string_view comment = trimmed(each);
    if (!is_log_comment(comment)) continue;
    check_log(comment, where);
    logs.emplace_back(comment);
  }
  return logs;
}

/// A board reports no message of a line of assignments alone.
bool is_assignment(const std::string& line) { return line.starts_with('#'); }

/// A loop executes the line of its begin again; the messages before that line are shown once.
bool may_be_o_word(const std::string& line) {
  return line.starts_with('o') || line.starts_with('O');
}

/// Characters of the longest N word, with room to spare.
constexpr std::size_t number_room = 10;

/// Puts lines of messages alone before the next line: into it, or as lines of their own if they
/// show values, which that line could change, or if it has no room for them.
void put_comments(std::vector<ProgramLine>& comments, ProgramLine& next,
                  std::vector<ProgramLine>& lines) {
  std::string joined;
  for (const ProgramLine& comment : comments) joined += comment.messages;
  const std::size_t size = next.text.size() + joined.size() + next.messages.size() + number_room;
  const bool is_joined = joined.find('#') == std::string::npos && !is_assignment(next.text) &&
                         !may_be_o_word(next.text) && size < wire::max_line;
  if (is_joined)
    next.messages.insert(0, joined);
  else
    lines.insert(lines.end(), comments.begin(), comments.end());
  comments.clear();
}

/// The messages of a line in parts, each of which fits into a line of its own.
std::vector<std::string> message_parts(std::string_view messages) {
  std::vector<std::string> parts;
  while (!messages.empty()) {
    const auto end = messages.find(')');
    const std::string_view message =
        messages.substr(0, end == std::string_view::npos ? end : end + 1);
    messages.remove_prefix(message.size());
    if (parts.empty() || parts.back().size() + message.size() >= wire::max_line)
      parts.emplace_back();
    parts.back() += message;
  }
  return parts;
}

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// A line without its own N word, outside of expressions and names, unless nothing else is in it.
std::string without_number(std::string_view line) {
  std::size_t depth = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '[' || line[i] == '<') ++depth;
    if ((line[i] == ']' || line[i] == '>') && depth > 0) --depth;
    if (depth > 0 || (line[i] != 'N' && line[i] != 'n')) continue;
    if (i > 0 && is_letter(line[i - 1])) continue;  // of a function, SIN
    const auto digits = line.find_first_not_of(" \t", i + 1);
    const auto end = line.find_first_not_of("0123456789", digits);
    if (digits == std::string_view::npos || end == digits) continue;
    std::string rest(line.substr(0, i));
    if (end != std::string_view::npos) rest += line.substr(end);
    rest = trimmed(rest);
    return rest.empty() ? std::string(line) : rest;
  }
  return std::string(line);
}

}  // namespace

std::vector<ProgramLine> with_numbers(std::vector<ProgramLine> lines) {
  constexpr std::string_view first_letters = "GMXYZABCFSTIJKPQRgmxyzabcfstijkpqr";
  for (ProgramLine& line : lines) {
    std::string words = without_number(line.text);
    if (!words.empty() && first_letters.find(words.front()) != std::string_view::npos) {
      std::string numbered = fmt::format("N{}{}", line.number, words);
      line.text = numbered.size() < wire::max_line ? std::move(numbered) : std::move(words);
    }
    if (!line.text.starts_with('$') && line.text.size() + line.messages.size() < wire::max_line)
      line.text += line.messages;
  }
  return lines;
}

std::vector<ProgramLine> separate_messages(
    std::vector<ProgramLine> lines, const std::function<bool(const std::string&)>& holds_none) {
  std::vector<ProgramLine> result;
  result.reserve(lines.size());
  for (ProgramLine& line : lines) {
    const std::size_t size = line.text.size() + line.messages.size() + number_room;
    const bool fits = line.text.empty() ? line.messages.size() < wire::max_line
                                        : size < wire::max_line && !line.text.starts_with('$') &&
                                              !(holds_none && holds_none(line.text));
    if (!line.messages.empty() && !fits)
      for (std::string& part : message_parts(std::exchange(line.messages, {})))
        result.push_back({line.number, {}, std::move(part), line.origin});
    // A line of messages alone is in these parts.
    if (fits || !line.text.empty() || !line.logs.empty()) result.push_back(std::move(line));
  }
  return result;
}

std::string probe_log_name(std::string_view comment) {
  constexpr std::string_view opens = "probeopen";
  const bool is_open = comment.size() >= opens.size() && (comment[5] == 'o' || comment[5] == 'O');
  return is_open ? std::string(trimmed(comment.substr(opens.size()))) : std::string{};
}

std::string realtime_fault(std::string_view text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == del || (byte < ' ' && byte != '\t' && !wire::is_realtime(byte)))
      return fmt::format("the byte 0x{:02X} outside of a comment is not a character of a program",
                         byte);
    if (wire::is_realtime(byte) || byte >= 0x80)
      return fmt::format("the byte 0x{:02X} outside of a comment is a real-time command", byte);
  }
  return {};
}

std::string text_to_send(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('$')) return std::string(line);
  const std::string text = without_comments(line);
  return std::string(trimmed(text));
}

std::string line_to_send(std::string_view line, const std::string& where,
                         const std::string& remedy) {
  std::string text = text_to_send(line);
  const std::string fault = realtime_fault(text);
  if (!fault.empty()) throw Error(Exit::bad_input, where, fault, remedy);
  return text;
}

std::size_t column_in_line(std::string_view line, std::size_t column) {
  const bool is_for_board = trimmed(line).starts_with('$');
  char comment_end = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (comment_end != 0) {
      if (c == comment_end) comment_end = 0;
    } else if (!is_for_board && (c == '(' || c == ';')) {
      comment_end = c == '(' ? ')' : '\n';
    } else if (kept > 0 || (c != ' ' && c != '\t')) {
      if (++kept == column) return i + 1;
    }
  }
  return 0;
}

char open_comment(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('$')) return 0;
  while (true) {
    const auto start = line.find_first_of("(;");
    if (start == std::string_view::npos) return 0;
    const auto end = line.find(')', start);
    if (line[start] == ';' || end == std::string_view::npos) return line[start];
    line.remove_prefix(end + 1);
  }
}

std::vector<ProgramLine> program_lines(std::string_view text, const std::string& file) {
  text = without_byte_order_mark(text);
  std::vector<ProgramLine> lines, comments;
  std::vector<std::string> logs;  // of lines so far, for the next one that is not blank
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view source = take_line(text);
    const std::string where = fmt::format("{}:{}", file, number);
    std::string line = line_to_send(source, where);
    for (std::string& log : logs_of(source, where)) logs.push_back(std::move(log));
    std::string messages = messages_of(source);
    if (line.find_first_not_of("% \t") == std::string::npos) {
      if (!messages.empty()) comments.push_back({number, {}, std::move(messages)});
      continue;
    }
    ProgramLine next{number, std::move(line), std::move(messages), {}, std::exchange(logs, {})};
    if (next.text != source) next.source = source;
    if (!next.text.starts_with('$')) put_comments(comments, next, lines);
    if (is_assignment(next.text) && !next.messages.empty())
      comments.push_back({number, {}, std::exchange(next.messages, {})});
    lines.push_back(std::move(next));
  }
  if (!lines.empty()) lines.insert(lines.end(), comments.begin(), comments.end());
  return lines;
}

namespace {

/// A word of this letter has an expression: the number is not known here.
bool has_expression(std::string_view line, char letter) {
  const char small = lower_case(letter);
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] != letter && line[i] != small) continue;
    const std::string_view value = trimmed(line.substr(i + 1));
    if (value.starts_with('#') || value.starts_with('[')) return true;
  }
  return false;
}

}  // namespace

bool is_pause(std::string_view line) {
  constexpr double optional_pause = 1, pallet_pause = 60;
  bool pause = has_expression(line, 'M');
  each_word(line, 'M', [&](double number) {
    pause = pause || number == 0 || number == optional_pause || number == pallet_pause;
  });
  return pause;
}

bool may_lock_to_beat(std::string_view line) {
  constexpr double beat_lock = 130;
  bool locks = has_expression(line, 'M');
  each_word(line, 'M', [&](double number) { locks = locks || number == beat_lock; });
  return locks;
}

bool runs_at_rest(std::string_view line) {
  constexpr double dwell = 4, first_probe = 38.2, last_probe = 38.5;
  constexpr std::array waiting_codes{0.0, 1.0, 2.0, 6.0, 30.0, 60.0, 66.0};
  bool at_rest = line.starts_with("$H") || line.starts_with("$h");
  each_word(line, 'G', [&](double number) {
    at_rest = at_rest || number == dwell || (number >= first_probe && number <= last_probe);
  });
  each_word(line, 'M', [&](double number) {
    at_rest = at_rest || std::ranges::find(waiting_codes, number) != waiting_codes.end();
  });
  return at_rest;
}

double max_dwell_s(std::string_view line) {
  constexpr double hour_s = 3600;
  double sum = has_expression(line, 'P') ? hour_s : 0;
  each_word(line, 'P', [&](double number) { sum += std::max(0.0, number); });
  return sum;
}

}  // namespace lamplock::link
