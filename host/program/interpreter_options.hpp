// How a board with these settings interprets programs.
//
// In:  settings, of which the pin map decides about outputs and inputs. Out: the options as the
//      firmware has them.
// Who: the runs of programs on the host.
#pragma once

#include "firmware/machine/activities/program_reader.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

program::Options program_options(const settings::Values& values);

}  // namespace lamplock::program_run
