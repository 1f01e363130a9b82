// Interface of the core and a board: features, outputs, timing, progress to be kept.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/machine/inputs/inputs.hpp"
#include "firmware/machine/runners/job_runner.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// Capabilities of the board.
struct BoardFeatures {
  std::string_view name = "virtual";  ///< in `$I`
  std::uint8_t first_map = 0;         ///< the first of its pin maps ($990) ...
  std::uint8_t maps = 0xff;           ///< ... and their number
  bool step_dir_only = false;         ///< no CW and CCW, no quadrature ($1051 to $1054)
  bool enables_low = false;           ///< drives are enabled by low levels only ($4)
  bool triggers_lamp = true;          ///< otherwise it only follows a lamp ($900)
  int axes = max_axes;                ///< with outputs; jobs with more are refused
  std::uint8_t channels = 0xf;        ///< a bit for each beam channel with a shutter
  InputSet inputs = all_inputs & ~set_of(Input::limit_chain) & ~set_of(Input::aux);
  std::uint8_t outputs = 0;      ///< a bit for each that programs may switch
  std::uint8_t second_wire = 0;  ///< a bit for each axis whose drive has the second enable
  bool has_sensor = false;       ///< an analogue input for a temperature ($1061)
  /// How it accepts motion; HandoutMode::staged with stage() before each commit().
  HandoutMode parts = HandoutMode::straight;
  /// It has memory for one planner at a time, and loads Controller::missing_planner().
  bool loads_planners = false;
#if LAMPLOCK_DRIVE_SETTINGS
  /// Of the drives on the board ($1091 to $1094); 0: it has none.
  std::uint16_t max_drive_current_ma = 0;
#endif
};

/// First setting whose value the board does not have: its pin map, pulses of an axis, a lamp to
/// trigger, a sensor, the other polarity of enables; Id::count if there is none.
[[gnu::cold]] constexpr settings::Id unfit_setting(const BoardFeatures& board,
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
#if LAMPLOCK_SENSOR_SETTINGS
  if (!board.has_sensor && values.milli(Id::loop) != 0) return Id::loop;
#endif
  return Id::count;
}
/// First setting that drives on the board cannot have: a current, microsteps; Id::count if there is
/// none.
[[gnu::cold]] constexpr settings::Id unfit_drive_setting(
    [[maybe_unused]] const BoardFeatures& board, [[maybe_unused]] const settings::Values& values) {
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
/// Replaces such values by ones of the board: those of another board, or defaults.
[[gnu::cold]] constexpr void fit_settings(const BoardFeatures& board, settings::Values& values) {
  for (settings::Id unfit; (unfit = unfit_setting(board, values)) != settings::Id::count;)
    values.set_milli(unfit, unfit == settings::Id::pin_map ? board.first_map * 1000 : 0);
}

/// Outputs that may be on.
struct Outputs {
  bool fire_enable = false;
  bool drives_enable = false;
  std::uint8_t shutters = 0;     ///< bit 0 = first channel; 1 = open; never two at a time
  std::uint16_t attenuator = 0;  ///< 65535 = full
  /// A continuous laser may shine while the gate bit of the lattice is set; LASER PWM is its power
  /// then, not the attenuator.
  bool laser_enable = false;
};

/// Outputs switched by programs, and the second enable: for boards that have such pins.
struct SwitchedOutputs {
  bool z_enable = false;
  bool air = false;
  std::uint16_t aux = 0;  ///< 65535 = on
};

/// Timing of the board's fire stage, from the settings.
struct FireTiming {
  std::uint32_t delay_clocks = 0;  ///< LAMP SYNC to Q-switch (lamp/shot_delay.hpp)
  std::uint32_t width_clocks = 0;  ///< of the Q-switch pulse
  bool own_edges = false;          ///< free beat: the trigger output is the LAMP SYNC
};

/// Progress of a job that must survive a restart. The number of flashes already fired at that point
/// does not.
struct ResumePoint {
  /// Programs have no sessions, and hosts never choose this one.
  static constexpr std::uint32_t of_program = 0xffffffff;

  std::uint32_t session = 0;  ///< 0 = no motion, or only motion that has ended
  std::uint32_t first_unfired = 0;
  bool shot_out = false;  ///< the board may have fired that point
};

/// Clocks from the edge to the decision whether to fire: runt filter (2 us) and latency of the fire
/// stage (19 clocks). Calculated for the PIO of the RP2040; the virtual board does the same.
inline constexpr std::uint32_t fire_decision_clocks = 2 * clocks_per_us + 19;

}  // namespace lamplock::machine
