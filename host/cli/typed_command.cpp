#include "host/cli/typed_command.hpp"

#include <utility>

namespace lamplock::cli {
namespace {

std::vector<std::string>& stored_words() {
  static std::vector<std::string> words;
  return words;
}

}  // namespace

void set_typed_command(std::vector<std::string> words) { stored_words() = std::move(words); }

const std::vector<std::string>& typed_command() { return stored_words(); }

}  // namespace lamplock::cli
