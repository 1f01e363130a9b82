// `lamplock bench`: gain of planning, compared with the source documents and the optimum; a program
// of its own, lamplock-bench.
#pragma once

#include "host/cli/command_line.hpp"

namespace lamplock::bench {

/// Adds the command with its options.
void add_bench(cli::Command& program);

}  // namespace lamplock::bench
