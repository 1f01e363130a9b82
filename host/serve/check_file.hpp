// What a file does, without the machine: errors, time, bounds, a picture.
//
// In:  a file of the server, the machine. Out: the result of `job.check`. Who: the server, in a
//      thread of its own, because a long program takes seconds.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/run/check_program.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/process_choice.hpp"

namespace lamplock::serve {

/// Options of a check with the values of this material. Throws Error(bad_input) if the library
/// lacks the material or its setting.
run::CheckOptions check_options(const std::string& path, const run::MachineOptions& machine,
                                const run::ProcessChoice& material);

/// Throws Error for a file that cannot be read, program_run::NoMaterial for a program that needs
/// the values of a material.
nlohmann::json check_file(const std::string& path, const std::string& name,
                          const run::MachineOptions& machine, const run::ProcessChoice& material);

}  // namespace lamplock::serve
