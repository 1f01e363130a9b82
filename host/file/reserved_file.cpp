#include "host/file/reserved_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "host/file/staged_file.hpp"
#include "host/output_error.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

constexpr mode_t for_all_to_read = 0644;

/// Returns false, with errno, if not everything could be written.
bool write_at_begin(int descriptor, std::string_view text) {
  off_t at = 0;
  while (!text.empty()) {
    const ssize_t written = ::pwrite(descriptor, text.data(), text.size(), at);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::ftruncate(descriptor, at) == 0;
}

}  // namespace

ReservedFile::ReservedFile(fs::path target, std::size_t bytes)
    : target_(std::move(target)),
      place_(place_of(target_)),
      staged_(staged_path(place_)),
      unfinished_(staged_) {
  descriptor_ = ::open(staged_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, for_all_to_read);
  if (descriptor_ < 0) throw OutputError(target_, errno);
  const int error = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
  // Not every file system can reserve space.
  if (error != 0 && error != EOPNOTSUPP && error != ENOSYS) {
    ::close(descriptor_);
    ::unlink(staged_.c_str());
    throw OutputError(target_, error);
  }
}

ReservedFile::~ReservedFile() {
  ::close(descriptor_);
  ::unlink(staged_.c_str());
}

void ReservedFile::write(std::string_view text) {
  std::error_code error;
  if (!write_at_begin(descriptor_, text)) error = {errno, std::generic_category()};
  if (!error) error = put_in_place(staged_, place_);
  if (!error) return;
  if (error != std::errc::no_such_file_or_directory) throw OutputError(target_, error.value());
  write_whole(target_, text);
}

}  // namespace lamplock
