#include "host/serve/job_folder.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_name = 100;
constexpr std::string_view job_ending = ".llj";

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

std::optional<fs::path> folder_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr || *value != '/') return std::nullopt;
  return fs::path(value);
}

}  // namespace

JobFolder::JobFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  const bool is_new = fs::create_directories(folder_, error);
  if (!error && is_new) fs::permissions(folder_, fs::perms::owner_all, error);
  if (error || !fs::is_directory(folder_))
    throw Error(Exit::bad_input, folder_.string(),
                "cannot be used as the folder of jobs: " + error.message(),
                "give another one with --folder");
}

bool JobFolder::is_name(std::string_view name) {
  constexpr std::string_view others = " ._-()+";
  if (name.empty() || name.size() > max_name || name.front() == '.') return false;
  return std::all_of(name.begin(), name.end(), [&](char c) {
    return is_word(c) || others.find(c) != std::string_view::npos;
  });
}

std::vector<JobFile> JobFolder::list() const {
  std::vector<JobFile> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool is_sent = lower_extension(name) == job_ending || run::is_program_name(name);
    if (is_sent && is_name(name) && entry.is_regular_file(ignored) && !entry.is_symlink(ignored))
      files.push_back({name, entry.file_size(ignored)});
  }
  std::sort(files.begin(), files.end(),
            [](const JobFile& a, const JobFile& b) { return a.name < b.name; });
  return files;
}

void JobFolder::write(const std::string& name, std::string_view bytes) const {
  if (!is_name(name))
    throw Error(Exit::bad_input, name, "is not a name for a file of the server",
                "use letters, digits, spaces and . _ - ( ) +, at most 100, not beginning with .");
  if (lower_extension(name) != job_ending && !run::is_program_name(name))
    throw Error(Exit::bad_input, name, "is neither a job (.llj) nor a program of G-code",
                "make a job of it: lamplock job, or a program: lamplock cut");
  write_whole(folder_ / name, [&](const fs::path& path) { write_file(path, bytes); });
}

fs::path JobFolder::path_of(const std::string& name) const {
  std::error_code ignored;
  fs::path path = folder_ / name;
  if (!is_name(name) || !fs::is_regular_file(path, ignored) || fs::is_symlink(path, ignored))
    throw Error(Exit::bad_input, name, "the server has no such file", "send it first");
  return path;
}

void JobFolder::remove(const std::string& name) const {
  const fs::path path = path_of(name);
  std::error_code error;
  fs::remove(path, error);
  if (error) throw Error(Exit::bad_input, name, error.message(), "remove it in its folder");
  fs::remove(path.string() + ".progress", error);
}

fs::path default_job_folder() {
  const fs::path place = fs::path("lamplock") / "jobs";
  if (const auto data = folder_in("XDG_DATA_HOME")) return *data / place;
  if (const auto home = folder_in("HOME")) return *home / ".local" / "share" / place;
  throw Error(Exit::bad_input, "folder of jobs", "neither XDG_DATA_HOME nor HOME names a folder",
              "give one with --folder");
}

}  // namespace lamplock::serve
