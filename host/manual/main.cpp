// The program `lamplock_manual`: writes manual pages and completions while lamplock is built.
//
// usage: lamplock_manual FOLDER DATE
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "host/bench/command_bench.hpp"
#include "host/chip_tool/command_chip.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/document_paths.hpp"
#include "host/cli/program.hpp"
#include "host/file.hpp"
#include "host/manual/completion.hpp"
#include "host/manual/man_page.hpp"
#include "host/serve_tool/commands.hpp"
#include "host/version.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("error: lamplock_manual: needs two arguments; give FOLDER and DATE\n", stderr);
    return static_cast<int>(lamplock::Exit::bad_input);
  }
  try {
    const std::filesystem::path folder = argv[1];
    const auto program = lamplock::cli::make_own_commands();
    lamplock::serve_tool::add_serve(*program);
    lamplock::serve_tool::add_watch(*program);
    lamplock::chip_tool::add_chip(*program);
    lamplock::bench::add_bench(*program);
    lamplock::cli::add_help(*program);
    lamplock::cli::name_documents(*program, lamplock::cli::package_documents);
    std::filesystem::create_directories(folder / "man");
    for (const auto& [file, text] :
         lamplock::manual::man_pages(*program, {lamplock::version(), argv[2]}))
      lamplock::write_file(folder / "man" / file, text);
    lamplock::write_file(folder / "lamplock.bash", lamplock::manual::bash_completion(*program));
    lamplock::write_file(folder / "lamplock.fish", lamplock::manual::fish_completion(*program));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(lamplock::Exit::job_failed);
  }
  return static_cast<int>(lamplock::Exit::done);
}
