// Whether a key of a terminal is held, though a terminal tells only that it was pressed again.
//
// In:  presses with their time. Out: held or not, and until when that is to be believed.
// Who: the jogger. Two presses of a key within 150 ms are a key that repeats: the slowest consoles
//      repeat at 10.9 Hz, desktops at 25 to 33 Hz, fingers at 5 to 7 Hz. It counts as let go when
//      two and a half of its intervals have passed without another one, 100 ms at least.
#pragma once

#include <string>

#include "host/pendant/board_talk.hpp"

namespace lamplock::pendant {

class KeyRepeat {
 public:
  struct Press {
    bool held = false;
    Time until{};  ///< while held: another press is to come by then
  };
  Press press(const std::string& key, Time now);

 private:
  std::string key_;
  Time at_{}, interval_{};
};

}  // namespace lamplock::pendant
