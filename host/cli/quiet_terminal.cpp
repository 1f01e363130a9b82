#include "host/cli/quiet_terminal.hpp"

#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <string_view>

namespace lamplock::cli {
namespace {

int quiet_count = 0, key_count = 0;
termios modes_before{};
std::atomic<bool> modes_changed{false};  ///< modes_before is valid
static_assert(std::atomic<bool>::is_always_lock_free);

termios quiet_modes() {
  termios modes = modes_before;
  modes.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL);
  if (key_count == 0) return modes;
  modes.c_lflag &= ~static_cast<tcflag_t>(ICANON);
  modes.c_cc[VMIN] = 1;
  modes.c_cc[VTIME] = 0;
  return modes;
}

void apply_modes() {
  if (!QuietTerminal::in_foreground(STDIN_FILENO)) return;
  if (!modes_changed) {
    if (::tcgetattr(STDIN_FILENO, &modes_before) != 0) return;
    modes_changed = true;
  }
  const termios modes = quiet_modes();
  ::tcsetattr(STDIN_FILENO, TCSANOW, &modes);
}

}  // namespace

QuietTerminal::QuietTerminal(Reads reads) : reads_(reads) {
  ++quiet_count;
  if (reads_ == Reads::keys) ++key_count;
  apply_modes();
}

QuietTerminal::~QuietTerminal() {
  --quiet_count;
  if (reads_ == Reads::keys) --key_count;
  if (quiet_count > 0) {
    apply_modes();
  } else {
    restore();
    modes_changed = false;
  }
}

bool QuietTerminal::reads_keys() { return modes_changed && key_count > 0; }

void QuietTerminal::refresh() {
  termios present{};
  if (quiet_count == 0 || !in_foreground(STDIN_FILENO)) return;
  if (::tcgetattr(STDIN_FILENO, &present) != 0) return;
  if ((present.c_lflag & static_cast<tcflag_t>(ECHO)) != 0) apply_modes();
}

void QuietTerminal::restore() noexcept {
  if (modes_changed && in_foreground(STDIN_FILENO))
    ::tcsetattr(STDIN_FILENO, TCSANOW, &modes_before);
}

void QuietTerminal::leave() noexcept {
  if (!modes_changed || !in_foreground(STDIN_FILENO)) return;
  // To the first column, and clear from there (ECMA-48: CR, ED).
  constexpr std::string_view clear_below = "\r\033[J";
  [[maybe_unused]] const ssize_t written =
      ::write(STDIN_FILENO, clear_below.data(), clear_below.size());
  restore();
}

bool QuietTerminal::in_foreground(int descriptor) {
  if (::isatty(descriptor) != 1) return false;
  // A terminal that does not control this program has no background for it: -1.
  const pid_t group = ::tcgetpgrp(descriptor);
  return group < 0 || group == ::getpgrp();
}

}  // namespace lamplock::cli
