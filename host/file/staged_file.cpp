#include "host/file/staged_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <utility>

#include "host/error.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw Error(Exit::bad_input, path.string(), what,
              "give a file name in an existing folder; check permissions and free space");
}

}  // namespace

bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

void check_target(const fs::path& target) {
  std::error_code ignored;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (fs::is_directory(target, ignored)) refuse(target, "is a folder, not a file");
  if (!fs::is_directory(folder, ignored)) refuse(target, "its folder does not exist");
  if (::access(folder.c_str(), W_OK) != 0 && !is_special(target))
    refuse(target, "cannot be written");
}

StagedFile::StagedFile(fs::path target) : target_(std::move(target)), staged_(target_) {
  check_target(target_);
  // Two runs at a time must not write into each other's file.
  if (!is_special(target_)) staged_ += fmt::format(".{}.part", ::getpid());
}

StagedFile::~StagedFile() {
  std::error_code ignored;
  if (staged_ != target_) fs::remove(staged_, ignored);
}

void StagedFile::commit() {
  if (staged_ == target_) return;
  std::error_code error;
  fs::rename(staged_, target_, error);
  if (error) refuse(target_, "cannot be written (" + error.message() + ")");
}

void write_whole(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  StagedFile file(target);
  try {
    write(file.path());
  } catch (const Error&) {
    refuse(target, "cannot be written");  // the writer's error would name the other path
  }
  file.commit();
}

}  // namespace lamplock
