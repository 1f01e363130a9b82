#include "host/run/event_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <system_error>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/output_error.hpp"

namespace lamplock::run {
namespace {

/// A pipe that is ready takes as much at once (POSIX, write()).
constexpr std::size_t write_size = PIPE_BUF;

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

void EventStream::check(const std::string& path) {
  if (path != standard_output) check_target(path);
}

EventStream::EventStream(const std::string& path) {
  if (path == standard_output) {
    descriptor_ = STDOUT_FILENO;
    return;
  }
  constexpr int permissions = 0666;
  descriptor_ = ::open(
      path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, permissions);
  if (descriptor_ < 0 && errno == ENXIO)
    throw Error(Exit::bad_input, path, "no program reads this pipe", "start its reader first");
  if (descriptor_ < 0) throw OutputError(path, errno);
  is_owned_ = true;
}

EventStream::~EventStream() {
  if (is_owned_) ::close(descriptor_);
}

void EventStream::add(const std::string& line) {
  if (!loss_.empty()) return;
  waiting_ += line;
  waiting_ += '\n';
  poll();
  if (waiting_.size() - written_ > max_waiting) lose("its reader is too slow");
}

void EventStream::poll() {
  while (written_ < waiting_.size() && is_writable(std::chrono::milliseconds{0})) {
    const ssize_t written = ::write(descriptor_, waiting_.data() + written_,
                                    std::min(waiting_.size() - written_, write_size));
    if (written > 0)
      written_ += static_cast<std::size_t>(written);
    else if (written < 0 && errno == EAGAIN)
      return;
    else if (written < 0 && errno != EINTR)
      return lose(reason(errno));
  }
  if (written_ < waiting_.size() && written_ < max_waiting) return;
  waiting_.erase(0, written_);
  written_ = 0;
}

void EventStream::finish(std::chrono::milliseconds patience) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + patience;
  const auto left = [until] {
    const auto time = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    return std::max(time, std::chrono::milliseconds{0});
  };
  poll();
  while (!waiting_.empty() && is_writable(left())) poll();
  if (!waiting_.empty()) lose("its reader does not read");
}

/// Also true after an error, which the next write() reports.
bool EventStream::is_writable(std::chrono::milliseconds patience) {
  pollfd watched{descriptor_, POLLOUT, 0};
  return ::poll(&watched, 1, static_cast<int>(patience.count())) > 0;
}

void EventStream::lose(const std::string& why) {
  loss_ = why;
  waiting_.clear();
  written_ = 0;
}

}  // namespace lamplock::run
