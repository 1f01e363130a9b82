// Values of settings that a board does not have: its pin map, pulses of an axis, a lamp to trigger
// or one as fast, a sensor, beam channels, the other polarity of enables, currents of its drives.
//
// In:  the row of a board and one of its pin maps; settings.
// Out: the first setting whose value the board does not have.
// Who: the console and the start of the firmware, which refuse or replace it; the host, which
//      refuses a profile.
#pragma once

#include <cstdint>

#include "shared/boards/board_row.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::boards {

struct SettingLimits {
  std::uint8_t first_map = 0;    ///< the first of its pin maps ($990) ...
  std::uint8_t maps = 0xff;      ///< ... and their number
  bool step_dir_only = false;    ///< no CW and CCW, no quadrature ($1051 to $1054)
  bool enables_low = false;      ///< drives are enabled by low levels only ($4)
  bool triggers_lamp = true;     ///< otherwise it only follows a lamp ($900)
  std::uint8_t axes = max_axes;  ///< with outputs ($960); jobs with more are refused
  std::uint8_t channels =
      0xf;                  ///< a bit for each beam channel: with a shutter, or the first ($924)
  bool has_sensor = false;  ///< an analogue input for a temperature ($1061)
  /// The fastest beat whose edges, shots and points its processor handles ($901).
  std::int32_t max_lamp_milli_hz = settings::range(settings::Id::lamp_frequency).max_milli;
#if LAMPLOCK_DRIVE_SETTINGS
  /// Of the drives on the board ($1091 to $1094); 0: it has none.
  std::uint16_t max_drive_current_ma = 0;
#endif
};

[[gnu::cold]] constexpr SettingLimits limits_of(const BoardRow& row, Pins map) {
  return {
    .first_map = static_cast<std::uint8_t>(row.first_map),
    .maps = static_cast<std::uint8_t>(row.maps.size()), .step_dir_only = !has_paired_axes(row),
    .enables_low = enables_low(row),
    .triggers_lamp = find_gpio(row, Role::lamp_trigger).has_value(),
    .axes = static_cast<std::uint8_t>(axes(map)), .channels = channels(map),
    .has_sensor = find_gpio(map, Role::sensor).has_value(),
#if LAMPLOCK_DRIVE_SETTINGS
    .max_drive_current_ma = row.drives ? row.drives->max_current_ma : std::uint16_t{0},
#endif
  };
}

/// Id::count if the board has the values of all settings but those of its drives.
[[gnu::cold]] constexpr settings::Id unfit_setting(const SettingLimits& board,
                                                   const settings::Values& values) {
  using settings::Id;
  if (static_cast<unsigned>(values.whole(Id::pin_map) - board.first_map) >= board.maps)
    return Id::pin_map;
  for (int axis = 0; board.step_dir_only && axis < max_axes; ++axis)
    if (values.whole(Id::pulse_mode_x, axis) != 0)
      return settings::for_axis(Id::pulse_mode_x, axis);
  // With the opposite the drives would be on whenever the machine has them off.
  if (board.enables_low && values.milli(Id::enable_invert) != 0) return Id::enable_invert;
  if (!board.triggers_lamp &&
      values.whole(Id::lamp_mode) == static_cast<int>(settings::LampMode::master))
    return Id::lamp_mode;
  if (values.milli(Id::lamp_frequency) > board.max_lamp_milli_hz) return Id::lamp_frequency;
  if (values.whole(Id::axes) > board.axes) return Id::axes;
  if ((values.whole(Id::channels) & board.channels) == 0) return Id::channels;
#if LAMPLOCK_SENSOR_SETTINGS
  if (!board.has_sensor && values.milli(Id::loop) != 0) return Id::loop;
#endif
  return Id::count;
}

/// A value of such a setting that the board has, in thousandths.
[[gnu::cold]] constexpr std::int32_t fitting_milli(const SettingLimits& board, settings::Id unfit) {
  using settings::Id;
  if (unfit == Id::lamp_frequency) return board.max_lamp_milli_hz;
  const std::int32_t whole = unfit == Id::pin_map    ? board.first_map
                             : unfit == Id::axes     ? board.axes
                             : unfit == Id::channels ? board.channels
                                                     : 0;
  return whole * 1000;
}

/// First setting that drives on the board cannot have: a current, microsteps; Id::count if there is
/// none.
[[gnu::cold]] constexpr settings::Id unfit_drive_setting(
    [[maybe_unused]] const SettingLimits& board, [[maybe_unused]] const settings::Values& values) {
  using settings::Id;
#if LAMPLOCK_DRIVE_SETTINGS
  if (board.max_drive_current_ma == 0) return Id::count;
  for (int axis = 0; axis < max_axes; ++axis) {
    if (values.whole(Id::drive_current_x, axis) > board.max_drive_current_ma)
      return settings::for_axis(Id::drive_current_x, axis);
    const auto steps = static_cast<unsigned>(values.whole(Id::microsteps_x, axis));
    if ((steps & (steps - 1)) != 0) return settings::for_axis(Id::microsteps_x, axis);
  }
#endif
  return Id::count;
}

/// Replaces values of another board.
[[gnu::cold]] constexpr void fit_settings(const SettingLimits& board, settings::Values& values) {
  for (settings::Id unfit; (unfit = unfit_setting(board, values)) != settings::Id::count;)
    values.set_milli(unfit, fitting_milli(board, unfit));
}

}  // namespace lamplock::boards
