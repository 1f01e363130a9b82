// The material that a client has chosen for a program with process parameters.
//
// In:  the parameters of a request, the material library of the server. Out: the choice, its
//      values. Who: the methods job.check, path.open and job.start.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/run/process_choice.hpp"

namespace lamplock::serve {

/// `library` is a file; empty: the user's own. Throws Error(bad_input) for a part of the choice
/// without a material.
run::ProcessChoice material_choice(const nlohmann::json& parameters, const std::string& library);

/// Throws Error(bad_input) if a material is chosen for a job: only programs read its values.
void refuse_for_jobs(const run::ProcessChoice& choice);

}  // namespace lamplock::serve
