// Actions of the keys of pendants and of the keyboard.
//
// In:  nothing, or a profile (read_key_map.hpp). Out: actions by key, macros, steps, feed.
// Who: `lamplock jog`.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/pendant/action.hpp"
#include "host/pendant/event.hpp"
#include "host/pendant/macro.hpp"

namespace lamplock::pendant {

/// An action, or the number of a macro.
struct Binding {
  Action action = Action::none;
  std::optional<std::size_t> macro{};

  bool operator==(const Binding&) const = default;
};

struct KeyMap {
  std::map<Key, Binding> keys;              ///< of pendants
  std::map<std::string, Binding> keyboard;  ///< by keyboard_names(), or a character
  std::vector<Macro> macros;
  std::vector<double> steps_mm{0.001, 0.01, 0.1, 1};  ///< ascending
  double feed_mm_min = 3000;                          ///< of jogs
  std::optional<double> safe_z_mm;                    ///< machine coordinate
  int hb04_keys = 0;                                  ///< 16 or 18; 0: unknown
};

/// Keys have the function of their print; spindle and macro keys have none.
KeyMap default_key_map();

}  // namespace lamplock::pendant
