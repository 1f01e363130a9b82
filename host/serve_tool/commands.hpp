// `lamplock serve` and `lamplock watch`: a machine as a page in the browser, and a look at one; a
// program of their own, lamplock-serve.
#pragma once

#include "host/cli/command_line.hpp"

namespace lamplock::serve_tool {

/// Add the commands with their options.
void add_serve(cli::Command& program);
void add_watch(cli::Command& program);

}  // namespace lamplock::serve_tool
