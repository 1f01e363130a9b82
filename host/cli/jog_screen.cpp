#include "host/cli/jog_screen.hpp"

#include "host/cli/console.hpp"
#include "host/cli/keyboard.hpp"
#include "host/cli/raw_terminal.hpp"
#include "shared/units.hpp"

#include <unistd.h>

#include <array>

namespace lamplock::cli {
namespace {

using namespace std::chrono_literals;
using pendant::Mode;

constexpr auto draw_interval = 50ms;
constexpr std::array selector_names{"no axis", "X", "Y", "Z", "A", "B", "C", "feed", "power"};
/// To the left edge, and clear (ECMA-48: EL).
constexpr const char* clear_line = "\r\x1b[K";

std::string mode_text(const pendant::Display& display) {
  switch (display.mode) {
    case Mode::step:
      return fmt::format("step {:g} mm", display.step_mm);
    case Mode::continuous:
      return "continuous";
    case Mode::feed:
      return "wheel is feed";
  }
  return "";
}

}  // namespace

std::string jog_line(const pendant::Display& display, const link::BoardStatus& status) {
  std::string line;
  const std::size_t axes = std::min(status.position.size(), axis_letters.size());
  for (std::size_t a = 0; a < axes; ++a)
    line += fmt::format("{} {:.3f}  ", axis_letters[a], display.work_mm[a]);
  return line + fmt::format("| {} | {} | {} | feed {} %", status.state, mode_text(display),
                            selector_names[static_cast<std::size_t>(display.selector)],
                            display.feed_percent);
}

JogScreen::JogScreen(Console& console)
    : console_(console), terminal_(!console.json() && ::isatty(STDOUT_FILENO) == 1) {}

JogScreen::~JogScreen() {
  if (terminal_ && !drawn_.empty()) console_.text("\n");
}

void JogScreen::show(const pendant::Jogger& jogger) {
  const link::BoardStatus& status = jogger.machine().status;
  if (status.state.empty()) return;
  if (!terminal_) {
    if (status.state == state_) return;
    state_ = status.state;
    return console_.line(jog_line(jogger.display(), status));
  }
  if (Clock::now() - drawn_at_ < draw_interval) return;
  drawn_at_ = Clock::now();
  const std::string line = jog_line(jogger.display(), status);
  if (line == drawn_) return;
  drawn_ = line;
  console_.text(clear_line + line);
}

void JogScreen::note(const std::string& text) {
  if (!terminal_) return console_.line(text);
  console_.text(fmt::format("{}{}\n{}", clear_line, text, drawn_));
}

bool JogScreen::has_keyboard() const { return Keyboard::at_terminal(); }

std::unique_ptr<run::JogKeys> JogScreen::open_keys() { return std::make_unique<RawTerminal>(); }

}  // namespace lamplock::cli
