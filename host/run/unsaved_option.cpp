#include "host/run/unsaved_option.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace lamplock::run {

void refuse_unsaved(const std::string& save, bool is_given, const char* option) {
  if (save.empty() || !is_given) return;
  throw Error(Exit::bad_input, option, "is not saved in a description",
              fmt::format("leave it out beside --save, and give {} with the description", option));
}

}  // namespace lamplock::run
