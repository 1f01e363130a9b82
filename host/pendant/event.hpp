// What somebody does at a pendant, whichever it is: keys, the switch of axes, the wheel.
//
// In:  nothing. Out: types that all decoders speak, and the names of the keys.
// Who: decoders of pendants make events, the jogger acts on them, the key map names keys.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace lamplock::pendant {

/// A key by what is printed on it. Pendants without print have buttons.
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

/// As a key map calls it: "go-to-zero", "macro-3", "button-12".
std::string_view key_name(Key key);
/// Nothing if there is no such key.
std::optional<Key> key_named(std::string_view name);
/// The `number`th key of a row that begins with `first`, from 1: macro_1, button_1.
constexpr Key key_of_row(Key first, int number) {
  return static_cast<Key>(static_cast<int>(first) + number - 1);
}

/// Where the switch of axes stands; feed and power turn the wheel into a knob for overrides.
enum class Selector : std::uint8_t { off, x, y, z, a, b, c, feed, power };

/// The switch of steps and speeds: what it says in both modes.
struct Rate {
  double step_mm = 0;  ///< 0: none, the wheel must not move anything
  int percent = 0;     ///< of the feed; 0: none
  bool lead = false;   ///< its last place, where the wheel is a knob for the feed override

  bool operator==(const Rate&) const = default;
};

/// One thing that has happened.
struct Event {
  enum class Kind : std::uint8_t {
    key_down,  ///< `key`
    key_up,    ///< `key`
    selector,  ///< `selector`: where it stands now
    rate,      ///< `rate`: where its switch stands now
    wheel,     ///< `count` clicks, clockwise positive
    spring,    ///< `count`: -7..7, how far the ring is turned; 0 let go
    asleep,    ///< the pendant has switched itself off
    awake      ///< it is back
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
