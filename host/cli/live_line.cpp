#include "host/cli/live_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "host/cli/quiet_terminal.hpp"
#include "host/cli/standard_streams.hpp"
#include "host/cli/wrapped_text.hpp"
#include "host/remark.hpp"

namespace lamplock::cli {
namespace {

constexpr std::size_t usual_columns = 80;
/// To the first column, and clear from there to the end of the screen (ECMA-48: CR, ED).
constexpr const char* clear_below = "\r\033[J";
/// Automatic wrapping off and on (DECAWM).
constexpr const char* wrap_off = "\033[?7l";
constexpr const char* wrap_on = "\033[?7h";

LiveLine* shown_line = nullptr;

/// One call, so that the terminal shows no half of it.
void write_terminal(std::FILE* out, const std::string& bytes) noexcept {
  std::fwrite(bytes.data(), 1, bytes.size(), out);
  std::fflush(out);
}

}  // namespace

std::size_t columns_of(std::FILE* terminal) {
  winsize size{};
  if (::ioctl(::fileno(terminal), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return usual_columns;
  return size.ws_col;
}

LiveLine::LiveLine(std::FILE* out, Text text, std::function<Clock::time_point()> now)
    : out_(out),
      text_(std::move(text)),
      now_(std::move(now)),
      drawn_at_(now_()),
      below_(shown_line) {
  if (below_ != nullptr) below_->clear();
  shown_line = this;
}

LiveLine::~LiveLine() {
  clear();
  if (!waiting_.empty()) write_terminal(out_, take_waiting());
  if (shown_line == this) shown_line = below_;
}

bool LiveLine::can_show(std::FILE* out) {
  const char* const kind = std::getenv("TERM");
  if (kind != nullptr && std::string_view(kind) == "dumb") return false;
  return QuietTerminal::in_foreground(::fileno(out));
}

void LiveLine::refresh() {
  if (shown_line == this && is_due()) draw();
}

void LiveLine::note(const std::string& line) {
  waiting_ += wrapped_for(out_, line) + '\n';
  refresh();
}

void LiveLine::keep() {
  draw();
  if (drawn_) write_terminal(out_, "\n");
  drawn_ = false;
}

void LiveLine::print(std::FILE* out, const std::string& text) {
  if (shown_line != nullptr && ::isatty(::fileno(out)) == 1) {
    shown_line->waiting_ += text;
    return shown_line->refresh();
  }
  write_text(out, text);
}

bool LiveLine::is_due() const { return now_() - drawn_at_ >= redraw_interval; }

/// A terminal that is stopped (Ctrl-S) is drawn later, because a job must not wait for it.
/// In the background another program owns the terminal: no line, and no modes of its input.
void LiveLine::draw() {
  drawn_at_ = now_();
  if (!takes_text(out_)) return;
  QuietTerminal::refresh();
  if (!QuietTerminal::in_foreground(::fileno(out_))) {
    drawn_ = false;
    if (!waiting_.empty()) write_terminal(out_, take_waiting());
    return;
  }
  const std::size_t columns = columns_of(out_);
  // A character in the last column would leave some terminals between two rows.
  const std::string text = text_(columns - 1).substr(0, columns - 1);
  write_terminal(out_, clear_below + take_waiting() + wrap_off + text + '\r' + wrap_on);
  drawn_ = true;
}

void LiveLine::clear() noexcept {
  if (!drawn_) return;
  write_terminal(out_, clear_below);
  drawn_ = false;
}

std::string LiveLine::take_waiting() { return std::exchange(waiting_, {}); }

}  // namespace lamplock::cli
