#include "host/cli/program_main.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/cli/document_paths.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/parser.hpp"
#include "host/cli/standard_streams.hpp"
#include "host/error.hpp"

namespace lamplock::cli {
namespace {

/// The terminal may have gone: what cannot be written is left out.
int fail(const Error& error) {
  std::fputs((std::string(error.what()) + '\n').c_str(), stderr);
  return status_of(error.exit());
}

}  // namespace

int program_main(Command& program, int argc, char** argv) {
  prepare_streams();
  end_at_signals();
  // A connection that breaks is an error of write(), not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  // Programs of the user are waited for, also if our parent ignores its own.
  std::signal(SIGCHLD, SIG_DFL);
  // So is a file that reaches the size limit of the shell.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    name_documents(program, installed_documents());
    program.set_typed({argv, argv + argc});
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
