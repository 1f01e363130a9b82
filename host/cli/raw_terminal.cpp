#include "host/cli/raw_terminal.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace lamplock::cli {

RawTerminal::RawTerminal() {
  termios settings{};
  if (::tcgetattr(STDIN_FILENO, &settings) != 0) return;
  before_ = settings;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG | IEXTEN);
  // Ctrl-S would stop what is shown; Enter stays what it is.
  settings.c_iflag &= ~static_cast<tcflag_t>(IXON | ICRNL);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

RawTerminal::~RawTerminal() {
  if (before_) ::tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

std::string RawTerminal::read() {
  pollfd watched{STDIN_FILENO, POLLIN, 0};
  if (ended_ || ::poll(&watched, 1, 0) <= 0) return "";
  std::array<char, 256> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count > 0) return {bytes.data(), static_cast<std::size_t>(count)};
  ended_ = count == 0 || (errno != EINTR && errno != EAGAIN);
  return "";
}

}  // namespace lamplock::cli
