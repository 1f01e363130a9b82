#include "host/pendant/xhc_whb04b.hpp"

#include <algorithm>
#include <array>

namespace lamplock::pendant {
namespace {

constexpr std::size_t whb04b_report_size = 8;
constexpr std::uint8_t whb04b_report_id = 4;
constexpr std::uint8_t whb04b_seed = 0xfe;
constexpr std::uint8_t function_code = 0x0c;

/// Functions of a key, without and with Fn. Stop and reset are the same with Fn.
struct KeyPrint {
  Key plain, with_function;
};
constexpr Key whb04b_macro(int number) { return key_of_row(Key::macro_1, number); }
constexpr std::array key_prints{KeyPrint{Key::none, Key::none},
                                KeyPrint{Key::reset, Key::reset},  // 01
                                KeyPrint{Key::stop, Key::stop},
                                KeyPrint{Key::start, whb04b_macro(13)},
                                KeyPrint{Key::feed_plus, whb04b_macro(1)},  // 04
                                KeyPrint{Key::feed_minus, whb04b_macro(2)},
                                KeyPrint{Key::power_plus, whb04b_macro(3)},
                                KeyPrint{Key::power_minus, whb04b_macro(4)},
                                KeyPrint{Key::home, whb04b_macro(5)},  // 08
                                KeyPrint{Key::safe_z, whb04b_macro(6)},
                                KeyPrint{Key::go_to_zero, whb04b_macro(7)},
                                KeyPrint{Key::spindle, whb04b_macro(8)},
                                KeyPrint{Key::none, Key::none},  // 0c: Fn
                                KeyPrint{Key::probe, whb04b_macro(9)},
                                KeyPrint{Key::continuous, whb04b_macro(15)},
                                KeyPrint{Key::step, whb04b_macro(16)},
                                KeyPrint{whb04b_macro(10), whb04b_macro(14)}};  // 10

Selector whb04b_selector(std::uint8_t code) {
  constexpr std::uint8_t first = 0x11;
  constexpr std::array axes{Selector::x, Selector::y, Selector::z,
                            Selector::a, Selector::b, Selector::c};
  const auto place = static_cast<std::size_t>(code - first);
  return code >= first && place < axes.size() ? axes[place] : Selector::off;
}

/// An unknown switch position has no step: the wheel moves no axis then.
Rate rate_of(std::uint8_t code) {
  switch (code) {
    case 0x0d:
      return {0.001, 2};
    case 0x0e:
      return {0.01, 5};
    case 0x0f:
      return {0.1, 10};
    case 0x10:
      return {1, 30};
    // The next two positions have no step in their print; the display shows 1.
    case 0x1a:
      return {1, 60};
    case 0x1b:
      return {1, 100};
    case 0x1c:
    case 0x9b:
      return {0, 0, true};
    default:
      return {};
  }
}

/// Flags of the display, as LinuxCNC names them.
std::uint8_t display_flags(const Display& shown) {
  constexpr std::uint8_t continuous = 0, step = 1, wheel_is_feed = 2;
  constexpr std::uint8_t reset = 0x40, work_place = 0x80;
  const std::uint8_t mode = shown.mode == Mode::step         ? step
                            : shown.mode == Mode::continuous ? continuous
                                                             : wheel_is_feed;
  return static_cast<std::uint8_t>(mode | work_place | (shown.alarm ? reset : 0));
}

}  // namespace

Events XhcWhb04b::take(std::span<const std::uint8_t> report) {
  Events events;
  if (report.size() != whb04b_report_size || report[0] != whb04b_report_id) return events;
  if (drop_next_) {
    drop_next_ = false;
    return events;
  }
  if (std::all_of(report.begin() + 2, report.end() - 1, [](auto byte) { return byte == 0; })) {
    drop_next_ = true;
    fall_asleep(events);
    return events;
  }
  if (asleep_) events.push_back(plain_event(Event::Kind::awake));
  asleep_ = false;
  take_switches(report, events);
  const auto codes = report.subspan(2, 2);
  const bool function = std::find(codes.begin(), codes.end(), function_code) != codes.end();
  const auto key_of = [function](std::uint8_t code) {
    if (code >= key_prints.size()) return Key::none;
    return function ? key_prints[code].with_function : key_prints[code].plain;
  };
  keys_.take(codes, key_of, events);
  const auto clicks = static_cast<std::int8_t>(report[6]);
  if (clicks != 0) events.push_back(count_event(Event::Kind::wheel, clicks));
  return events;
}

void XhcWhb04b::take_switches(std::span<const std::uint8_t> report, Events& events) {
  if (const Rate rate = rate_of(report[4]); rate != rate_) {
    rate_ = rate;
    events.push_back(rate_event(rate));
  }
  if (const Selector at = whb04b_selector(report[5]); at != selector_) {
    selector_ = at;
    events.push_back(selector_event(at));
  }
}

void XhcWhb04b::fall_asleep(Events& events) {
  if (asleep_) return;
  asleep_ = true;
  keys_.release(events);
  selector_ = Selector::off;
  rate_.reset();
  events.push_back(selector_event(selector_));
  events.push_back(plain_event(Event::Kind::asleep));
}

std::vector<FeatureReport> XhcWhb04b::display(const Display& shown) const {
  XhcFrame frame(whb04b_seed);
  frame.byte(display_flags(shown));
  // Three lines: X Y Z, or A B C, of which the machine has A only.
  const bool second = shown.selector == Selector::a || shown.selector == Selector::b ||
                      shown.selector == Selector::c;
  for (std::size_t line = 0; line < 3; ++line) {
    const std::size_t axis = line + (second ? 3 : 0);
    frame.number(axis < shown.work_mm.size() ? shown.work_mm[axis] : 0);
  }
  frame.word(shown.feed_mm_min);
  frame.word(shown.power);
  return frame.reports();
}

}  // namespace lamplock::pendant
