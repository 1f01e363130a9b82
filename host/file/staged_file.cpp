#include "host/file/staged_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "host/file.hpp"
#include "host/file/reserved_file.hpp"
#include "host/output_error.hpp"
#include "host/printable.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

/// Free space that an output needs at least: a block of common file systems.
constexpr off_t trial_bytes = 4096;

/// In a folder such as /tmp only the owner of a file may replace it, although every user may add
/// files.
bool is_of_another_user(const fs::path& target, const fs::path& folder) {
  struct stat file {};
  struct stat of_folder {};
  if (::lstat(target.c_str(), &file) != 0 || ::stat(folder.c_str(), &of_folder) != 0) return false;
  const uid_t user = ::geteuid();
  return (of_folder.st_mode & S_ISVTX) != 0 && user != 0 && file.st_uid != user &&
         of_folder.st_uid != user;
}

void check_parent(const fs::path& target) {
  std::error_code ignored;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (fs::is_directory(target, ignored)) throw OutputError(target, "is a folder, not a file");
  if (!fs::is_directory(folder, ignored))
    throw OutputError(target, "is in a folder that does not exist");
  if (is_of_another_user(target, folder)) throw OutputError(target, EPERM);
  if (fs::exists(target, ignored) && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0)
    throw OutputError(target, errno);
}

/// A device says only at a write that it takes nothing, as /dev/full does. A line end is harmless
/// to devices that take text; terminals, which show it, and pipes are not tried.
void try_device(const fs::path& target) {
  const int descriptor = ::open(target.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (descriptor < 0) throw OutputError(target, errno);
  const bool refuses = ::isatty(descriptor) == 0 && ::write(descriptor, "\n", 1) < 0;
  const int error = refuses && errno != EAGAIN ? errno : 0;
  ::close(descriptor);
  if (error != 0) throw OutputError(target, error);
}

/// An error of a writer with the name of the file that users know.
Error renamed(const Error& error, const fs::path& from, const fs::path& to) {
  std::string text(error.message());
  const std::string staged = printable(from.string()), name = printable(to.string());
  for (std::size_t at = 0; (at = text.find(staged, at)) != std::string::npos; at += name.size())
    text.replace(at, staged.size(), name);
  // Error joins its parts in the same way.
  const std::size_t where = text.find(": "), remedy = text.rfind("; ");
  return {error.exit(), text.substr(0, where), text.substr(where + 2, remedy - where - 2),
          text.substr(remedy + 2)};
}

}  // namespace

void require_extension(const fs::path& target, std::string_view extension,
                       const std::string& reason) {
  if (!target.empty() && lower_extension(target) != extension)
    throw Error(Exit::bad_input, target.string(), reason,
                fmt::format("name it something{}", extension));
}

bool is_special(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

fs::path staged_path(const fs::path& target) {
  // Two runs at a time must not write into each other's file.
  fs::path staged = target;
  staged += fmt::format(".{}.part", ::getpid());
  return staged;
}

fs::path place_of(const fs::path& target) {
  constexpr int max_links = 40;  // as in Linux, path_resolution(7)
  fs::path place = target;
  std::error_code error;
  for (int links = 0; fs::is_symlink(place, error); ++links) {
    const fs::path next = fs::read_symlink(place, error);
    if (error || links == max_links) throw OutputError(target, error ? error.value() : ELOOP);
    place = place.parent_path() / next;  // `next` alone if it is absolute
  }
  return place;
}

std::error_code put_in_place(const fs::path& staged, const fs::path& place) {
  struct stat former {};
  if (::stat(place.c_str(), &former) == 0) {
    // Root may keep the owner, the owner the mode; the contents count more than either.
    [[maybe_unused]] const int owner = ::chown(staged.c_str(), former.st_uid, former.st_gid);
    [[maybe_unused]] const int mode = ::chmod(staged.c_str(), former.st_mode & ALLPERMS);
  }
  std::error_code error;
  fs::rename(staged, place, error);
  return error;
}

void check_target(const fs::path& target) {
  check_parent(is_special(target) ? target : place_of(target));
  if (!is_special(target)) {
    const ReservedFile trial(target, trial_bytes);
    return;
  }
  std::error_code ignored;
  if (fs::is_character_file(target, ignored)) try_device(target);
}

StagedFile::StagedFile(fs::path target)
    : target_(std::move(target)),
      place_(is_special(target_) ? target_ : place_of(target_)),
      staged_(target_) {
  check_parent(place_);
  if (is_special(target_)) return;
  staged_ = staged_path(place_);
  unfinished_.emplace(staged_);
}

StagedFile::~StagedFile() {
  std::error_code ignored;
  if (staged_ != target_) fs::remove(staged_, ignored);
}

void StagedFile::commit() {
  if (staged_ == target_) return;
  if (const std::error_code error = put_in_place(staged_, place_))
    throw OutputError(target_, error.value());
}

void write_whole(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  StagedFile file(target);
  try {
    write(file.path());
  } catch (const OutputError& error) {
    throw OutputError(target, error.problem());  // the writer's error names the other path
  } catch (const Error& error) {
    throw renamed(error, file.path(), target);
  }
  file.commit();
}

void write_whole(const fs::path& target, std::string_view bytes) {
  write_whole(target, [bytes](const fs::path& path) { write_file(path, bytes); });
}

}  // namespace lamplock
