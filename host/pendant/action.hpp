// Actions of keys, by name.
//
// In:  names in a key map. Out: actions. Who: the key map, the jogger, the documentation's test.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace lamplock::pendant {

enum class Action : std::uint8_t {
  none,
  stop,
  reset,
  start,
  hold,
  start_pause,
  unlock,
  home,
  zero,
  zero_x,
  zero_y,
  zero_z,
  zero_a,
  zero_all,
  go_to_zero,
  safe_z,
  feed_full,
  feed_plus,
  feed_minus,
  power_full,
  power_plus,
  power_minus,
  next_step,
  greater_step,
  smaller_step,
  next_mode,
  mode_step,
  mode_continuous,
  mode_feed,
  next_axis,
  axis_x,
  axis_y,
  axis_z,
  axis_a,
  axis_off,
  jog_x_plus,
  jog_x_minus,
  jog_y_plus,
  jog_y_minus,
  jog_z_plus,
  jog_z_minus,
  jog_a_plus,
  jog_a_minus,
  quit,
  count
};

/// An action with its name and a description for the user.
struct ActionRow {
  Action action;
  std::string_view name, about;
};

/// All of them.
std::span<const ActionRow> action_rows();
/// "go-to-zero".
std::string_view action_name(Action action);
/// Empty if there is no such action.
std::optional<Action> action_named(std::string_view name);

}  // namespace lamplock::pendant
