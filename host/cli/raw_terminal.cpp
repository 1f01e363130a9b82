#include "host/cli/raw_terminal.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>

namespace lamplock::cli {
namespace {

termios raw_modes_before{};
std::atomic<bool> is_raw{false};  ///< raw_modes_before is valid
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

RawTerminal::RawTerminal() {
  termios settings{};
  if (::tcgetattr(STDIN_FILENO, &settings) != 0) return;
  raw_modes_before = settings;
  is_raw = true;
  settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG | IEXTEN);
  // Ctrl-S would stop what is shown; Enter stays what it is.
  settings.c_iflag &= ~static_cast<tcflag_t>(IXON | ICRNL);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ::tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

RawTerminal::~RawTerminal() {
  leave();
  is_raw = false;
}

void RawTerminal::leave() noexcept {
  if (is_raw) ::tcsetattr(STDIN_FILENO, TCSANOW, &raw_modes_before);
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
