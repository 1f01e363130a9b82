#include "host/run/free_name.hpp"

#include <cctype>
#include <filesystem>
#include <optional>
#include <system_error>

#include "host/text.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

/// A name in two parts: "report", 2. More digits, or digits before them, are a date or the like.
struct NumberedName {
  std::string base{};
  unsigned number = 1;
};

NumberedName split(const std::string& name) {
  constexpr std::size_t max_digits = 3;
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  const std::size_t count = name.size() - digits;
  const bool has_base = digits > 1 && name[digits - 1] == '-' &&
                        std::isdigit(static_cast<unsigned char>(name[digits - 2])) == 0;
  if (!has_base || count == 0 || count > max_digits || name[digits] == '0') return {name, 1};
  return {name.substr(0, digits - 1), number_of<unsigned>(name.substr(digits)).value_or(1)};
}

/// "base-N" with the extension, in the folder of `path`.
std::string free_beside(const fs::path& path, const std::string& stem,
                        const std::string& extension) {
  NumberedName name = split(stem);
  while (true) {
    const fs::path next =
        path.parent_path() / (name.base + "-" + std::to_string(++name.number) + extension);
    std::error_code error;
    // A name that cannot be looked up is left to the command that will use it.
    if (!fs::exists(fs::symlink_status(next, error))) return next.string();
  }
}

}  // namespace

std::string next_free_name(const std::string& name) {
  const fs::path path(name);
  return free_beside(path, path.stem().string(), path.extension().string());
}

std::string next_free_folder(const std::string& name) {
  fs::path path(name);
  while (!path.has_filename() && path.has_relative_path()) path = path.parent_path();
  const std::string last = path.filename().string();
  // The name of "." and ".." is not that of the folder.
  if (last.empty() || last == "." || last == "..")
    return free_beside(path / "report", "report", "");
  return free_beside(path, last, "");
}

}  // namespace lamplock::run
