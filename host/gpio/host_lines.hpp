// The lines of this computer by libgpiod.
//
// In:  requests. Out: lines of the kernel's character devices (/dev/gpiochip*).
// Who: the command line. libgpiod 1.x and 2.x have different interfaces; the build uses the file
//      for the installed one: gpiod_v1.cpp (1.5 and 1.6, Debian 12) or gpiod_v2.cpp (2.0 and later,
//      Debian 13).
#pragma once

#include <memory>
#include <string>

#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// The lines of this computer.
std::unique_ptr<Lines> host_lines();

/// Name and version of the library: "libgpiod 1.6.3".
std::string library_version();

}  // namespace lamplock::gpio
