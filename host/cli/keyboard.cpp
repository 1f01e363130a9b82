#include "host/cli/keyboard.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <thread>
#include <utility>

namespace lamplock::cli {
namespace {

/// Limit of one call in bytes: an input that never pauses must not stop the caller's own work.
constexpr std::size_t max_read = 65536;

/// Users type Enter after `!` within this time, before they have read that the machine is held.
constexpr std::chrono::seconds enter_time{1};
/// The rest of a key's sequence arrives within this time.
constexpr std::chrono::milliseconds max_escape_time{200};

constexpr char hold_key = '!';
constexpr char end_of_input = 4, backspace = 8, erase_line = 21, escape_key = 27;
constexpr char delete_key = 127;  ///< what most keyboards send for Backspace

/// Further bytes of one character in UTF-8.
bool is_continuation(unsigned char byte) { return (byte & 0xC0u) == 0x80u; }

}  // namespace

bool KeyLine::take(char key, std::vector<std::string>& lines, Clock::time_point now) {
  const bool is_after_hold = held_at_ && now - *held_at_ < enter_time;
  held_at_.reset();
  if (take_escape(key, now)) return true;
  if (key == hold_key) {
    text_.clear();
    held_at_ = now;
    lines.emplace_back(1, hold_key);
  } else if (key == '\n' || key == '\r') {
    lines.push_back(is_after_hold ? std::string(1, hold_key) : std::exchange(text_, {}));
  } else if (key == end_of_input) {
    return !text_.empty();
  } else if (key == erase_line) {
    text_.clear();
  } else if (key == backspace || key == delete_key) {
    text_.resize(text_.empty() ? 0 : text_.size() - 1);
  } else if (const auto byte = static_cast<unsigned char>(key);
             byte >= ' ' && !is_continuation(byte)) {
    text_ += byte < delete_key ? key : '?';
  }
  return true;
}

/// Keys like the arrows send ESC [ and more, up to a letter or `~` (ECMA-48: CSI), or ESC O and a
/// letter. A hold is never part of a sequence that has only begun.
bool KeyLine::take_escape(char key, Clock::time_point now) {
  if (key == escape_key) {
    escape_ = Escape::begun;
    escape_at_ = now;
    return true;
  }
  if (now - escape_at_ >= max_escape_time || (escape_ == Escape::begun && key == hold_key))
    escape_ = Escape::none;
  if (escape_ == Escape::none) return false;
  if (escape_ == Escape::begun)
    escape_ = key == '[' || key == 'O' ? Escape::inside : Escape::none;
  else if (key >= '@' && key <= '~')
    escape_ = Escape::none;
  return true;
}

Keyboard::Keyboard(Beside beside) {
  if (beside == Beside::progress && at_terminal()) quiet_.emplace(QuietTerminal::Reads::keys);
}

bool Keyboard::at_terminal() { return QuietTerminal::in_foreground(STDIN_FILENO); }

std::vector<std::string> Keyboard::lines(std::chrono::milliseconds wait) {
  if (ended())
    std::this_thread::sleep_for(wait);
  else
    read_waiting(wait);
  return quiet_ && QuietTerminal::reads_keys() ? take_keys() : take_lines();
}

std::vector<std::string> Keyboard::take_keys() {
  std::vector<std::string> result;
  for (const char key : std::exchange(typed_, {}))
    if (!keys_.take(key, result)) ended_ = true;
  return result;
}

std::vector<std::string> Keyboard::take_lines() {
  std::vector<std::string> result;
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
