// Parameters of a description (host/glass/parameters.hpp) as options of the command line.
//
// In:  a list of parameters. Out: an option each, with its range, default and help; the value goes
//      to the parameter's place. Who: the commands that make points or jobs.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/glass/parameters.hpp"

namespace lamplock::cli {

/// Adds them in a group of the help; gives the options. The places must outlive the parsing.
std::vector<CLI::Option*> add_parameters(CLI::App& app,
                                         const std::vector<glass::Parameter>& parameters,
                                         const std::string& group);

}  // namespace lamplock::cli
