// Names of exceptions and interrupts, as in the datasheet.
#pragma once

#include <string>

namespace lamplock::sim::chip {

/// Name of an exception number: "SysTick", "TIMER_0"; "exception 42" for those without a name.
std::string exception_name(unsigned number);

}  // namespace lamplock::sim::chip
