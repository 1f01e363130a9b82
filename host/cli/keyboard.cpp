#include "host/cli/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <thread>

namespace lamplock::cli {

bool Keyboard::at_terminal() {
  return ::isatty(STDIN_FILENO) == 1 && ::tcgetpgrp(STDIN_FILENO) == ::getpgrp();
}

std::vector<std::string> Keyboard::lines(std::chrono::milliseconds wait) {
  std::vector<std::string> result;
  if (ended_) {
    std::this_thread::sleep_for(wait);
    return result;
  }
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  if (::poll(&watched, 1, static_cast<int>(wait.count())) <= 0) return result;
  read();
  for (auto end = typed_.find('\n'); end != std::string::npos; end = typed_.find('\n')) {
    result.push_back(typed_.substr(0, end));
    typed_.erase(0, end + 1);
  }
  if (ended_ && !typed_.empty()) {
    result.push_back(typed_);
    typed_.clear();
  }
  return result;
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
