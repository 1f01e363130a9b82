// What a file does, without the machine: errors, time, bounds, a picture.
//
// In:  a file of the server, the machine. Out: the result of `job.check`. Who: the server, in a
//      thread of its own, because a long program takes seconds.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/run/machine_options.hpp"

namespace lamplock::serve {

/// Throws Error for a file that cannot be read.
nlohmann::json check_file(const std::string& path, const std::string& name,
                          const run::MachineOptions& machine);

}  // namespace lamplock::serve
