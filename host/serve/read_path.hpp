// The path of a file of the server, program or rows.
//
// In:  a file, the machine, the material of a program. Out: its places, thinned.
// Who: the method path.open; reports.
#pragma once

#include <string>

#include "host/run/machine_options.hpp"
#include "host/run/process_choice.hpp"
#include "host/serve/shown_path.hpp"

namespace lamplock::serve {

/// Empty for a job of points. Throws Error for a file that cannot be read.
ShownPath read_path(const std::string& path, const run::MachineOptions& machine,
                    const run::ProcessChoice& material);

}  // namespace lamplock::serve
