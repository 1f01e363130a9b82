// The whole command line: its options and every command.
//
// In:  nothing. Out: the commands as data. Who: main.cpp; the manual (host/manual), which describes
//      what is here and nothing else.
#pragma once

#include <memory>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// `lamplock` without commands.
std::unique_ptr<Command> make_empty_program();

/// `lamplock` with the commands that it runs itself.
std::unique_ptr<Command> make_own_commands();

/// Those, and the commands that are programs of their own, which only have a name and a description
/// here.
std::unique_ptr<Command> make_program();

/// Adds commands that are programs of their own without their options.
Command& add_serve_command(Command& program);
Command& add_watch_command(Command& program);
Command& add_chip_command(Command& program);
Command& add_bench_command(Command& program);

}  // namespace lamplock::cli
