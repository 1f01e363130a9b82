// The commands of the program.
//
// In:  the CLI11 application. Out: each function adds one command with its options, description and
//      example; when the command is given, `action` becomes what it does.
// Who: main.cpp, which parses, runs the action and turns errors into one line.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "host/error.hpp"

namespace lamplock::cli {

/// What a command does; gives the exit status or throws lamplock::Error.
using Action = std::function<Exit()>;

void add_example(CLI::App& program, Action& action);
void add_points(CLI::App& program, Action& action);
void add_order(CLI::App& program, Action& action);
void add_check(CLI::App& program, Action& action);
void add_diagnose(CLI::App& program, Action& action);
void add_job(CLI::App& program, Action& action);
void add_raster(CLI::App& program, Action& action);
void add_send(CLI::App& program, Action& action);
void add_settings(CLI::App& program, Action& action);
void add_devices(CLI::App& program, Action& action);
void add_flash(CLI::App& program, Action& action);
void add_console(CLI::App& program, Action& action);
void add_estimate(CLI::App& program, Action& action);
void add_engrave(CLI::App& program, Action& action);
void add_frame(CLI::App& program, Action& action);
void add_operate(CLI::App& program, Action& action);
void add_jog(CLI::App& program, Action& action);
void add_lines(CLI::App& program, Action& action);
void add_compare(CLI::App& program, Action& action);
void add_sim(CLI::App& program, Action& action);
void add_chip(CLI::App& program, Action& action);
void add_bench(CLI::App& program, Action& action);

}  // namespace lamplock::cli
