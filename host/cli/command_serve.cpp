// `lamplock serve`: a machine as a page in the browser, and as JSON-RPC for programs.
#include <memory>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/serve/serve.hpp"

namespace lamplock::cli {
namespace {

Exit serve_board(const serve::ServeOptions& options) {
  Console console(false);
  serve::serve(options, console);
  return Exit::interrupted;  // Ctrl-C is the usual end of a server
}

}  // namespace

void add_serve(Command& program) {
  Command& app = program.add_command(
      "serve", "Operate a machine from a page in the browser, and from programs by JSON-RPC");
  app.footer(
      "Prints the address of the page with a token; programs of this computer that know the token\n"
      "can use the machine (docs/page.md, docs/api.md). No other computer can. On a real board a\n"
      "page may fire only after the code of --pair was entered in it; dry runs need no code. Stop\n"
      "works in every page. Ctrl-C stops the machine and ends the server.\n"
      "Example:\n"
      "  lamplock serve --board virtual\n"
      "  lamplock serve --board /dev/ttyACM0 --pair");
  const auto options = std::make_shared<serve::ServeOptions>();
  app.add_option("--port", &options->port, "TCP port at 127.0.0.1; 0: any free port")
      .check(number_in({0u, 65535u}))
      .value_name("PORT")
      .show_default()
      .common();
  app.add_option("--folder", &options->folder,
                 "Folder of the jobs that pages send; default: lamplock/jobs in XDG_DATA_HOME")
      .value_name("DIR")
      .file(FileUse::folder)
      .common();
  app.add_option("--pair", &options->pairs,
                 "Print a code; a page in which it is entered may fire on a real board")
      .common();
  add_board_choice(app, options->board);
  add_machine(app, options->machine);
  app.action([options] {
    options->board.profile = options->machine.machine;
    return serve_board(*options);
  });
}

}  // namespace lamplock::cli
