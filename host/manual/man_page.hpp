// Manual pages, generated from the command line: the contents of --help, in the form of man(7).
//
// In:  the commands of the program. Out: lamplock.1 with an overview, and a page for each command.
// Who: lamplock_manual, while the program is built.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"

namespace lamplock::manual {

/// Text in the margins of pages.
struct Edition {
  std::string version{};  ///< of the program
  std::string date{};     ///< "2026-11-23"
};

/// One page.
struct Page {
  std::string file{};  ///< "lamplock-engrave.1"
  std::string text{};
};

/// All pages, that of the program first.
std::vector<Page> man_pages(const cli::Command& program, const Edition& edition);

}  // namespace lamplock::manual
