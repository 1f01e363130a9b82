// `lamplock watch`: state, position and progress of a machine that `lamplock serve` holds.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/cli/command_line.hpp"
#include "host/cli/console.hpp"
#include "host/cli/program.hpp"
#include "host/cli/validators.hpp"
#include "host/serve/watch.hpp"
#include "host/serve_tool/commands.hpp"

namespace lamplock::serve_tool {
namespace {

using cli::Command;
using cli::Console;
using cli::number_in;

constexpr const char* page_variable = "LAMPLOCK_PAGE";

struct WatchChoice {
  std::string page;
  double every_s = 1;
  bool once = false, json = false;
};

void show(const nlohmann::json& status, bool json) {
  if (json) {
    fmt::print("{}\n", status.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    if (const auto lines = status.find("console"); lines != status.end())
      for (const nlohmann::json& line : *lines) fmt::print("  {}\n", line.value("text", ""));
    fmt::print("{}\n", serve::status_text(status));
  }
  std::fflush(stdout);
}

Exit run_watch(const WatchChoice& choice) {
  serve::WatchOptions options;
  const char* const page = std::getenv(page_variable);
  options.page = choice.page.empty() && page != nullptr ? page : choice.page;
  options.once = choice.once;
  options.every = std::chrono::milliseconds(static_cast<int>(choice.every_s * 1000));
  Console console(choice.json);
  serve::watch(
      options, [&](const nlohmann::json& status) { show(status, choice.json); }, console);
  return choice.once ? Exit::done : Exit::interrupted;
}

}  // namespace

void add_watch(Command& program) {
  Command& app = cli::add_watch_command(program);
  app.footer(
      "Prints a line when state, position or progress of the machine change, and new lines of its\n"
      "console. It never takes control. Ctrl-C ends it; the machine is not touched. Other users "
      "of\n"
      "this computer see the token in a command line, but not in the variable LAMPLOCK_PAGE.\n"
      "Example:\n"
      "  lamplock watch 'http://127.0.0.1:7125/#token=a1'\n"
      "  lamplock watch --json");
  const auto choice = std::make_shared<WatchChoice>();
  app.add_option("PAGE", &choice->page,
                 "Address that lamplock serve has printed; default: the variable LAMPLOCK_PAGE")
      .value_name("ADDRESS")
      .common();
  app.add_option("--every", &choice->every_s, "Time between two status queries, in seconds")
      .check(number_in({0.1, 3600.0}))
      .value_name("S")
      .show_default()
      .common();
  app.add_option("--once", &choice->once, "Print the status once and end").common();
  app.add_json(choice->json, "Print one JSON document a line (docs/api.md)");
  app.action([choice] { return run_watch(*choice); });
}

}  // namespace lamplock::serve_tool
