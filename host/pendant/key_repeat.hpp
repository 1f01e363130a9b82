// Detects a held key of a terminal, which reports presses and repeats only, not releases.
//
// In:  presses with their time. Out: held or not, and the time until which that is valid.
// Who: the jogger. Two presses of a key within 150 ms are a key that repeats: the slowest consoles
//      repeat at 10.9 Hz, desktops at 25 to 33 Hz, fingers at 5 to 7 Hz. A key counts as released
//      after two and a half intervals without another press, 100 ms at least.
#pragma once

#include <string>

#include "host/pendant/board_dialog.hpp"

namespace lamplock::pendant {

class KeyRepeat {
 public:
  struct Press {
    bool held = false;
    Time until{};  ///< while held: latest time of the next press
  };
  Press press(const std::string& key, Time now);

 private:
  std::string key_;
  Time at_{}, interval_{};
};

}  // namespace lamplock::pendant
