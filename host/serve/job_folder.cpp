#include "host/serve/job_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <system_error>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/glass/description_file.hpp"
#include "host/model/input.hpp"
#include "host/run/sent_file.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_name = 100;
constexpr std::string_view job_ending = ".llj";

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// Null for a file that the server has no use for. Models that name other files (.obj, .glb) could
/// read them outside of the folder.
const char* kind_of(const std::string& name) {
  const std::string extension = lower_extension(name);
  if (extension == job_ending) return "job";
  if (run::is_program_name(name)) return "program";
  if (glass::is_description(name)) return "description";
  if (extension == ".obj" || extension == ".glb" || !model::kind_of(name)) return nullptr;
  return "model";
}

std::optional<fs::path> folder_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr || *value != '/') return std::nullopt;
  return fs::path(value);
}

}  // namespace

JobFolder::JobFolder(const fs::path& folder) : folder_(fs::absolute(folder).lexically_normal()) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();  // after a last slash
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
    const char* const kind = kind_of(name);
    if (kind != nullptr && is_name(name) && entry.is_regular_file(ignored) &&
        !entry.is_symlink(ignored))
      files.push_back({name, entry.file_size(ignored), kind});
  }
  std::sort(files.begin(), files.end(),
            [](const JobFile& a, const JobFile& b) { return a.name < b.name; });
  return files;
}

void JobFolder::check_name(const std::string& name) {
  if (!is_name(name)) throw Refusal(Exit::bad_input, "file-name", {{"name", name}});
  if (kind_of(name) == nullptr) throw Refusal(Exit::bad_input, "file-kind", {{"name", name}});
}

void JobFolder::write(const std::string& name, std::string_view bytes) const {
  check_name(name);
  write_whole(folder_ / name, bytes);
  std::error_code ignored;
  fs::remove(folder_ / (name + ".progress"), ignored);
}

std::string JobFolder::revision_of(const std::string& name) const {
  const fs::path path = path_of(name);
  std::error_code error;
  const auto written = fs::last_write_time(path, error);
  const auto bytes = fs::file_size(path, error);
  if (error) throw Error(Exit::bad_input, name, error.message(), "send it again");
  return fmt::format("{}-{}", bytes, written.time_since_epoch().count());
}

fs::path JobFolder::path_of(const std::string& name) const {
  std::error_code ignored;
  fs::path path = folder_ / name;
  if (!is_name(name) || !fs::is_regular_file(path, ignored) || fs::is_symlink(path, ignored))
    throw Refusal(Exit::bad_input, "no-file", {{"name", name}});
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
