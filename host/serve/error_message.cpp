#include "host/serve/error_message.hpp"

#include "host/error.hpp"

namespace lamplock::serve {

std::string message_of(const std::exception& error) {
  const auto* const known = dynamic_cast<const Error*>(&error);
  return known == nullptr ? error.what() : std::string(known->message());
}

std::string message_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& known) {
    return message_of(known);
  }
}

}  // namespace lamplock::serve
