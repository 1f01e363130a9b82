// `lamplock serve`: a machine as a page in the browser, and as JSON-RPC for programs.
#include <fmt/format.h>
#include <unistd.h>

#include <iostream>
#include <memory>
#include <string>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/program.hpp"
#include "host/cli/quiet_terminal.hpp"
#include "host/cli/validators.hpp"
#include "host/serve/page_texts.hpp"
#include "host/serve/serve.hpp"
#include "host/serve_tool/commands.hpp"

namespace lamplock::serve_tool {
namespace {

using cli::Command;
using cli::Console;
using cli::FileUse;
using cli::number_in;
using cli::QuietTerminal;

/// The first line of stdin, which a terminal does not show.
std::string typed_password() {
  const QuietTerminal quiet(QuietTerminal::Reads::lines);
  if (QuietTerminal::in_foreground(STDIN_FILENO)) fmt::print(stderr, "Password: ");
  std::string line;
  std::getline(std::cin, line);
  if (QuietTerminal::in_foreground(STDIN_FILENO)) fmt::print(stderr, "\n");
  return line;
}

Exit set_password(const std::string& file) {
  serve::write_password(file, typed_password());
  fmt::print("{}: the hash of the password\n", file);
  return Exit::done;
}

Exit write_texts(const std::string& file) {
  serve::write_texts(file);
  fmt::print("{}: the English texts of the page\n", file);
  return Exit::done;
}

Exit serve_board(const serve::ServeOptions& options) {
  Console console(false);
  serve::serve(options, console);
  return Exit::interrupted;  // Ctrl-C is the usual end of a server
}

/// How clients reach the server.
void add_access(Command& app, serve::ServeOptions& options, std::string& password_file) {
  app.add_option("--port", &options.port, "TCP port; 0: any free port")
      .check(number_in({0u, 65535u}))
      .value_name("PORT")
      .show_default()
      .common();
  app.add_option("--folder", &options.folder,
                 "Folder of the jobs that pages send; default: lamplock/jobs in XDG_DATA_HOME")
      .value_name("DIR")
      .file(FileUse::folder)
      .common();
  app.add_option("--listen", &options.address,
                 "Address of this computer to listen at; others than 127.0.0.1 need --password")
      .value_name("ADDRESS")
      .show_default()
      .common();
  app.add_option("--password", &options.password,
                 "File with the hash of the password, made by --set-password")
      .value_name("FILE")
      .file(FileUse::read)
      .common();
  app.add_option("--proxy", &options.proxy,
                 "Origin of a reverse proxy with TLS on this computer; needs --password")
      .value_name("https://NAME");
  app.add_option("--set-password", &password_file,
                 "Read a password, write its hash to this file, and end")
      .value_name("FILE")
      .file(FileUse::write);
}

/// What the server offers besides the machine.
void add_contents(Command& app, serve::ServeOptions& options, std::string& texts_file) {
  app.add_option("--octoprint", &options.octoprint,
                 "Answer slicers as OctoPrint does; FILE has their API key and is made if it does "
                 "not exist")
      .value_name("FILE")
      .file(FileUse::write);
  app.add_option("--camera", &options.camera,
                 "Show a camera in the top view: http://HOST/PATH of a JPEG picture or an MJPEG "
                 "stream, or a JPEG file that another program writes")
      .value_name("SOURCE");
  app.add_option("--library", &options.library,
                 "Material library with the history of jobs; default: that of lamplock material")
      .value_name("FILE")
      .file(FileUse::write);
  app.add_option("--texts", &options.texts,
                 "Translation of the texts of the page; those that it does not have are English")
      .value_name("FILE")
      .file(FileUse::read);
  app.add_option("--write-texts", &texts_file,
                 "Write the English texts of the page to this file, to be translated, and end")
      .value_name("FILE")
      .file(FileUse::write);
}

}  // namespace

void add_serve(Command& program) {
  Command& app = cli::add_serve_command(program);
  app.footer(
      "Prints the address of the page with a token; programs of this computer that know the token\n"
      "can use the machine (docs/page.md, docs/api.md). Other computers need --listen or --proxy "
      "and\n"
      "a password, which the network carries unencrypted unless a proxy adds TLS. On a real board "
      "a\n"
      "page may fire only after the code of --pair was entered in it; dry runs need no code. Stop\n"
      "works in every page. Ctrl-C stops the machine and ends the server.\n"
      "Example:\n"
      "  lamplock serve --board virtual\n"
      "  lamplock serve --board /dev/ttyACM0 --pair\n"
      "  lamplock serve --set-password pw\n"
      "  lamplock serve --board /dev/ttyACM0 --listen 192.168.1.5 --password pw");
  const auto options = std::make_shared<serve::ServeOptions>();
  const auto password_file = std::make_shared<std::string>();
  const auto texts_file = std::make_shared<std::string>();
  add_access(app, *options, *password_file);
  add_contents(app, *options, *texts_file);
  app.add_option("--log", &options->log,
                 "Append lines and logins to this file; at 1 MB it is renamed FILE.1, three old "
                 "files are kept")
      .value_name("FILE")
      .file(FileUse::write);
  app.add_option("--pair", &options->pairs,
                 "Print a code; a page in which it is entered may fire on a real board")
      .common();
  cli::add_board_choice(app, options->board);
  cli::add_machine(app, options->machine);
  app.action([options, password_file, texts_file] {
    if (!password_file->empty()) return set_password(*password_file);
    if (!texts_file->empty()) return write_texts(*texts_file);
    options->board.profile = options->machine.machine;
    return serve_board(*options);
  });
}

}  // namespace lamplock::serve_tool
