#include "host/file/output_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

/// One name for one place, whether the file is there or not.
fs::path place_of(const std::string& file) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(file, error), error);
  return error ? fs::path(file).lexically_normal() : place;
}

}  // namespace

void check_distinct(const std::vector<Output>& outputs, const std::string& input) {
  std::vector<Output> seen;
  seen.reserve(outputs.size());
  for (const auto& [option, file] : outputs) {
    if (file.empty() || is_special(file)) continue;
    if (!input.empty() && place_of(file) == place_of(input))
      throw Error(Exit::bad_input, file,
                  fmt::format("is the input of this command, and {} would replace it", option),
                  option == "--report" ? "give another folder" : "give another file name");
    for (const Output& other : seen)
      if (place_of(file) == place_of(other.file))
        throw Error(Exit::bad_input, file,
                    fmt::format("is to be written by {} and {}", other.option, option),
                    "give each a file of its own");
    seen.push_back({option, file});
  }
}

}  // namespace lamplock
