// The options of the command line that choose a board, what is simulated round it, and files.
//
// In:  a command. Out: its options, whose values go to run::BoardOptions.
// Who: the commands that run something on a board.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/run/board_options.hpp"

namespace lamplock::cli {

void add_lamp_faults(Command& app, run::LampFaults& faults);
void add_drives(Command& app, run::SimulatedDrives& drives);
void add_spot(Command& app, run::SimulatedSpot& spot);

void add_board_choice(Command& app,
                      run::BoardOptions& options);  ///< --board, --image, --usb, --lines
void add_board(Command& app, run::BoardOptions& options, bool& json);  ///< these, --yes, --json
void add_part(Command& app, run::BoardOptions& options);               ///< --from, --fired
void add_resume(Command& app, run::BoardOptions& options);             ///< --resume, --progress
void add_job_speed(Command& app, run::BoardOptions& options);          ///< --job-speed
/// These, --job-speed, --dry, --hold-at, --report, --statistics, --vcd, --shots, --timing, --plot
/// and what is simulated.
void add_job_run(Command& app, run::BoardOptions& options);

}  // namespace lamplock::cli
