#include "host/run/console_session.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>

#include "host/error.hpp"
#include "host/link/line_console.hpp"

namespace lamplock::run {
namespace {

/// A simulated board runs while the host waits: about as fast as a real one between typed lines.
constexpr std::chrono::milliseconds pace{20};

/// The session stops reading its input while so many lines wait for the board: this limits memory.
/// It is far above what a user pastes, because words after the limit cannot act at once.
constexpr std::size_t max_queued_lines = 100'000;

void take_typed(link::LineConsole& talk, Frontend& frontend, const std::string& line) {
  try {
    talk.type(line);
  } catch (const Error& error) {
    frontend.line(error.what());
  }
}

void run_typed(SupervisedBoard& board, LineInput& input, Frontend& frontend) {
  link::LineConsole talk(board.link.port(), false,
                         [&frontend](const std::string& text) { frontend.line(text); });
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
              "later lines were not sent");
}

}  // namespace

void run_console(const BoardChoice& choice, Frontend& frontend) {
  SupervisedBoard board(choice);
  const std::unique_ptr<LineInput> input = frontend.dialogue_input();
  if (input->is_typed())
    run_typed(board, *input, frontend);
  else
    run_script(board, *input, frontend);
}

}  // namespace lamplock::run
