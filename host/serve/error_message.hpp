// The text of an error for clients and the console, without the prefix that a terminal shows.
#pragma once

#include <exception>
#include <string>

namespace lamplock::serve {

std::string message_of(const std::exception& error);
std::string message_of(const std::exception_ptr& error);

}  // namespace lamplock::serve
