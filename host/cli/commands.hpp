// The commands of the program.
//
// In:  the program. Out: each function adds one command with its options, description, example and
//      action. Who: program.cpp.
#pragma once

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

void add_example(Command& program);
void add_points(Command& program);
void add_order(Command& program);
void add_check(Command& program);
void add_diagnose(Command& program);
void add_heat(Command& program);
void add_jerk(Command& program);
void add_job(Command& program);
void add_raster(Command& program);
void add_cut(Command& program);
void add_material(Command& program);
void add_send(Command& program);
void add_settings(Command& program);
void add_devices(Command& program);
void add_flash(Command& program);
void add_console(Command& program);
void add_estimate(Command& program);
void add_engrave(Command& program);
void add_frame(Command& program);
void add_operate(Command& program);
void add_jog(Command& program);
void add_lines(Command& program);
void add_compare(Command& program);
void add_sim(Command& program);
/// After all others, whose names it offers.
void add_help(Command& program);

}  // namespace lamplock::cli
