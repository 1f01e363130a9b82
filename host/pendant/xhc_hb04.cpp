#include "host/pendant/xhc_hb04.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamplock::pendant {
namespace {

constexpr std::size_t hb04_report_size = 6;
constexpr std::uint8_t hb04_report_id = 4;
/// The day of the month in the manufacturer's program; LinuxCNC sends this value.
constexpr std::uint8_t seed = 0x0c;

constexpr std::uint8_t stop_code = 0x16, reset_code = 0x17;  ///< the model with 16 keys has no 0x16
constexpr int few_keys = 16, many_keys = 18;

constexpr Key macro(int number) { return key_of_row(Key::macro_1, number); }
using Layout = std::array<Key, 0x11>;  ///< by code
/// xhc-hb04-layout1.cfg
constexpr Layout layout_16{Key::none,    Key::stop,   Key::start,      Key::rewind, Key::safe_z,
                           Key::home,    Key::half_x, Key::half_y,     Key::probe,  Key::zero_x,
                           Key::zero_y,  Key::zero_z, Key::go_to_zero, Key::step,   Key::mode,
                           Key::spindle, Key::none};
/// xhc-hb04-layout2.cfg
constexpr Layout layout_18{Key::none, Key::go_to_zero, Key::start,   Key::rewind, Key::probe,
                           macro(3),  Key::half,       Key::zero,    Key::safe_z, Key::home,
                           macro(1),  macro(2),        Key::spindle, Key::step,   Key::mode,
                           macro(6),  macro(7)};

/// Unknown codes count as off.
Selector selector_of(std::uint8_t code) {
  switch (code) {
    case 0x11:
      return Selector::x;
    case 0x12:
      return Selector::y;
    case 0x13:
      return Selector::z;
    case 0x18:
      return Selector::a;
    case 0x14:
      return Selector::power;
    case 0x15:
      return Selector::feed;
    default:
      return Selector::off;
  }
}

/// Display code of a step; 0 for steps that the display cannot show.
std::uint8_t step_symbol(double step_mm) {
  constexpr std::array thousandths{0l, 1l, 5l, 10l, 20l, 30l, 40l, 50l, 100l, 500l, 1000l};
  const auto found = std::find(thousandths.begin(), thousandths.end(), std::lround(step_mm * 1000));
  return found == thousandths.end() ? std::uint8_t{0}
                                    : static_cast<std::uint8_t>(found - thousandths.begin());
}

}  // namespace

Events XhcHb04::take(std::span<const std::uint8_t> report) {
  Events events;
  if (report.size() != hb04_report_size || report[0] != hb04_report_id) return events;
  if (std::all_of(report.begin() + 1, report.end(), [](auto byte) { return byte == 0; })) {
    fall_asleep(events);
    return events;
  }
  if (asleep_) events.push_back(plain_event(Event::Kind::awake));
  asleep_ = false;
  if (const Selector at = selector_of(report[3]); at != selector_) {
    selector_ = at;
    events.push_back(selector_event(at));
  }
  const auto codes = report.subspan(1, 2);
  if (key_count_ == 0 && std::find(codes.begin(), codes.end(), stop_code) != codes.end())
    key_count_ = many_keys;
  keys_.take(
      codes, [this](std::uint8_t code) { return key_of(code); }, events);
  const auto clicks = static_cast<std::int8_t>(report[4]);
  if (clicks != 0) events.push_back(count_event(Event::Kind::wheel, clicks));
  return events;
}

void XhcHb04::fall_asleep(Events& events) {
  if (asleep_) return;
  asleep_ = true;
  keys_.release(events);
  selector_ = Selector::off;
  events.push_back(selector_event(selector_));
  events.push_back(plain_event(Event::Kind::asleep));
}

Key XhcHb04::key_of(std::uint8_t code) const {
  if (code == stop_code) return Key::stop;
  if (code == reset_code) return Key::reset;
  if (code >= layout_18.size()) return Key::none;
  if (key_count_ == few_keys) return layout_16[code];
  if (key_count_ == many_keys || layout_16[code] == layout_18[code]) return layout_18[code];
  return layout_16[code] == Key::stop ? Key::stop : Key::ambiguous;
}

std::vector<FeatureReport> XhcHb04::display(const Display& shown) const {
  XhcFrame frame(seed);
  // Three lines for work and for machine coordinates: A uses the line of X.
  const std::size_t first = shown.selector == Selector::a ? 3 : 0;
  for (const PerAxis<double>* place : {&shown.work_mm, &shown.machine_mm})
    for (const std::size_t axis : {first, std::size_t{1}, std::size_t{2}})
      frame.number((*place)[axis]);
  frame.word(shown.feed_percent);
  frame.word(shown.power_percent);
  frame.word(shown.feed_mm_min);
  frame.word(shown.power);
  frame.byte(step_symbol(shown.step_mm));
  frame.byte(0);  // flags: 0x80 would be inches
  return frame.reports();
}

}  // namespace lamplock::pendant
