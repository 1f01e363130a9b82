#include "host/link/line_console.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/link/dialog.hpp"
#include "host/link/program_lines.hpp"
#include "host/suggestion.hpp"

namespace lamplock::link {
namespace {

using Time = std::chrono::microseconds;

struct Word {
  std::string_view name;
  std::uint8_t byte;
};
constexpr std::array words{Word{"?", realtime::status},
                           Word{"!", realtime::hold},
                           Word{"~", realtime::resume},
                           Word{":status", realtime::status},
                           Word{":hold", realtime::hold},
                           Word{":resume", realtime::resume},
                           Word{":reset", realtime::reset},
                           Word{":jogcancel", realtime::jog_cancel},
                           Word{":feed 100", realtime::feed_full},
                           Word{":feed +10", realtime::feed_plus_10},
                           Word{":feed -10", realtime::feed_minus_10},
                           Word{":feed +1", realtime::feed_plus_1},
                           Word{":feed -1", realtime::feed_minus_1},
                           Word{":rapid 100", realtime::rapid_full},
                           Word{":rapid 50", realtime::rapid_half},
                           Word{":rapid 25", realtime::rapid_quarter},
                           Word{":power 100", realtime::power_full},
                           Word{":power +10", realtime::power_plus_10},
                           Word{":power -10", realtime::power_minus_10}};

constexpr Time max_wait{20'000};
/// Interval of status requests during the wait for an answer; any reply shows that the board lives.
constexpr Time alive_interval{1'000'000};
constexpr Time silence_limit{5'000'000};
/// Interval of status requests until the machine is at rest.
constexpr Time rest_interval{100'000};
/// Time-out for a report or a banner; after it the queue continues.
constexpr Time sign_timeout{2'000'000};

/// Removes blanks at the ends and leaves one between words.
std::string squeezed(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\t' || c == '\r';
    if (!blank)
      result += c;
    else if (!result.empty() && result.back() != ' ')
      result += ' ';
  }
  if (!result.empty() && result.back() == ' ') result.pop_back();
  return result;
}

std::vector<std::string> realtime_names() {
  std::vector<std::string> names;
  names.reserve(words.size());
  for (const Word& known : words) names.emplace_back(known.name);
  return names;
}

/// Words at the end of a line that stop the machine.
constexpr std::array stop_words{std::string_view(":hold"), std::string_view(":reset"),
                                std::string_view(":jogcancel")};

/// In a comment a character is text, but not at the end of a bracket that was not closed: its user
/// may have typed `!` for a hold.
bool is_hold_at(std::string_view line, std::size_t at) {
  const char comment = open_comment(line.substr(0, at));
  return comment == 0 || (comment == '(' && at + 1 == line.size());
}

constexpr const char* realtime_remedy =
    "remove it; a real-time command is a line alone, 0x18 is the word :reset";

/// A word of letters alone, which no G-code begins with.
bool is_plain_word(std::string_view word) {
  constexpr std::size_t min_letters = 3;
  return word.size() >= min_letters && std::all_of(word.begin(), word.end(), [](char c) {
           return std::isalpha(static_cast<unsigned char>(c)) != 0;
         });
}

bool is_jog(std::string_view line) { return line.starts_with("$J") || line.starts_with("$j"); }

}  // namespace

std::optional<std::uint8_t> realtime_word(std::string_view typed) {
  const std::string word = squeezed(typed);
  for (const Word& known : words)
    if (known.name == word) return known.byte;
  if (word.starts_with(':'))
    throw Error(Exit::bad_input, word, "unknown word",
                did_you_mean(word, realtime_names(), "there are " + realtime_words()));
  return std::nullopt;
}

std::string realtime_words() {
  std::string text;
  for (const Word& word : words) text += (text.empty() ? "" : ", ") + std::string(word.name);
  return text;
}

void LineConsole::type(const std::string& line) {
  const auto byte = realtime_word(line);
  ++typed_;
  if (byte && !in_order_) return send_byte(*byte);
  if (!byte && !in_order_ && stop_by(line)) return;
  std::string_view text = line;
  if (text.ends_with('\r')) text.remove_suffix(1);
  const std::string where = fmt::format("line {}", typed_);
  if (!byte) refuse_word(line, where);
  queue_.push_back({typed_, byte ? std::string(text) : line_to_send(text, where, realtime_remedy)});
}

/// Beside a laser, a user who types `!` means a hold, whatever else the line has.
bool LineConsole::stop_by(std::string_view line) {
  const std::string text = squeezed(line);
  for (const std::string_view word : stop_words) {
    if (!text.ends_with(word)) continue;
    const std::string rest = squeezed(std::string_view(text).substr(0, text.size() - word.size()));
    if (open_comment(rest) == ';') continue;
    send_byte(*realtime_word(word), rest);
    return true;
  }
  for (auto at = text.find('!'); at != std::string::npos; at = text.find('!', at + 1)) {
    if (!is_hold_at(text, at)) continue;
    const std::string rest = text.substr(0, at) + text.substr(at + 1);
    send_byte(realtime::hold, squeezed(rest));
    return true;
  }
  return false;
}

/// "hold" and "hlep" are no G-code: the board would answer a number that explains nothing.
void LineConsole::refuse_word(const std::string& line, const std::string& where) const {
  const std::string text = squeezed(line);
  if (!is_plain_word(text.substr(0, text.find(' ')))) return;
  std::vector<std::string> names;
  if (!in_order_) names.emplace_back("help");
  for (const Word& known : words)
    if (known.name.starts_with(':')) names.emplace_back(known.name.substr(1));
  std::vector<std::string> similar = similar_names(text, names);
  if (similar.empty()) return;
  for (std::string& name : similar)
    if (name != "help") name.insert(0, ":");
  throw Error(Exit::bad_input, where, fmt::format("unknown word '{}'", text), question_of(similar));
}

bool LineConsole::done() const {
  return queue_.empty() && waiting_ == Waiting::nothing && port_.backlog() == 0;
}

void LineConsole::step() {
  while (const auto line = port_.receive()) {
    heard_at_ = port_.transport().now();
    take(*line);
  }
  expect_connected(port_);
  check_silence();
  if (waiting_ == Waiting::nothing && !held_ && !(in_order_ && failure_)) send_next();
  if (input_ended_ && done() && !at_rest_) ask_for_rest();
  port_.flush();
  port_.transport().wait(max_wait);
}

void LineConsole::take(const std::string& line) {
  if (const auto status = parse_status(line)) {
    if (reports_asked_ != 0) {
      --reports_asked_;
      if (waiting_ == Waiting::status) waiting_ = Waiting::nothing;
      show_(line);
    }
    if (status->waits()) send_word_after_pause();
    if (status->waits()) note_pause(*status);
    at_rest_ = rest_asked_at_ && done() && status->is_at_rest();
    if (at_rest_ && status->waits() && !status->is("Tool") && !hold_is_expected_)
      fail_held(*status);
    return;
  }
  if (const auto error = parse_answer(line)) {
    if (waiting_ == Waiting::answer) waiting_ = Waiting::nothing;
    if (*error == 0) return show_(line);
    return fail(error_text(*error));
  }
  if (const auto alarm = parse_alarm(line)) return fail(alarm_text(*alarm));
  // After a restart the board does not answer lines that were sent before.
  if (is_banner(line) && waiting_ == Waiting::banner) waiting_ = Waiting::nothing;
  show_(line);
}

void LineConsole::fail(const std::string& text, const char* remedy) {
  show_(text);
  if (!failure_) failure_ = ConsoleFailure{current_.number, text, remedy};
}

/// A fault, a door or a button: the script itself asked for no hold.
void LineConsole::fail_held(const BoardStatus& status) {
  fail(fmt::format("the machine is held ({}), so the last lines are not executed", status.state),
       "send ~ to resume, or :reset to discard the rest");
}

void LineConsole::send_next() {
  if (queue_.empty()) return;
  current_ = std::move(queue_.front());
  queue_.pop_front();
  sent_at_ = heard_at_ = asked_at_ = port_.transport().now();
  if (const auto byte = realtime_word(current_.text)) return send_byte(*byte);
  if (!current_.text.starts_with('$')) hold_is_expected_ = is_pause(current_.text);
  port_.send_line(current_.text);
  waiting_ = Waiting::answer;
}

/// The machine waits for a resume and has not answered the current line, a pause of the program.
/// The next word of the script may be that resume.
void LineConsole::send_word_after_pause() {
  if (!in_order_ || waiting_ != Waiting::answer || queue_.empty()) return;
  const auto byte = realtime_word(queue_.front().text);
  if (!byte) return;
  queue_.pop_front();
  send_byte(*byte);
}

/// In the last line of a script it ends the conversation; before others the user must know of it.
void LineConsole::note_pause(const BoardStatus& status) {
  if (!in_order_ || waiting_ != Waiting::answer) return;
  if (queue_.empty() && input_ended_) {
    waiting_ = Waiting::nothing;
    return;
  }
  if (queue_.empty() || realtime_word(queue_.front().text)) return;
  if (std::exchange(noted_line_, current_.number) == current_.number) return;
  show_(fmt::format("the machine waits in line {} ({}): resume it at the machine, or Ctrl-C ends",
                    current_.number, status.state));
}

void LineConsole::send_byte(std::uint8_t byte, const std::string& discarded) {
  port_.send_realtime(byte);
  sent_at_ = heard_at_ = port_.transport().now();
  if (byte == realtime::hold) hold_is_expected_ = true;
  if (byte == realtime::resume || byte == realtime::reset) hold_is_expected_ = false;
  if (byte == realtime::resume) noted_line_ = current_.number;  // a report may come from before it
  if (byte == realtime::status) {
    ++reports_asked_;
    if (in_order_ && waiting_ == Waiting::nothing) waiting_ = Waiting::status;
  } else if (byte == realtime::reset) {
    // A line without answer will not be answered any more.
    if (!in_order_) queue_.clear();
    held_ = false;
    port_.drop_lines();
    waiting_ = Waiting::banner;
  }
  if (!in_order_) hold_queue(byte);
  if (!in_order_) show_sent(byte, discarded);
}

/// A board at rest may ignore a hold, so that the lines after it would move the machine.
void LineConsole::hold_queue(std::uint8_t byte) {
  if (byte == realtime::resume) held_ = false;
  if (byte == realtime::jog_cancel)
    std::erase_if(queue_, [](const Typed& typed) { return is_jog(typed.text); });
  if (byte == realtime::hold && !queue_.empty()) held_ = true;
}

/// One line for what the board does not answer.
void LineConsole::show_sent(std::uint8_t byte, const std::string& discarded) {
  std::string text = discarded.empty() ? "" : fmt::format("; '{}' was not sent", discarded);
  if (byte == realtime::hold && held_)
    text += fmt::format("; typed lines that wait for ~ (:resume): {}; :reset discards them",
                        queue_.size());
  else if (byte == realtime::hold)
    text += "; ~ resumes";
  if (byte == realtime::hold) return show_("hold" + text);
  if (byte == realtime::resume) return show_("resume");
  if (!discarded.empty()) show_((byte == realtime::reset ? "reset" : "jog cancel") + text);
}

/// A board that does not answer is taken to be at rest.
void LineConsole::ask_for_rest() {
  const Time now = port_.transport().now();
  if (rest_asked_at_ && now - *rest_asked_at_ < rest_interval) return;
  if (rest_asked_at_ && now - heard_at_ > sign_timeout) {
    at_rest_ = true;
    return;
  }
  if (!rest_asked_at_) heard_at_ = now;
  rest_asked_at_ = now;
  port_.send_realtime(realtime::status);
}

void LineConsole::check_silence() {
  const Time now = port_.transport().now();
  if (waiting_ == Waiting::nothing) return;
  if (waiting_ != Waiting::answer) {
    if (now - sent_at_ < sign_timeout) return;
    waiting_ = Waiting::nothing;
    reports_asked_ = 0;
    return;
  }
  if (now - heard_at_ >= silence_limit)
    throw Error(Exit::no_device, "machine", fmt::format("does not answer '{}'", current_.text),
                "check power, cable and the name of the port");
  if (now - asked_at_ < alive_interval) return;
  asked_at_ = now;
  port_.send_realtime(realtime::status);
}

}  // namespace lamplock::link
