// Parts of the command `material` that have files of their own.
//
// In:  the command. Out: its inner commands with their options and actions.
// Who: command_material.cpp.
#pragma once

#include <string>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// --library.
void add_library(Command& app, std::string& library);
/// measure, fit, best, suitable.
void add_material_cuts(Command& app);
/// card.
void add_material_card(Command& app);

}  // namespace lamplock::cli
