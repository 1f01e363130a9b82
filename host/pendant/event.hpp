// User actions at a pendant of any model: keys, the axis switch, the wheel.
//
// Out: the event types of all decoders, and the names of the keys.
// Who: decoders of pendants make events, the jogger acts on them, the key map names keys.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace lamplock::pendant {

/// A key by its print. Keys without print are buttons.
enum class Key : std::uint8_t {
  none,
  ambiguous,  ///< one of several, depending on the model
  stop,
  reset,
  start,
  home,
  zero,
  zero_x,
  zero_y,
  zero_z,
  go_to_zero,
  safe_z,
  half,
  half_x,
  half_y,
  rewind,
  probe,
  spindle,
  step,
  mode,
  continuous,
  feed_plus,
  feed_minus,
  power_plus,
  power_minus,
  macro_1,
  macro_16 = macro_1 + 15,
  button_1,
  button_15 = button_1 + 14,
  count
};

/// The name in a key map: "go-to-zero", "macro-3", "button-12".
std::string_view key_name(Key key);
/// Empty if there is no such key.
std::optional<Key> key_named(std::string_view name);
/// The `number`th key of a row that begins with `first`, from 1: macro_1, button_1.
constexpr Key key_of_row(Key first, int number) {
  return static_cast<Key>(static_cast<int>(first) + number - 1);
}

/// Position of the axis switch; at feed and power the wheel is a knob for overrides.
enum class Selector : std::uint8_t { off, x, y, z, a, b, c, feed, power };

/// Position of the switch of steps and speeds: its values in both modes.
struct Rate {
  double step_mm = 0;  ///< 0: none, the wheel must not move an axis
  int percent = 0;     ///< of the feed; 0: none
  bool lead = false;   ///< its last position, where the wheel is a knob for the feed override

  bool operator==(const Rate&) const = default;
};

/// One event.
struct Event {
  enum class Kind : std::uint8_t {
    key_down,  ///< `key`
    key_up,    ///< `key`
    selector,  ///< `selector`: its new position
    rate,      ///< `rate`: its new position
    wheel,     ///< `count` clicks, clockwise positive
    spring,    ///< `count`: -7..7, new position of the spring ring; 0 = released
    asleep,    ///< the pendant has switched itself off
    awake      ///< the pendant has switched itself on again
  };
  Kind kind{};
  Key key = Key::none;
  Selector selector = Selector::off;
  Rate rate{};
  int count = 0;

  bool operator==(const Event&) const = default;
};

using Events = std::vector<Event>;

inline Event key_event(Event::Kind kind, Key key) { return {kind, key, {}, {}, 0}; }
inline Event count_event(Event::Kind kind, int count) { return {kind, {}, {}, {}, count}; }
inline Event selector_event(Selector at) { return {Event::Kind::selector, {}, at, {}, 0}; }
inline Event rate_event(const Rate& rate) { return {Event::Kind::rate, {}, {}, rate, 0}; }
inline Event plain_event(Event::Kind kind) { return {kind, {}, {}, {}, 0}; }

}  // namespace lamplock::pendant
