// Held keys of a pendant: converts the codes in each report to events for keys that go down and up.
//
// In:  the codes of a report; the present key of a code. Out: events.
// Who: decoders. A key that goes up is the one that went down, even if its code has another meaning
//      by then: Fn selects a second function.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "host/pendant/event.hpp"

namespace lamplock::pendant {

/// The keys of one pendant.
class HeldKeys {
 public:
  /// `codes`: of the report, 0 is none. `key_of(code)`: Key::none for codes that are no key.
  template <class KeyOf>
  void take(std::span<const std::uint8_t> codes, KeyOf&& key_of, Events& events) {
    const auto is_held = [codes](std::uint8_t code) {
      return std::find(codes.begin(), codes.end(), code) != codes.end();
    };
    std::erase_if(held_, [&](const Held& key) {
      if (is_held(key.code)) return false;
      events.push_back(key_event(Event::Kind::key_up, key.key));
      return true;
    });
    for (const std::uint8_t code : codes) {
      if (code == 0 || knows(code)) continue;
      const Key key = key_of(code);
      if (key == Key::none) continue;
      held_.push_back({code, key});
      events.push_back(key_event(Event::Kind::key_down, key));
    }
  }
  /// Releases all keys.
  void release(Events& events) {
    take(
        {}, [](std::uint8_t) { return Key::none; }, events);
  }

 private:
  struct Held {
    std::uint8_t code;
    Key key;
  };
  bool knows(std::uint8_t code) const {
    return std::any_of(held_.begin(), held_.end(),
                       [code](const Held& key) { return key.code == code; });
  }

  std::vector<Held> held_;
};

}  // namespace lamplock::pendant
