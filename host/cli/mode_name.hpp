// Names of the ways to join points, as users write them. Who: commands and reports.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/motion/target.hpp"

namespace lamplock::cli {

/// The mode with this name: free, path, start-stop.
motion::JoinMode mode_named(const std::string& name);

/// The name of a mode, as the job header has it.
std::string mode_name(std::uint8_t mode);

}  // namespace lamplock::cli
