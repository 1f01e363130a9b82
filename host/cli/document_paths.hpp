// Help texts name guides and examples by their paths in the source tree (docs/settings.md); an
// installed program names the files that were installed.
//
// In:  the commands of a program. Out: the same with complete paths in help and footers.
// Who: program_main(); lamplock_manual for the manual pages.
#pragma once

#include <string>
#include <string_view>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// Where a package installs guides and examples.
inline constexpr const char* package_documents = "/usr/share/doc/lamplock";

/// The folder with the documents of this program; empty if it is not installed.
std::string installed_documents();

/// Puts a folder before each path that begins with docs/ or examples/.
std::string with_documents_in(const std::string& folder, std::string_view text);

/// The same for all texts of a command and of its commands; an empty folder changes nothing.
void name_documents(Command& command, const std::string& folder);

}  // namespace lamplock::cli
