// `lamplock console`: a terminal to a board, for people and for scripts.
#include <memory>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/run/console_session.hpp"

namespace lamplock::cli {
namespace {

Exit talk(const run::BoardChoice& choice) {
  Console console(false);
  run::run_console(choice, console);
  return Exit::done;
}

}  // namespace

void add_console(Command& program) {
  Command& app = program.add_command(
      "console", "Talk to a board in a terminal: send lines and show the replies");
  app.footer(
      "In a terminal the keys ! (hold), ~ (resume), ? (status) and Ctrl-X (reset) act at once,\n"
      "without Enter, also while a line is typed, which is kept; in a comment they are text. "
      "Lines\n"
      "can be edited; the arrow keys up and down recall earlier ones; help lists keys and words.\n"
      "Real-time commands are ? ! ~ or the words :status :hold :resume :reset :jogcancel,\n"
      ":feed 100 (+10 -10 +1 -1), :rapid 100 (50 25), :power 100 (+10 -10). In a terminal, a word\n"
      "and Enter acts before lines that were typed earlier but are not sent yet; a line that ends\n"
      "in :hold, :reset or :jogcancel is not sent, only the word acts. After a hold the lines "
      "that\n"
      "are not sent wait for a resume; :reset discards them. Ctrl-D or Ctrl-C closes the console; "
      "a\n"
      "board that detects the closed port then holds an unfinished program. Comments are not "
      "sent.\n"
      "In a file or a pipe, a line with a real-time character in its middle is refused.\n"
      "Lines from a file or a pipe are sent one at a time, each after the answer to the previous\n"
      "line. The first error or alarm ends the input, and the command fails; before it ends, the\n"
      "console waits until the machine is at rest. The command also fails if the\n"
      "machine is held at the end and no line asked for that. A simulated board starts with the\n"
      "settings of --machine.\n"
      "Example:\n"
      "  lamplock console --board /dev/ttyACM0\n"
      "  echo '$$' | lamplock console --board virtual");
  const auto choice = std::make_shared<run::BoardChoice>();
  add_board_choice(app, choice->board);
  add_machine(app, choice->machine);
  app.action([choice] {
    choice->board.profile = choice->machine.machine;
    return talk(*choice);
  });
}

}  // namespace lamplock::cli
