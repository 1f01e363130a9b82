#include "host/cli/program_main.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/parser.hpp"
#include "host/error.hpp"

namespace lamplock::cli {
namespace {

/// A standard stream that the caller has closed becomes one that is at its end and refuses output.
/// Otherwise the next file to be opened, such as the port of a board, would take its number.
void open_standard_streams() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor)
    if (::fcntl(descriptor, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) < 0) return;
}

/// The terminal may have gone: what cannot be written is left out.
int fail(const Error& error) {
  std::fputs((std::string(error.what()) + '\n').c_str(), stderr);
  return status_of(error.exit());
}

/// What was printed may wait in buffers still. A reader that has seen enough is no error to speak
/// of (`| head`).
int check_output(int status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) return status;
  if (status != 0) return status;
  const int reason = errno;
  const int failed = static_cast<int>(Exit::job_failed);
  if (reason == EPIPE) return failed;
  return fail({Exit::job_failed, "standard output",
               "cannot be written (" + std::generic_category().message(reason) + ")",
               "check where it is sent to and its free space"});
}

}  // namespace

int program_main(Command& program, int argc, char** argv) {
  open_standard_streams();
  end_at_signals();
  // A connection that breaks is an error of write(), not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    return check_output(status_of(run(program, arguments)));
  } catch (const Error& error) {
    return fail(error);
  } catch (const std::bad_alloc&) {
    return fail({Exit::job_failed, "lamplock", "out of memory", "use a greater --spacing"});
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) != 0) return check_output(0);
    return fail({Exit::job_failed, "lamplock", error.what(), "check files, cables and terminal"});
  } catch (const std::exception& error) {
    return fail(
        {Exit::job_failed, "lamplock", error.what(), "this should not happen, please report it"});
  }
}

}  // namespace lamplock::cli
