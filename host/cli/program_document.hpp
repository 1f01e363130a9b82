// The document of a program that was run, for scripts.
//
// In:  the outcome of a program. Out: JSON. Who: `send`, `cut`.
#pragma once

#include "host/cli/json.hpp"
#include "host/run/run_program.hpp"

namespace lamplock::cli {

Json program_json(const run::ProgramOutcome& outcome);

}  // namespace lamplock::cli
