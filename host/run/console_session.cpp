#include "host/run/console_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "host/error.hpp"
#include "host/letter_case.hpp"
#include "host/link/line_console.hpp"
#include "host/link/program_lines.hpp"
#include "host/text.hpp"

namespace lamplock::run {
namespace {

/// A simulated board runs while the host waits: about as fast as a real one between typed lines.
constexpr std::chrono::milliseconds pace{20};

/// The session stops reading its input while so many lines wait for the board: this limits memory.
/// It is far above what a user pastes, because words after the limit cannot act at once.
constexpr std::size_t max_queued_lines = 100'000;

constexpr const char* keys_text =
    "keys: ! hold, ~ resume, Ctrl-X reset, ? status; Ctrl-D leaves; help lists all";

/// Words in lines of a terminal.
std::string in_lines(const std::string& words) {
  constexpr std::size_t max_length = 76;
  const std::string separator = ", ";
  std::string text, line;
  for (std::size_t begin = 0; begin < words.size();) {
    const std::size_t end = std::min(words.find(separator, begin), words.size());
    const std::string word = words.substr(begin, end - begin) + (end < words.size() ? "," : "");
    if (line.size() + word.size() > max_length) text += std::exchange(line, "") + "\n";
    line += (line.empty() ? "  " : " ") + word;
    begin = end + separator.size();
  }
  return text + line;
}

std::string help_text() {
  return fmt::format(
      "Lines are sent to the board one after the other: G-code, or\n"
      "  $$ settings   $I version   $G modes   $# offsets   $N startup lines\n"
      "  $H home       $X unlock    $J=... jog $C check mode\n"
      "These keys act at once, without Enter, and keep the line that is typed:\n"
      "  ! hold   ~ resume   ? status   Ctrl-X reset\n"
      "These words and Enter act before the lines that wait. A stop also acts at the\n"
      "end of a line, which is then not sent:\n"
      "{}\n"
      "Keys: left, right, Home, End, Delete edit the line; up and down recall earlier\n"
      "  lines; Ctrl-R recalls the last line with the typed text; Ctrl-U clears the\n"
      "  line; Ctrl-D or Ctrl-C leaves.\n",
      in_lines(link::realtime_words()));
}

/// Line by line, so that the frontend can wrap them.
void show_help(Frontend& frontend) {
  const std::string all = help_text();
  for (std::string_view rest = all; !rest.empty();) frontend.line(std::string(take_line(rest)));
}

/// The word without blanks and a colon, in small letters: users type help in many ways.
std::string plain_word(std::string_view line) {
  std::string word(trimmed(line));
  if (word.starts_with(':')) word.erase(0, 1);
  return in_lower_case(word);
}

void take_typed(link::LineConsole& talk, Frontend& frontend, const std::string& line) {
  const std::string word = plain_word(line);
  if (word == "help") return show_help(frontend);
  if (word == "quit" || word == "exit") return frontend.line("Ctrl-D leaves the console");
  try {
    talk.type(line);
  } catch (const Error& error) {
    frontend.line(error.what());
  }
}

void run_typed(SupervisedBoard& board, LineInput& input, Frontend& frontend) {
  link::LineConsole talk(board.link.port(), false,
                         [&frontend](const std::string& text) { frontend.line(text); });
  frontend.notice(keys_text);
  const auto wait = board.link.simulated() != nullptr ? pace : std::chrono::milliseconds(0);
  while (!input.ended()) {
    if (talk.queued() < max_queued_lines)
      for (const std::string& line : input.lines(wait)) take_typed(talk, frontend, line);
    talk.step();
    board.supervisor.poll(board.link.port());
  }
  if (talk.queued() != 0) frontend.say("typed lines that were not sent: {}", talk.queued());
}

/// The first error or alarm ends it: later lines may depend on the line that failed.
void run_script(SupervisedBoard& board, LineInput& input, Frontend& frontend) {
  link::LineConsole talk(board.link.port(), true,
                         [&frontend](const std::string& text) { frontend.line(text); });
  while (!talk.failure() && !(input.ended() && talk.done() && talk.at_rest())) {
    if (!input.ended() && talk.queued() < max_queued_lines)
      for (const std::string& line : input.lines(std::chrono::milliseconds(0))) talk.type(line);
    if (input.ended()) talk.end_input();
    talk.step();
    board.supervisor.poll(board.link.port());
  }
  if (!talk.failure()) return;
  throw Error(Exit::job_failed, fmt::format("line {}", talk.failure()->line), talk.failure()->text,
              talk.failure()->remedy);
}

}  // namespace

bool is_in_comment(std::string_view begin) { return link::open_comment(begin) != 0; }

void run_console(const BoardChoice& choice, Frontend& frontend) {
  SupervisedBoard board(choice);
  const std::unique_ptr<LineInput> input = frontend.dialogue_input();
  if (input->is_typed())
    run_typed(board, *input, frontend);
  else
    run_script(board, *input, frontend);
}

}  // namespace lamplock::run
