// `lamplock console`: a terminal to a board, for people and for scripts.
#include <memory>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/guarded_board.hpp"
#include "host/cli/keyboard.hpp"
#include "host/link/line_console.hpp"

namespace lamplock::cli {
namespace {

/// A simulated board runs while we wait: about as fast as a real one when somebody sits there.
constexpr std::chrono::milliseconds pace{20};

/// The console stops reading its input while so many lines wait for the board: this limits memory.
/// It is far above what a user pastes, because words behind the limit cannot act at once.
constexpr std::size_t max_queued_lines = 100'000;

/// Typed lines by hand: a wrong word is told, and that is all.
void take_typed(link::LineConsole& talk, Console& console, const std::string& line) {
  try {
    talk.type(line);
  } catch (const Error& error) {
    console.line(error.what());
  }
}

Exit by_hand(GuardedBoard& board, Console& console) {
  link::LineConsole talk(board.link.port(), false,
                         [&console](const std::string& text) { console.line(text); });
  Keyboard keyboard;
  const auto wait = board.link.simulated() != nullptr ? pace : std::chrono::milliseconds(0);
  while (!keyboard.ended()) {
    if (talk.queued() < max_queued_lines)
      for (const std::string& line : keyboard.lines(wait)) take_typed(talk, console, line);
    talk.step();
    board.guarding.look(board.link.port());
  }
  if (talk.queued() != 0) console.say("typed lines that were not sent: {}", talk.queued());
  return Exit::done;
}

/// The first error or alarm ends it: what follows may count on the line that failed.
Exit in_order(GuardedBoard& board, Console& console) {
  link::LineConsole talk(board.link.port(), true,
                         [&console](const std::string& text) { console.line(text); });
  Keyboard keyboard;
  while (!talk.failure() && !(keyboard.ended() && talk.done() && talk.at_rest())) {
    if (!keyboard.ended() && talk.queued() < max_queued_lines)
      for (const std::string& line : keyboard.lines(std::chrono::milliseconds(0))) talk.type(line);
    if (keyboard.ended()) talk.end_input();
    talk.step();
    board.guarding.look(board.link.port());
  }
  if (!talk.failure()) return Exit::done;
  throw Error(Exit::job_failed, fmt::format("line {}", talk.failure()->line), talk.failure()->text,
              "nothing behind it was sent");
}

Exit talk(const BoardChoice& choice) {
  Console console(false);
  GuardedBoard board(choice);
  return Keyboard::at_terminal() ? by_hand(board, console) : in_order(board, console);
}

}  // namespace

void add_console(Command& program) {
  Command& app = program.add_command(
      "console", "A terminal to a board: lines go to it, what it says is shown");
  app.footer(
      "Words for bytes that act at once: ? ! ~ or :status :hold :resume :reset :jogcancel,\n"
      ":feed 100 (+10 -10 +1 -1), :rapid 100 (50 25), :power 100 (+10 -10). In a terminal each\n"
      "word, with Enter, acts before the lines that were typed earlier and are not sent yet: "
      "after\n"
      "a hold these lines wait for a resume, and :reset discards them. Ctrl-D or Ctrl-C leaves;\n"
      "a board that sees its port closed then holds a program that is not finished. Comments are\n"
      "not sent, and a line with such a byte in its middle is refused. Lines that come from a "
      "file\n"
      "or a pipe are sent one after the other, each when the one before has been answered, until\n"
      "the first error or alarm, which is an error of the command; then the console waits until\n"
      "the machine is at rest. A simulated board starts with the settings of --machine.\n"
      "Example:\n  lamplock console --board /dev/ttyACM0\n"
      "  echo '$$' | lamplock console --board virtual");
  const auto choice = std::make_shared<BoardChoice>();
  choice->add(app);
  app.action([choice] {
    choice->board.profile = choice->machine.machine;
    return talk(*choice);
  });
}

}  // namespace lamplock::cli
