#include "host/pendant/key_map.hpp"

#include <array>

namespace lamplock::pendant {
namespace {

struct KeyDefault {
  Key key;
  Action action;
};
constexpr std::array key_defaults{KeyDefault{Key::stop, Action::stop},
                                  KeyDefault{Key::reset, Action::reset},
                                  KeyDefault{Key::start, Action::start_pause},
                                  KeyDefault{Key::home, Action::home},
                                  KeyDefault{Key::zero, Action::zero},
                                  KeyDefault{Key::zero_x, Action::zero_x},
                                  KeyDefault{Key::zero_y, Action::zero_y},
                                  KeyDefault{Key::zero_z, Action::zero_z},
                                  KeyDefault{Key::go_to_zero, Action::go_to_zero},
                                  KeyDefault{Key::safe_z, Action::safe_z},
                                  KeyDefault{Key::step, Action::mode_step},
                                  KeyDefault{Key::mode, Action::next_mode},
                                  KeyDefault{Key::continuous, Action::mode_continuous},
                                  KeyDefault{Key::feed_plus, Action::feed_plus},
                                  KeyDefault{Key::feed_minus, Action::feed_minus},
                                  KeyDefault{Key::power_plus, Action::power_plus},
                                  KeyDefault{Key::power_minus, Action::power_minus},
                                  KeyDefault{Key::button_1, Action::axis_x},
                                  KeyDefault{key_of_row(Key::button_1, 2), Action::axis_y},
                                  KeyDefault{key_of_row(Key::button_1, 3), Action::axis_z},
                                  KeyDefault{key_of_row(Key::button_1, 4), Action::next_step},
                                  KeyDefault{key_of_row(Key::button_1, 5), Action::stop}};

struct KeyboardDefault {
  const char* name;
  Action action;
};
constexpr std::array keyboard_defaults{KeyboardDefault{"left", Action::jog_x_minus},
                                       KeyboardDefault{"right", Action::jog_x_plus},
                                       KeyboardDefault{"down", Action::jog_y_minus},
                                       KeyboardDefault{"up", Action::jog_y_plus},
                                       KeyboardDefault{"page-down", Action::jog_z_minus},
                                       KeyboardDefault{"page-up", Action::jog_z_plus},
                                       KeyboardDefault{",", Action::jog_a_minus},
                                       KeyboardDefault{".", Action::jog_a_plus},
                                       KeyboardDefault{"+", Action::greater_step},
                                       KeyboardDefault{"-", Action::smaller_step},
                                       KeyboardDefault{"m", Action::next_mode},
                                       KeyboardDefault{"x", Action::axis_x},
                                       KeyboardDefault{"y", Action::axis_y},
                                       KeyboardDefault{"z", Action::axis_z},
                                       KeyboardDefault{"a", Action::axis_a},
                                       KeyboardDefault{"0", Action::zero},
                                       KeyboardDefault{"g", Action::go_to_zero},
                                       KeyboardDefault{"h", Action::home},
                                       KeyboardDefault{"u", Action::unlock},
                                       KeyboardDefault{"!", Action::hold},
                                       KeyboardDefault{"~", Action::start},
                                       KeyboardDefault{"ctrl-x", Action::reset},
                                       KeyboardDefault{"space", Action::stop},
                                       KeyboardDefault{"escape", Action::stop},
                                       KeyboardDefault{"q", Action::quit},
                                       KeyboardDefault{"ctrl-c", Action::quit},
                                       KeyboardDefault{"ctrl-d", Action::quit}};

}  // namespace

KeyMap default_key_map() {
  KeyMap map;
  for (const KeyDefault& bound : key_defaults) map.keys[bound.key] = {bound.action, {}};
  for (const KeyboardDefault& bound : keyboard_defaults)
    map.keyboard[bound.name] = {bound.action, {}};
  return map;
}

}  // namespace lamplock::pendant
