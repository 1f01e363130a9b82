// Interface of the core and a board: features, outputs, timing, progress to be kept.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/machine/inputs/inputs.hpp"
#include "firmware/machine/runners/job_runner.hpp"
#include "shared/boards/setting_limits.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// Capabilities of the board.
struct BoardFeatures {
  std::string_view name = "virtual";  ///< in `$I`
  boards::SettingLimits limits{};
  InputSet inputs = all_inputs & ~set_of(Input::limit_chain) & ~set_of(Input::aux);
  std::uint8_t outputs = 0;      ///< a bit for each that programs may switch
  std::uint8_t second_wire = 0;  ///< a bit for each axis whose drive has the second enable
  /// How it accepts motion; HandoutMode::staged with stage() before each commit().
  HandoutMode parts = HandoutMode::straight;
  /// It has memory for one planner at a time, and loads Controller::missing_planner().
  bool loads_planners = false;
};

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
