// Parameters of a description (host/glass/parameters.hpp) as options of the command line.
//
// In:  a list of parameters. Out: an option each, with its range, default and help; the value goes
//      to the parameter's place. Who: the commands that make points or jobs.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/glass/parameters.hpp"

namespace lamplock::cli {

/// Adds them in a group of the help; gives the options. The places must outlive the parsing.
std::vector<Option*> add_parameters(Command& app, const std::vector<glass::Parameter>& parameters,
                                    const std::string& group);

}  // namespace lamplock::cli
