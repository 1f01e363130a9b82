// The outputs and inputs for programs of a board with these settings.
//
// In:  settings, of which the pin map decides. Out: the ports as the firmware has them.
// Who: the runs of programs on the host.
#pragma once

#include "firmware/machine/activities/program_reader.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

machine::ProgramPorts ports_of(const settings::Values& values);

}  // namespace lamplock::program_run
