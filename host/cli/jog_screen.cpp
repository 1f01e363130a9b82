#include "host/cli/jog_screen.hpp"

#include "host/cli/console.hpp"
#include "host/cli/keyboard.hpp"
#include "host/cli/raw_terminal.hpp"
#include "host/printable.hpp"
#include "shared/units.hpp"

#include <algorithm>
#include <array>

namespace lamplock::cli {
namespace {

using pendant::Mode;

constexpr int max_decimals = 3;  ///< of a position in mm
constexpr std::array selector_names{"no axis", "X", "Y", "Z", "A", "B", "C", "feed", "power"};

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

const char* selector_name(const pendant::Display& display) {
  return selector_names[static_cast<std::size_t>(display.selector)];
}

std::string position_text(const pendant::Display& display, std::size_t axes, int decimals) {
  std::string text;
  for (std::size_t a = 0; a < axes; ++a)
    text += fmt::format("{}{} {:.{}f}", a == 0 ? "" : "  ", axis_letters[a], display.work_mm[a],
                        decimals);
  return text;
}

/// Position and state in so many columns. If they are few, decimal places are left out, then axes
/// from the last one on, then the state; the digits of X stay whole.
std::string position_and_state(const pendant::Display& display, const link::BoardStatus& status,
                               std::size_t columns) {
  const std::string state = "  | " + printable(status.state);
  const std::size_t axes = std::min(status.position.size(), axis_letters.size());
  for (std::size_t shown = axes; shown > 0; --shown)
    for (int decimals = max_decimals; decimals > 0; --decimals)
      if (const std::string line = position_text(display, shown, decimals) + state;
          line.size() <= columns)
        return line;
  for (int decimals = max_decimals; decimals >= 0; --decimals)
    if (const std::string line = position_text(display, std::min<std::size_t>(axes, 1), decimals);
        line.size() <= columns)
      return line;
  return printable(status.state).substr(0, columns);
}

}  // namespace

std::string jog_line(const pendant::Display& display, const link::BoardStatus& status,
                     std::size_t columns) {
  if (status.state.empty()) return "";
  const std::array last_fields{" | " + mode_text(display),
                               fmt::format(" | {}", selector_name(display)),
                               fmt::format(" | feed {} %", display.feed_percent)};
  std::string line = position_and_state(display, status, columns);
  for (const std::string& field : last_fields) {
    if (line.size() + field.size() > columns) break;
    line += field;
  }
  return line;
}

JogScreen::JogScreen(Console& console) : console_(console) {
  if (!console.json() && LiveLine::can_show(stdout))
    line_.emplace(stdout,
                  [this](std::size_t columns) { return jog_line(display_, status_, columns); });
}

JogScreen::~JogScreen() {
  if (line_ && !status_.state.empty()) line_->keep();
}

void JogScreen::show(const pendant::Jogger& jogger) {
  const link::BoardStatus& status = jogger.machine().status;
  if (status.state.empty()) return;
  display_ = jogger.display();
  status_ = status;
  if (line_) return line_->refresh();
  if (status.state == state_) return;
  state_ = status.state;
  console_.line(jog_line(display_, status, std::string::npos));
}

void JogScreen::note(const std::string& text) {
  if (line_) return line_->note(printable(text));
  console_.line(text);
}

bool JogScreen::has_keyboard() const { return Keyboard::at_terminal(); }

std::unique_ptr<run::JogKeys> JogScreen::open_keys() { return std::make_unique<RawTerminal>(); }

}  // namespace lamplock::cli
