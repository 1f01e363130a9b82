// The whole command line: its options and every command.
//
// In:  nothing. Out: an application ready to parse.
// Who: main.cpp; the manual (host/manual), which describes what is here and nothing else.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "host/cli/commands.hpp"

namespace lamplock::cli {

/// The application; parsing sets `action`, which must outlive it.
std::unique_ptr<CLI::App> make_program(Action& action);

}  // namespace lamplock::cli
