// What is wrong with arguments that the parser has refused, and what to write instead.
//
// In:  the commands as data, the arguments of main. Out: the error about the first wrong argument,
//      in the order in which they were typed; then what is missing.
// Who: the parser (parser.cpp), after CLI11 has refused the arguments: an error here never refuses
//      arguments that CLI11 accepts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cli/command_line.hpp"
#include "host/error.hpp"

namespace lamplock::cli {

/// The error; empty if every rule known here is kept.
std::optional<Error> usage_error(const Command& program, const std::vector<std::string>& arguments);

}  // namespace lamplock::cli
