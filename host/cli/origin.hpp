// The option --origin. Who: `engrave`, `estimate`, `frame`.
#pragma once

#include <string>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// `name` becomes one of run::origin_machine and run::origin_zero.
void add_origin(Command& app, std::string& name);

}  // namespace lamplock::cli
