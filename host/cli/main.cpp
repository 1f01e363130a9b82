// The program `lamplock`: parses the command line, runs one command, turns errors into one line.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "host/cli/program.hpp"

namespace {

using lamplock::Exit;

/// Outside jobs there is nothing to hold: Ctrl-C ends the program.
void leave(int) { ::_exit(static_cast<int>(Exit::interrupted)); }

/// What the parser found wrong, in our form: it says `--option: what` or just what.
lamplock::Error usage_error(const CLI::App& program, const CLI::ParseError& error, int argc,
                            char** argv) {
  const auto commands = program.get_subcommands();
  const std::string name = commands.empty() ? "lamplock" : "lamplock " + commands[0]->get_name();
  std::string where = name, what = error.what();
  const auto colon = what.find(": ");
  if (what.starts_with("-") && colon != std::string::npos) {
    where = what.substr(0, colon);
    what.erase(0, colon + 2);
  }
  if (what == "A subcommand is required")
    what = commands.empty() && argc > 1 ? fmt::format("unknown command '{}'", argv[1])
                                        : "a command is missing";
  return {Exit::bad_input, where, what, "see " + name + " --help"};
}

Exit run(int argc, char** argv) {
  lamplock::cli::Action action;
  const auto program = lamplock::cli::make_program(action);
  try {
    program->parse(argc, argv);
  } catch (const CLI::Success& help) {
    program->exit(help);
    return Exit::done;
  } catch (const CLI::ParseError& error) {
    throw usage_error(*program, error, argc, argv);
  }
  return action();
}

/// Prints an error as one line, whatever is in it.
int fail(Exit exit, std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fputs((line + "\n").c_str(), stderr);
  return static_cast<int>(exit);
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, leave);
  // A connection that breaks is an error of write(), not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return static_cast<int>(run(argc, argv));
  } catch (const lamplock::Error& error) {
    return fail(error.exit(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(Exit::job_failed, "error: lamplock: out of memory; use a greater --spacing");
  } catch (const std::exception& error) {
    return fail(
        Exit::job_failed,
        fmt::format("error: lamplock: {}; this should not happen, please report it", error.what()));
  }
}
