// Columns of the terminal that the output goes to.
//
// In:  nothing. Out: a number of columns. Who: the help.
#pragma once

#include <cstddef>

namespace lamplock::cli {

/// Columns of the terminal at stdout; without a terminal those of the environment variable COLUMNS;
/// without both 80.
std::size_t terminal_width();

}  // namespace lamplock::cli
