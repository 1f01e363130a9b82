// The one table of settings: numbers, names, units, ranges, defaults, descriptions.
//
// Firmware, host, documentation and tests use only this table. Numbers are those of grbl 1.1 where
// grbl has the setting, others start at 900, in blocks: 900 beat, 920 laser protection, 940 work
// space, 960 axes, 980 link, 990 board, 1050 pulses, 1060 temperature, 1070 drives, 1080 more of
// axes, 1090 drives with a UART. Values are stored in thousandths of the unit (`milli`) as 32-bit
// integers: exact, printable with three decimals, no floating point.
//
// Two blocks are missing in images of boards that have no use for them
// (toolchain/arm/CMakeLists.txt): they would use SRAM for nothing. 1060 without SENSOR
// (LAMPLOCK_SENSOR_SETTINGS = 0), 1090 without such drives (LAMPLOCK_DRIVE_SETTINGS = 0).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#ifndef LAMPLOCK_DRIVE_SETTINGS
#define LAMPLOCK_DRIVE_SETTINGS 1
#endif
#ifndef LAMPLOCK_SENSOR_SETTINGS
#define LAMPLOCK_SENSOR_SETTINGS 1
#endif

namespace lamplock::settings {

/// Index of a setting in the table; per-axis settings have four consecutive rows X Y Z A.
enum class Id : std::uint8_t {
  step_pulse,
  idle_delay,
  step_invert,
  direction_invert,
  enable_invert,
  limit_invert,
  probe_invert,
  report_mask,
  junction_deviation,
  arc_tolerance,
  report_inches,
  soft_limits,
  hard_limits,
  homing,
  homing_direction,
  homing_feed,
  homing_seek,
  homing_debounce,
  homing_pull_off,
  max_spindle_speed,
  laser_mode,
  idle_release,
  parking,
  homing_passes,
  homing_phase_1,
  homing_phase_2,
  homing_phase_3,
  homing_phase_4,
  parking_pull_out,
  parking_slow,
  parking_target,
  parking_fast,
  steps_per_mm_x,
  steps_per_mm_y,
  steps_per_mm_z,
  steps_per_mm_a,
  max_rate_x,
  max_rate_y,
  max_rate_z,
  max_rate_a,
  acceleration_x,
  acceleration_y,
  acceleration_z,
  acceleration_a,
  travel_x,
  travel_y,
  travel_z,
  travel_a,
  lamp_mode,
  lamp_frequency,
  q_switch_delay,
  q_switch_width,
  shot_tolerance,
  lock_range,
  slew_limit,
  lock_edges,
  lamp_jitter,
  lamp_drift,
  period_tolerance,
  lamp_warm_up,
  max_shot_rate,
  lamp_energy,
  lamp_power,
  channels,
  shutter_open,
  shutter_close,
  shot_check,
  shot_repeats,
  sensor_time,
  attenuator_settle,
  laser_lead,
  pulses_per_mm,
  pulse_length,
  max_lamp_frequency,
  max_lamp_energy,
  focus_power,
  focus_time,
  min_corner_x,
  min_corner_y,
  min_corner_z,
  min_corner_a,
  axes,
  speed_jump_x,
  speed_jump_y,
  speed_jump_z,
  speed_jump_a,
  kinematics,
  ganged_axis,
  rotary_axis,
  dead_man,
  stop_at_error,
  program_dead_man,
  jog_lease,
  run_on,
  pin_map,
  pulse_mode_x,
  pulse_mode_y,
  pulse_mode_z,
  pulse_mode_a,
#if LAMPLOCK_SENSOR_SETTINGS
  loop,
  loop_set_point,
  loop_kp,
  loop_ki,
  loop_min,
  loop_max,
  sensor_scale,
  sensor_min,
  sensor_max,
#endif
  drive_lag_x,
  drive_lag_y,
  drive_lag_z,
  drive_lag_a,
  direction_setup,
  direction_hold,
  step_low,
  jerk_x,
  jerk_y,
  jerk_z,
  jerk_a,
#if LAMPLOCK_DRIVE_SETTINGS
  drive_current_x,
  drive_current_y,
  drive_current_z,
  drive_current_a,
  microsteps_x,
  microsteps_y,
  microsteps_z,
  microsteps_a,
  drive_hold,
  spread_cycle,
#endif
  count
};
inline constexpr std::size_t setting_count = static_cast<std::size_t>(Id::count);

/// What a setting belongs to. Jobs of points may bring values of their own for those of `jobs`
/// only; these are part of the hash of a job's settings.
enum class Scope : std::uint8_t {
  machine,   ///< switches, homing, drives at rest, reports, limits that a job cannot change
  programs,  ///< programs of G-code
  jobs       ///< jobs of points, and everything else
};

/// What a job's own value of a setting must be, compared with the machine's value: the machine's
/// settings define the machine, its limits and protections.
enum class Rule : std::uint8_t {
  any,    ///< no limit, or one that depends on other settings (job_limits.hpp)
  equal,  ///< with other steps/mm, for example, every limit would mean another length
  not_less,
  not_more,
  not_more_zero_unlimited,  ///< 0 means without limit: a job may have it only if the machine does
  subset                    ///< of the bits
};

/// One row of the table. Values in thousandths of `unit`.
struct Row {
  std::uint16_t number;
  std::string_view name;
  std::string_view unit;
  std::int32_t min_milli;
  std::int32_t max_milli;
  std::int32_t default_milli;
  bool whole;  ///< printed and accepted without decimals
  Scope scope;
  Rule rule;
  std::string_view description;
};

/// Lamp mode ($900).
enum class LampMode : std::uint8_t { free_beat = 0, slave = 1, master = 2 };

/// What the temperature scales ($1061).
enum class LoopMode : std::uint8_t { off = 0, power = 1, feed = 2 };

/// Signals of the two wires of an axis ($1051..1054).
enum class PulseMode : std::uint8_t {
  step_dir = 0,
  cw_ccw = 1,  ///< a pulse on the wire of STEP is a step up, on that of DIR a step down
  quadrature =
      2,  ///< A on the wire of STEP, B on that of DIR; every edge is a step, up while A leads
};

inline constexpr std::array<Row, setting_count> table{{
    {0, "step_pulse", "us", 400, 10'000, 500, false, Scope::jobs, Rule::equal,
     "minimum width of a step pulse; above 0.5 us it is whole ticks of 1 us, and the rates of the "
     "axes must leave time for it"},
    {1, "idle_delay", "ms", 0, 255'000, 255'000, true, Scope::machine, Rule::any,
     "time after the last motion until the drives of $37 are released; 255 = never"},
    {2, "step_invert", "0..15", 0, 15'000, 0, true, Scope::jobs, Rule::equal,
     "axes whose STEP (CW, A) is active low, added up: 1 X, 2 Y, 4 Z, 8 A; from the next start on"},
    {3, "direction_invert", "0..15", 0, 15'000, 0, true, Scope::jobs, Rule::equal,
     "axes whose DIR (CCW, B) is inverted, added up as in $2; with DIR or B the axis runs the "
     "other way; from the next start on"},
    {4, "enable_invert", "on/off", 0, 1'000, 0, true, Scope::jobs, Rule::equal,
     "DRIVES ENABLE is active high (needs a pull-down outside); from the next start on"},
    {5, "limit_invert", "0..15", 0, 15'000, 0, true, Scope::machine, Rule::any,
     "limit switches that close when they engage instead of opening, added up: 1 X, 2 Y, 4 Z, 8 A; "
     "limits in one circuit use X"},
    {6, "probe_invert", "on/off", 0, 1'000, 0, true, Scope::machine, Rule::any,
     "the probe opens its circuit when it touches instead of closing it"},
    {10, "report_mask", "0..511", 0, 511'000, 3'000, true, Scope::machine, Rule::any,
     "contents of a status report, added up: 1 machine position, else work position; 2 room for "
     "lines; what 4 to 256 ask for in grblHAL is always there"},
    {11, "junction_deviation", "mm", 0, 10'000, 10, false, Scope::programs, Rule::any,
     "maximum distance from a corner of a program to the circle that sets its speed"},
    {12, "arc_tolerance", "mm", 1, 1'000, 2, false, Scope::programs, Rule::any,
     "maximum distance of the straight pieces of a curve from the curve"},
    {13, "report_inches", "on/off", 0, 1'000, 0, true, Scope::machine, Rule::any,
     "reports in inches"},
    {20, "soft_limits", "on/off", 0, 1'000, 1'000, true, Scope::jobs, Rule::not_less,
     "refuse targets outside the work space"},
    {21, "hard_limits", "on/off", 0, 1'000, 1'000, true, Scope::jobs, Rule::not_less,
     "stop when a limit switch engages"},
    {22, "homing", "on/off", 0, 1'000, 0, true, Scope::machine, Rule::any,
     "$H finds the limit switches; after power-up the machine is locked until $H or $X"},
    {23, "homing_direction", "0..15", 0, 15'000, 0, true, Scope::machine, Rule::any,
     "axes whose switch is at the lower end of the work space, added up: 1 X, 2 Y, 4 Z, 8 A"},
    {24, "homing_feed", "mm/min", 1'000, 600'000'000, 25'000, false, Scope::machine, Rule::any,
     "speed at which a switch is located"},
    {25, "homing_seek", "mm/min", 1'000, 600'000'000, 500'000, false, Scope::machine, Rule::any,
     "speed of the search for a switch, and of pulling off"},
    {26, "homing_debounce", "ms", 0, 10'000'000, 250'000, true, Scope::machine, Rule::any,
     "time after pulling off within which a switch must have released"},
    {27, "homing_pull_off", "mm", 10, 100'000, 1'000, false, Scope::machine, Rule::any,
     "distance of the machine from a switch after homing"},
    {30, "max_spindle_speed", "S", 1'000, 1'000'000'000, 1'000'000, true, Scope::programs,
     Rule::any, "S word for full speed of the spindle or full power of the laser"},
    {32, "laser_mode", "on/off", 0, 1'000, 0, true, Scope::machine, Rule::any,
     "the spindle is a laser: its power changes with the motion, off in rapids and at rest"},
    {37, "idle_release", "0..15", 0, 15'000, 15'000, true, Scope::machine, Rule::any,
     "axes whose drives are released at rest ($1), added up: 1 X, 2 Y, 4 Z, 8 A; drives on one "
     "wire together"},
    {41, "parking", "on/off", 0, 1'000, 0, true, Scope::programs, Rule::any,
     "while the door is open Z is raised; it returns before the program continues"},
    {43, "homing_passes", "count", 1'000, 20'000, 1'000, true, Scope::machine, Rule::any,
     "number of times a switch is located; the last result counts"},
    {44, "homing_phase_1", "0..15", 0, 15'000, 4'000, true, Scope::machine, Rule::any,
     "axes that home first, together, added up: 1 X, 2 Y, 4 Z, 8 A"},
    {45, "homing_phase_2", "0..15", 0, 15'000, 3'000, true, Scope::machine, Rule::any,
     "axes that home next"},
    {46, "homing_phase_3", "0..15", 0, 15'000, 8'000, true, Scope::machine, Rule::any,
     "axes that home after these"},
    {47, "homing_phase_4", "0..15", 0, 15'000, 0, true, Scope::machine, Rule::any,
     "axes that home last"},
    {56, "parking_pull_out", "mm", 0, 100'000, 5'000, false, Scope::programs, Rule::any,
     "distance of the slow rise of Z before the fast move"},
    {57, "parking_slow", "mm/min", 1'000, 600'000'000, 100'000, false, Scope::programs, Rule::any,
     "speed of the slow rise, and of lowering Z to the work"},
    {58, "parking_target", "mm", -1'000'000, 1'000'000, 45'000, false, Scope::programs, Rule::any,
     "parking height of Z, in machine coordinates; a higher Z does not move"},
    {59, "parking_fast", "mm/min", 1'000, 600'000'000, 500'000, false, Scope::programs, Rule::any,
     "speed of the move to the parking height and back"},
    {100, "steps_per_mm_x", "step/mm", 1, 50'000'000, 200'000, false, Scope::jobs, Rule::equal,
     "resolution of X"},
    {101, "steps_per_mm_y", "step/mm", 1, 50'000'000, 200'000, false, Scope::jobs, Rule::equal,
     "resolution of Y"},
    {102, "steps_per_mm_z", "step/mm", 1, 50'000'000, 200'000, false, Scope::jobs, Rule::equal,
     "resolution of Z"},
    {103, "steps_per_mm_a", "step/mm", 1, 50'000'000, 200'000, false, Scope::jobs, Rule::equal,
     "resolution of A"},
    {110, "max_rate_x", "mm/min", 1'000, 600'000'000, 60'000'000, false, Scope::jobs,
     Rule::not_more, "highest speed of X"},
    {111, "max_rate_y", "mm/min", 1'000, 600'000'000, 60'000'000, false, Scope::jobs,
     Rule::not_more, "highest speed of Y"},
    {112, "max_rate_z", "mm/min", 1'000, 600'000'000, 60'000'000, false, Scope::jobs,
     Rule::not_more, "highest speed of Z"},
    {113, "max_rate_a", "mm/min", 1'000, 600'000'000, 60'000'000, false, Scope::jobs,
     Rule::not_more, "highest speed of A"},
    {120, "acceleration_x", "mm/s2", 1'000, 200'000'000, 4'000'000, false, Scope::jobs,
     Rule::not_more, "highest acceleration of X"},
    {121, "acceleration_y", "mm/s2", 1'000, 200'000'000, 4'000'000, false, Scope::jobs,
     Rule::not_more, "highest acceleration of Y"},
    {122, "acceleration_z", "mm/s2", 1'000, 200'000'000, 4'000'000, false, Scope::jobs,
     Rule::not_more, "highest acceleration of Z"},
    {123, "acceleration_a", "mm/s2", 1'000, 200'000'000, 4'000'000, false, Scope::jobs,
     Rule::not_more, "highest acceleration of A"},
    {130, "travel_x", "mm", 100, 2'000'000, 100'000, false, Scope::jobs, Rule::not_more,
     "length of the work space in X"},
    {131, "travel_y", "mm", 100, 2'000'000, 100'000, false, Scope::jobs, Rule::not_more,
     "length of the work space in Y"},
    {132, "travel_z", "mm", 100, 2'000'000, 100'000, false, Scope::jobs, Rule::not_more,
     "length of the work space in Z"},
    {133, "travel_a", "mm", 100, 2'000'000, 100'000, false, Scope::jobs, Rule::not_more,
     "length of the work space in A"},
    {900, "lamp_mode", "0..2", 0, 2'000, 1'000, true, Scope::jobs, Rule::any,
     "0 no lamp (free beat), 1 slave (the lamp free-runs, the controller follows LAMP SYNC), 2 "
     "master (the controller triggers the lamp)"},
    {901, "lamp_frequency", "Hz", 1'000, 8'000'000, 100'000, false, Scope::jobs, Rule::any,
     "nominal lamp frequency"},
    {902, "q_switch_delay", "us", 2'220, 500'000, 5'000, false, Scope::jobs, Rule::any,
     "maximum time from LAMP SYNC to Q-switch at the pins; the laser requires at most 20 us"},
    {903, "q_switch_width", "us", 1'000, 1'000'000, 150'000, false, Scope::jobs, Rule::any,
     "width of the Q-switch pulse; the laser requires more than 100 us"},
    {904, "shot_tolerance", "um", 0, 1'000'000, 0, false, Scope::jobs, Rule::any,
     "maximum distance of a shot from its point; 0 = the larger of half a step and 5 um"},
    {905, "lock_range", "%", 100, 10'000, 3'000, false, Scope::jobs, Rule::any,
     "maximum deviation of the lamp period from nominal"},
    {906, "slew_limit", "%", 10, 5'000, 200, false, Scope::jobs, Rule::any,
     "maximum change of a tick against the tracked period while moving"},
    {907, "lock_edges", "count", 2'000, 16'000, 8'000, true, Scope::jobs, Rule::any,
     "edges in a row that establish the lock"},
    {908, "lamp_jitter", "us", 100, 1'000'000, 20'000, false, Scope::jobs, Rule::any,
     "largest jitter of a lamp edge to expect; with lamp_drift it sets the gains of the beat "
     "clock"},
    {909, "lamp_drift", "%/s", 1, 10'000, 300, false, Scope::jobs, Rule::any,
     "largest drift of the lamp period to expect"},
    {910, "period_tolerance", "%", 0, 10'000, 0, false, Scope::jobs, Rule::not_more,
     "maximum change of the lamp period from nominal by the controller as master"},
    {920, "lamp_warm_up", "count", 0, 100'000'000, 0, true, Scope::jobs, Rule::not_less,
     "flashes before the first shot"},
    {921, "max_shot_rate", "Hz", 1'000, 10'000'000, 5'000'000, false, Scope::jobs, Rule::not_more,
     "highest rate of shots"},
    {922, "lamp_energy", "J", 0, 100'000, 0, false, Scope::jobs, Rule::not_less,
     "energy of a flash; 0 = not known"},
    // GLASS: Ep f < 1000 W.
    {923, "lamp_power", "W", 1'000, 1'000'000, 1'000'000, false, Scope::jobs, Rule::not_more,
     "highest product of lamp_energy and frequency"},
    {924, "channels", "1..15", 1'000, 15'000, 15'000, true, Scope::jobs, Rule::subset,
     "beam channels that may fire, added up: 1 first, 2 second, 4 third, 8 fourth"},
    {925, "shutter_open", "ms", 0, 10'000'000, 0, false, Scope::jobs, Rule::not_less,
     "time a shutter takes to open"},
    {926, "shutter_close", "ms", 0, 10'000'000, 0, false, Scope::jobs, Rule::not_less,
     "time a shutter takes to close"},
    {927, "shot_check", "0..2", 0, 2'000, 0, true, Scope::jobs, Rule::any,
     "photosensor of the channel: 0 ignored, 1 shots not seen are counted, 2 they are repeated"},
    {928, "shot_repeats", "count", 0, 100'000, 2'000, true, Scope::jobs, Rule::any,
     "number of times a shot that was not seen is repeated before the job is held"},
    {929, "sensor_time", "us", 10'000, 10'000'000, 200'000, false, Scope::jobs, Rule::any,
     "time after the Q-switch within which the photosensor may answer"},
    {930, "attenuator_settle", "ms", 0, 10'000'000, 0, false, Scope::jobs, Rule::not_less,
     "time the attenuator takes to reach another value"},
    {931, "laser_lead", "us", -1'000'000, 1'000'000, 0, false, Scope::jobs, Rule::any,
     "time by which a continuous laser is switched before the machine arrives; negative: after"},
    {932, "pulses_per_mm", "1/mm", 0, 1'000'000, 0, false, Scope::programs, Rule::any,
     "pulses of a continuous laser per millimetre of path; 0 = it shines continuously (M127)"},
    {933, "pulse_length", "us", 1'000, 1'000'000'000, 1'500'000, false, Scope::programs, Rule::any,
     "length of each of these pulses (M128)"},
    // GLASS: lamps of 1 to 200 Hz, Ep <= 20 J.
    {934, "max_lamp_frequency", "Hz", 1'000, 8'000'000, 200'000, false, Scope::machine, Rule::any,
     "highest frequency at which the controller may trigger the lamp; jobs cannot change it"},
    {935, "max_lamp_energy", "J", 0, 100'000, 20'000, false, Scope::machine, Rule::any,
     "largest lamp_energy; jobs cannot change it"},
    {936, "focus_power", "%", 0, 100'000, 0, false, Scope::programs, Rule::any,
     "largest power of a continuous laser at rest, in G4 or after M3 alone; 0 = dark"},
    {937, "focus_time", "s", 0, 600'000, 10'000, false, Scope::programs, Rule::any,
     "longest light at rest"},
    {940, "min_corner_x", "mm", -1'000'000, 1'000'000, -50'000, false, Scope::jobs, Rule::any,
     "lowest X of the work space"},
    {941, "min_corner_y", "mm", -1'000'000, 1'000'000, -50'000, false, Scope::jobs, Rule::any,
     "lowest Y of the work space"},
    {942, "min_corner_z", "mm", -1'000'000, 1'000'000, -50'000, false, Scope::jobs, Rule::any,
     "lowest Z of the work space"},
    {943, "min_corner_a", "mm", -1'000'000, 1'000'000, -50'000, false, Scope::jobs, Rule::any,
     "lowest A of the work space"},
    {960, "axes", "count", 1'000, 4'000, 3'000, true, Scope::jobs, Rule::equal, "number of axes"},
    {961, "speed_jump_x", "mm/s", 0, 1'000'000, 0, false, Scope::jobs, Rule::not_more,
     "maximum jump of the speed of X at a corner of a path"},
    {962, "speed_jump_y", "mm/s", 0, 1'000'000, 0, false, Scope::jobs, Rule::not_more,
     "maximum jump of the speed of Y at a corner of a path"},
    {963, "speed_jump_z", "mm/s", 0, 1'000'000, 0, false, Scope::jobs, Rule::not_more,
     "maximum jump of the speed of Z at a corner of a path"},
    {964, "speed_jump_a", "mm/s", 0, 1'000'000, 0, false, Scope::jobs, Rule::not_more,
     "maximum jump of the speed of A at a corner of a path"},
    {965, "kinematics", "0..1", 0, 1'000, 0, true, Scope::jobs, Rule::equal,
     "0 Cartesian, 1 CoreXY (motor X turns by X + Y, motor Y by X - Y); from the next start on"},
    {966, "ganged_axis", "0..3", 0, 3'000, 0, true, Scope::jobs, Rule::equal,
     "axis whose second motor is that of A: 0 none, 1 X, 2 Y, 3 Z; from the next start on"},
    {967, "rotary_axis", "0..2", 0, 2'000, 0, true, Scope::programs, Rule::any,
     "what A of programs is: 0 a length, 1 degrees, without limit of travel, 2 the same, and "
     "absolute positions are reached the shortest way round"},
    {980, "dead_man", "ms", 0, 60'000'000, 2'000'000, false, Scope::jobs,
     Rule::not_more_zero_unlimited,
     "silence of the host in a job before a controlled stop; 0 = never"},
    {981, "stop_at_error", "on/off", 0, 1'000, 0, true, Scope::programs, Rule::any,
     "after an error in a line of a program, refuse further lines until $X or a reset"},
    {982, "program_dead_man", "ms", 0, 60'000'000, 0, false, Scope::programs, Rule::any,
     "silence of the host in a program before it is held; 0 = never. For senders that poll the "
     "status"},
    {983, "jog_lease", "ms", 0, 60'000'000, 0, false, Scope::machine, Rule::any,
     "time after the last $J or frame at which a jog ends; 0 = it runs to its target"},
    {984, "run_on", "on/off", 0, 1'000, 0, true, Scope::programs, Rule::any,
     "a program that was received up to its M2 or M30 continues without its host"},
    {990, "pin_map", "0..63", 0, 63'000, 0, true, Scope::jobs, Rule::equal,
     "assignment of the pins of the board, from its next start on: 0 glass, 1 cut (fourth axis, "
     "UART, a limit switch for each axis), 2 cut with outputs and an input of programs instead of "
     "the UART; other boards have a number each (docs/boards)"},
    {1051, "pulse_mode_x", "0..2", 0, 2'000, 0, true, Scope::jobs, Rule::equal,
     "pulses of X: 0 STEP and DIR, 1 CW and CCW, 2 A and B in quadrature; from the next start on"},
    {1052, "pulse_mode_y", "0..2", 0, 2'000, 0, true, Scope::jobs, Rule::equal,
     "pulses of Y: 0 STEP and DIR, 1 CW and CCW, 2 A and B in quadrature; from the next start on"},
    {1053, "pulse_mode_z", "0..2", 0, 2'000, 0, true, Scope::jobs, Rule::equal,
     "pulses of Z: 0 STEP and DIR, 1 CW and CCW, 2 A and B in quadrature; from the next start on"},
    {1054, "pulse_mode_a", "0..2", 0, 2'000, 0, true, Scope::jobs, Rule::equal,
     "pulses of A: 0 STEP and DIR, 1 CW and CCW, 2 A and B in quadrature; from the next start on"},
#if LAMPLOCK_SENSOR_SETTINGS
    {1061, "loop", "0..2", 0, 2'000, 0, true, Scope::machine, Rule::any,
     "what the temperature at SENSOR scales in programs and rows: 0 nothing, 1 the power of the "
     "laser, 2 the feed rate (docs/thermal.md)"},
    {1062, "loop_set_point", "mV", 0, 3'300'000, 0, false, Scope::machine, Rule::any,
     "voltage of the sensor at the temperature to be held"},
    {1063, "loop_kp", "%/K", 0, 100'000, 0, false, Scope::machine, Rule::any,
     "proportional gain of the loop"},
    {1064, "loop_ki", "%/(K s)", 0, 1'000'000'000, 0, false, Scope::machine, Rule::any,
     "integral gain of the loop"},
    {1065, "loop_min", "%", 10'000, 100'000, 50'000, false, Scope::machine, Rule::any,
     "lowest scale, of the programmed power or feed rate"},
    {1066, "loop_max", "%", 100'000, 200'000, 150'000, false, Scope::machine, Rule::any,
     "highest scale; the power is at most that of $30"},
    {1067, "sensor_scale", "K/V", -10'000'000, 10'000'000, 0, false, Scope::machine, Rule::any,
     "rise of the temperature for a volt more at SENSOR; negative: the voltage falls"},
    // A cut wire is at 0 V, and the ADC deviates by some mV: at a limit of 0 it would be a
    // temperature.
    {1068, "sensor_min", "mV", 50'000, 3'300'000, 100'000, false, Scope::machine, Rule::any,
     "lowest voltage of a sensor that works; below, the laser is off and the program is held"},
    {1069, "sensor_max", "mV", 0, 3'300'000, 3'200'000, false, Scope::machine, Rule::any,
     "highest voltage of a sensor that works; above, the laser is off and the program is held"},
#endif
    {1071, "drive_lag_x", "us", 0, 5'000'000, 0, false, Scope::jobs, Rule::any,
     "lag of the drive after its steps"},
    {1072, "drive_lag_y", "us", 0, 5'000'000, 0, false, Scope::jobs, Rule::any,
     "lag of the drive after its steps"},
    {1073, "drive_lag_z", "us", 0, 5'000'000, 0, false, Scope::jobs, Rule::any,
     "lag of the drive after its steps"},
    {1074, "drive_lag_a", "us", 0, 5'000'000, 0, false, Scope::jobs, Rule::any,
     "lag of the drive after its steps"},
    {1075, "direction_setup", "us", 200, 50'000, 500, false, Scope::jobs, Rule::equal,
     "minimum time from a change of DIR to the next step; with hold, from a step to one in the "
     "other direction"},
    {1076, "direction_hold", "us", 200, 50'000, 500, false, Scope::jobs, Rule::equal,
     "minimum time from a step to a change of DIR, which never changes during a pulse"},
    {1077, "step_low", "us", 300, 10'000, 300, false, Scope::jobs, Rule::equal,
     "minimum time from the end of a step pulse to the next pulse of its axis"},
    {1081, "jerk_x", "m/s3", 0, 100'000'000, 0, false, Scope::jobs, Rule::not_more_zero_unlimited,
     "highest jerk of X; 0 = no limit"},
    {1082, "jerk_y", "m/s3", 0, 100'000'000, 0, false, Scope::jobs, Rule::not_more_zero_unlimited,
     "highest jerk of Y; 0 = no limit"},
    {1083, "jerk_z", "m/s3", 0, 100'000'000, 0, false, Scope::jobs, Rule::not_more_zero_unlimited,
     "highest jerk of Z; 0 = no limit"},
    {1084, "jerk_a", "m/s3", 0, 100'000'000, 0, false, Scope::jobs, Rule::not_more_zero_unlimited,
     "highest jerk of A; 0 = no limit"},
#if LAMPLOCK_DRIVE_SETTINGS
    {1091, "drive_current_x", "mA", 50'000, 2'000'000, 500'000, true, Scope::machine, Rule::any,
     "current of the motor of X in motion, effective value; at most what the board permits"},
    {1092, "drive_current_y", "mA", 50'000, 2'000'000, 500'000, true, Scope::machine, Rule::any,
     "current of the motor of Y in motion, effective value; at most what the board permits"},
    {1093, "drive_current_z", "mA", 50'000, 2'000'000, 500'000, true, Scope::machine, Rule::any,
     "current of the motor of Z in motion, effective value; at most what the board permits"},
    {1094, "drive_current_a", "mA", 50'000, 2'000'000, 500'000, true, Scope::machine, Rule::any,
     "current of the motor of A in motion, effective value; at most what the board permits"},
    {1095, "microsteps_x", "1..256", 1'000, 256'000, 16'000, true, Scope::machine, Rule::any,
     "steps of X in a full step of the motor: 1, 2, 4 and so on to 256"},
    {1096, "microsteps_y", "1..256", 1'000, 256'000, 16'000, true, Scope::machine, Rule::any,
     "steps of Y in a full step of the motor: 1, 2, 4 and so on to 256"},
    {1097, "microsteps_z", "1..256", 1'000, 256'000, 16'000, true, Scope::machine, Rule::any,
     "steps of Z in a full step of the motor: 1, 2, 4 and so on to 256"},
    {1098, "microsteps_a", "1..256", 1'000, 256'000, 16'000, true, Scope::machine, Rule::any,
     "steps of A in a full step of the motor: 1, 2, 4 and so on to 256"},
    {1099, "drive_hold", "%", 0, 100'000, 50'000, true, Scope::machine, Rule::any,
     "current of the motors at rest, of that in motion"},
    {1100, "spread_cycle", "0..15", 0, 15'000, 0, true, Scope::machine, Rule::any,
     "axes whose drives use spreadCycle instead of stealthChop, added up: 1 X, 2 Y, 4 Z, 8 A"},
#endif
}};

/// Row of a setting, texts and all.
constexpr const Row& row(Id id) { return table[static_cast<std::size_t>(id)]; }

/// What the firmware keeps of a row: no texts.
struct Range {
  std::int32_t min_milli, max_milli, default_milli;
  bool whole;
  Scope scope;
  Rule rule;
};
inline constexpr auto ranges = [] {
  std::array<Range, setting_count> all{};
  for (std::size_t i = 0; i < setting_count; ++i)
    all[i] = {table[i].min_milli, table[i].max_milli, table[i].default_milli,
              table[i].whole,     table[i].scope,     table[i].rule};
  return all;
}();
constexpr const Range& range(Id id) { return ranges[static_cast<std::size_t>(id)]; }
inline constexpr auto numbers = [] {
  std::array<std::uint16_t, setting_count> all{};
  for (std::size_t i = 0; i < setting_count; ++i) all[i] = table[i].number;
  return all;
}();
/// What follows the "$".
constexpr std::uint16_t number(Id id) { return numbers[static_cast<std::size_t>(id)]; }

/// Row of the same setting for another axis, given the X row.
constexpr Id for_axis(Id x_row, int axis) {
  return static_cast<Id>(static_cast<int>(x_row) + axis);
}

/// True if jobs of points may bring a value of their own.
constexpr bool of_jobs(Id id) { return range(id).scope == Scope::jobs; }
inline constexpr std::size_t job_setting_count = [] {
  std::size_t n = 0;
  for (std::size_t i = 0; i < setting_count; ++i)
    if (of_jobs(static_cast<Id>(i))) ++n;
  return n;
}();

/// Index of a setting number; Id::count if there is none.
constexpr Id find_number(std::uint16_t number) {
  for (std::size_t i = 0; i < setting_count; ++i)
    if (numbers[i] == number) return static_cast<Id>(i);
  return Id::count;
}

/// A setting of the temperature loop, whether or not this image has them.
constexpr bool needs_sensor(std::uint16_t number) { return number >= 1061 && number <= 1069; }

/// Index of a setting name; Id::count if there is none.
constexpr Id find_name(std::string_view name) {
  for (std::size_t i = 0; i < setting_count; ++i)
    if (table[i].name == name) return static_cast<Id>(i);
  return Id::count;
}

/// All values, starting with the defaults.
class Values {
 public:
  constexpr Values() {
    for (std::size_t i = 0; i < setting_count; ++i) milli_[i] = ranges[i].default_milli;
  }
  constexpr std::int32_t milli(Id id) const { return milli_[static_cast<std::size_t>(id)]; }
  constexpr std::int32_t milli(Id x_row, int axis) const { return milli(for_axis(x_row, axis)); }
  /// The value without its decimals.
  constexpr std::int32_t whole(Id id) const { return milli(id) / 1000; }
  constexpr std::int32_t whole(Id x_row, int axis) const { return whole(for_axis(x_row, axis)); }

  /// Sets a value; false (and nothing changed) if it is outside its range or must be whole.
  constexpr bool set_milli(Id id, std::int32_t value) {
    const Range& r = range(id);
    if (value < r.min_milli || value > r.max_milli) return false;
    if (r.whole && value % 1000 != 0) return false;
    put_milli(id, value);
    return true;
  }
  /// Sets a value that is known to be inside its range.
  constexpr void put_milli(Id id, std::int32_t value) {
    milli_[static_cast<std::size_t>(id)] = value;
  }

  /// FNV-1a (Fowler, Noll, Vo) over numbers and values of jobs: identifies the settings of a job.
  constexpr std::uint32_t hash() const {
    std::uint32_t h = 2166136261u;
    for (std::size_t i = 0; i < setting_count; ++i) {
      if (!of_jobs(static_cast<Id>(i))) continue;
      const auto v = static_cast<std::uint32_t>(milli_[i]);
      const std::uint32_t words[2] = {numbers[i], v};
      for (std::uint32_t word : words)
        for (int shift = 0; shift < 32; shift += 8) h = (h ^ ((word >> shift) & 0xff)) * 16777619u;
    }
    return h;
  }
  friend constexpr bool operator==(const Values&, const Values&) = default;

 private:
  std::array<std::int32_t, setting_count> milli_{};
};

}  // namespace lamplock::settings
