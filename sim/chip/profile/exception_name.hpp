// Names of exceptions and interrupts, as the datasheet has them.
#pragma once

#include <string>

namespace lamplock::sim::chip {

/// Of an exception's number: "SysTick", "TIMER_0"; "exception 42" for those that have no name.
std::string exception_name(unsigned number);

}  // namespace lamplock::sim::chip
