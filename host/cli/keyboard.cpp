#include "host/cli/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <thread>

namespace lamplock::cli {
namespace {

/// Limit of one call in bytes: an input that never pauses must not stop the caller's own work.
constexpr std::size_t max_read = 65536;

}  // namespace

bool Keyboard::at_terminal() {
  return ::isatty(STDIN_FILENO) == 1 && ::tcgetpgrp(STDIN_FILENO) == ::getpgrp();
}

std::vector<std::string> Keyboard::lines(std::chrono::milliseconds wait) {
  std::vector<std::string> result;
  if (ended_) {
    std::this_thread::sleep_for(wait);
    return result;
  }
  read_waiting(wait);
  std::size_t start = 0;
  for (auto end = typed_.find('\n'); end != std::string::npos; end = typed_.find('\n', start)) {
    result.push_back(typed_.substr(start, end - start));
    start = end + 1;
  }
  typed_.erase(0, start);
  if (ended_ && !typed_.empty()) {
    result.push_back(typed_);
    typed_.clear();
  }
  return result;
}

/// A terminal gives one line per read() and stores 4 KB: while it is full, it handles no further
/// key, not even Ctrl-C.
void Keyboard::read_waiting(std::chrono::milliseconds wait) {
  const std::size_t limit = typed_.size() + max_read;
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  int timeout = static_cast<int>(wait.count());
  while (!ended_ && typed_.size() < limit && ::poll(&watched, 1, timeout) > 0) {
    read();
    timeout = 0;
  }
}

void Keyboard::read() {
  std::array<char, 4096> text{};
  const ssize_t count = ::read(STDIN_FILENO, text.data(), text.size());
  if (count > 0)
    typed_.append(text.data(), static_cast<std::size_t>(count));
  else
    ended_ = count == 0 || errno != EINTR;
}

}  // namespace lamplock::cli
