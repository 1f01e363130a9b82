// Names of the ways to join points, as users write them. Who: commands and reports.
#pragma once

#include <cstdint>
#include <string>

#include "shared/wire/target.hpp"

namespace lamplock::run {

/// The mode with this name: free, path, start-stop.
wire::JoinMode mode_named(const std::string& name);

/// The name of a mode, as the job header has it.
std::string mode_name(std::uint8_t mode);

}  // namespace lamplock::run
