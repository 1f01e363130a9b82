#include "host/cli/program_main.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/cli/parser.hpp"
#include "host/error.hpp"

namespace lamplock::cli {
namespace {

/// Outside jobs there is nothing to hold: Ctrl-C ends the program.
void leave(int) { ::_exit(static_cast<int>(Exit::interrupted)); }

int fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return static_cast<int>(error.exit());
}

}  // namespace

int program_main(Command& program, int argc, char** argv) {
  std::signal(SIGINT, leave);
  // A connection that breaks is an error of write(), not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    return static_cast<int>(run(program, arguments));
  } catch (const Error& error) {
    return fail(error);
  } catch (const std::bad_alloc&) {
    return fail({Exit::job_failed, "lamplock", "out of memory", "use a greater --spacing"});
  } catch (const std::exception& error) {
    return fail(
        {Exit::job_failed, "lamplock", error.what(), "this should not happen, please report it"});
  }
}

}  // namespace lamplock::cli
