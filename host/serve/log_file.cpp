#include "host/serve/log_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cerrno>
#include <ctime>
#include <system_error>

#include "host/output_error.hpp"
#include "host/printable.hpp"

namespace lamplock::serve {

LogFile::LogFile(std::filesystem::path file, std::size_t max_bytes)
    : file_(std::move(file)), max_bytes_(max_bytes) {
  errno = 0;
  open();
  if (!stream_) throw OutputError(file_, errno);
}

void LogFile::open() {
  stream_.clear();
  stream_.open(file_, std::ios::app);
  std::error_code error;
  const auto size = std::filesystem::file_size(file_, error);
  bytes_ = error ? 0 : size;
}

void LogFile::rotate() {
  stream_.close();
  const auto old = [this](int number) {
    return std::filesystem::path(fmt::format("{}.{}", file_.string(), number));
  };
  std::error_code ignored;  // a part that is missing
  for (int number = old_files - 1; number >= 1; --number)
    std::filesystem::rename(old(number), old(number + 1), ignored);
  std::filesystem::rename(file_, old(1), ignored);
  open();
}

bool LogFile::add(std::string_view line) noexcept {
  try {
    const std::string text =
        fmt::format("{:%Y-%m-%d %H:%M:%S} {}\n", fmt::localtime(std::time(nullptr)),
                    printable(std::string(line)));
    if (bytes_ > 0 && bytes_ + text.size() > max_bytes_) rotate();
    if (!stream_.is_open() || !stream_) open();
    stream_ << text << std::flush;
    if (!stream_) return false;
    bytes_ += text.size();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace lamplock::serve
