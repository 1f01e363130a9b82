#include "host/file/output_files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

/// One name for one place, whether the file is there or not.
fs::path only_name_of(const std::string& file) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(place_of(file), error), error);
  return error ? fs::path(file).lexically_normal() : place;
}

/// Two names of one place, or of one file that is there: a link, or a file system that ignores
/// capitals.
bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return only_name_of(a) == only_name_of(b) || (fs::equivalent(a, b, error) && !error);
}

/// The input that an output would replace; null: none. An input that is missing is another error.
const std::string* replaced_input(const std::string& output,
                                  const std::vector<std::string>& inputs) {
  const auto found = std::find_if(inputs.begin(), inputs.end(), [&](const std::string& input) {
    std::error_code ignored;
    return fs::is_regular_file(input, ignored) && is_same_file(output, input);
  });
  return found == inputs.end() ? nullptr : &*found;
}

}  // namespace

bool is_standard_output(const std::string& file) {
  struct stat of_file {};
  struct stat of_output {};
  return ::stat(file.c_str(), &of_file) == 0 && ::fstat(STDOUT_FILENO, &of_output) == 0 &&
         (S_ISREG(of_file.st_mode) || S_ISFIFO(of_file.st_mode)) &&
         of_file.st_dev == of_output.st_dev && of_file.st_ino == of_output.st_ino;
}

void check_distinct(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
  std::vector<Output> seen;
  seen.reserve(outputs.size());
  for (const auto& [option, file] : outputs) {
    if (file.empty() || is_special(file)) continue;
    if (replaced_input(file, inputs) != nullptr)
      throw Error(Exit::bad_input, file,
                  fmt::format("is an input of this command, and {} would replace it", option),
                  option == "--report" ? "give another folder" : "give another file name");
    for (const Output& other : seen)
      if (is_same_file(file, other.file))
        throw Error(Exit::bad_input, file,
                    fmt::format("is to be written by {} and {}", other.option, option),
                    "give each a file of its own");
    seen.push_back({option, file});
  }
}

}  // namespace lamplock
