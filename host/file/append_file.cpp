#include "host/file/append_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "host/file/staged_file.hpp"
#include "host/output_error.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

constexpr mode_t readable_by_all = 0644;
/// More than any line; a block of common file systems.
constexpr off_t line_space_bytes = 4096;

/// Returns 0 or an error number.
int append_to(int descriptor, std::string_view text) {
  const off_t before = ::lseek(descriptor, 0, SEEK_END);
  ssize_t written = -1;
  do written = ::write(descriptor, text.data(), text.size());
  while (written < 0 && errno == EINTR);
  if (written < 0) return errno;
  if (static_cast<std::size_t>(written) == text.size()) return 0;
  // Unless another program has appended meanwhile. A pipe keeps what it has.
  const bool is_last = before >= 0 && ::lseek(descriptor, 0, SEEK_END) == before + written;
  if (is_last && ::ftruncate(descriptor, before) != 0) return errno;
  return ENOSPC;
}

}  // namespace

void check_appendable(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return check_target(file);
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0) throw OutputError(file, errno);
  const off_t end = ::lseek(descriptor, 0, SEEK_END);
  // Not every file system can reserve space.
  const int error =
      ::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, end, line_space_bytes) == 0 ? 0 : errno;
  ::close(descriptor);
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) throw OutputError(file, error);
}

void append_whole(const fs::path& file, std::string_view text) {
  std::error_code ignored;
  const bool is_new = !fs::exists(file, ignored);
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, readable_by_all);
  if (descriptor < 0) throw OutputError(file, errno);
  int error = append_to(descriptor, text);
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error == 0) return;
  if (is_new) fs::remove(file, ignored);
  throw OutputError(file, error);
}

}  // namespace lamplock
