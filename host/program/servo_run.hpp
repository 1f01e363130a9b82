// Runs a program with two servo drives with encoders on their loads, on the virtual board.
//
// In:  its text, the drives: pulses, lengths, encoder, dynamics of the position loop.
// Out: at equal times, per axis, the position of the program, of the pulses and of the encoder; the
//      positions at the end.
// Who: `lamplock diagnose` (servo_errors.hpp makes a table of it); tests.
//
// The defaults are the machine of a Polish paper on the programmed synchronisation of two AC servo
// drives: 512 pulses and 2048 counts a revolution of 78 mm. The table of errors in the paper does
// not give the dynamics of its drives: the time constant is an assumption.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/settings_table.hpp"
#include "sim/world/servo.hpp"

namespace lamplock::program_run {

inline constexpr std::size_t servo_axes = 2;

/// Limits of the controller for one axis.
struct ServoLimits {
  double speed_mm_s = 0, accel_mm_s2 = 0, jerk_mm_s3 = 0;
};

struct ServoMachine {
  sim::ServoConfig drive;                      ///< of either axis
  std::optional<double> time_constant_y_ms{};  ///< empty: that of X
  double accel_mm_s2 = 500;                    ///< of the machine
  /// Instead of this acceleration; empty: no other limits.
  std::optional<std::array<ServoLimits, servo_axes>> limits{};
  double sample_s = 0.001;  ///< between two samples
  double settle_s = 0.3;    ///< further sampling at the end until the loads are at rest

  double pulses_per_mm() const { return drive.steps_per_rev / drive.mm_per_rev; }
  /// Settings of a board for the drives. Throws Error(bad_input) if they are not possible.
  settings::Values settings() const;
};

/// Position of an axis, mm.
struct ServoPlace {
  double programmed = 0;  ///< by the plan, without pulses
  double commanded = 0;   ///< by the pulses received
  double measured = 0;    ///< by the encoder
};
struct ServoSample {
  double at_s = 0;  ///< since the motion began
  std::array<ServoPlace, servo_axes> axis{};
};

struct ServoRun {
  std::vector<ServoSample> samples;       ///< from the first motion on; the last one at rest
  std::array<long, servo_axes> pulses{};  ///< final position by the pulses, of either direction
  double moving_s = 0;
  double steps_per_mm = 0;  ///< of the controller: the setting, with its three decimals
};

/// Runs a program from zero to its end. It may also move Z, which has no error. Throws Error, about
/// `name`, if it does not end, or does not move X or Y.
ServoRun run_on_servos(std::string_view text, const ServoMachine& machine, const std::string& name);

/// A place in the plane, mm.
using PlanePoint = std::array<double, 2>;
/// The centre, to the right of the chord between the ends, of the shorter arc of a radius. Throws
/// Error(bad_input) if the ends are further apart than two radii.
PlanePoint centre_of(const PlanePoint& from, const PlanePoint& to, double radius);
/// The code of the shorter arc about a centre: G3 if the cross product of the ends relative to the
/// centre is positive, otherwise G2.
const char* arc_code(const PlanePoint& from, const PlanePoint& to, const PlanePoint& centre);

}  // namespace lamplock::program_run
