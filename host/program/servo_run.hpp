// A program run by two servo drives with encoders on their loads, on the virtual board.
//
// In:  its text, the drives: pulses, lengths, encoder, how their position loop follows.
// Out: at equal times, per axis, where the program was, what pulses asked for, what the encoder
//      read; where all of it stood at the end.
// Who: `lamplock diagnose` (report/servo_errors.hpp makes a table of it); tests.
//
// The defaults are the machine of a Polish paper on the programmed synchronisation of two AC servo
// drives: 512 pulses and 2048 counts a revolution of 78 mm. How its drives followed the table of
// its errors does not say: the time constant is ours.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "shared/settings_table.hpp"
#include "sim/world/servo.hpp"

namespace lamplock::program_run {

inline constexpr std::size_t servo_axes = 2;

struct ServoMachine {
  sim::ServoConfig drive;    ///< of either axis
  double accel_mm_s2 = 500;  ///< of the machine
  double sample_s = 0.001;   ///< between two samples
  double settle_s = 0.3;     ///< sampled on at the end, for the loads to come to rest

  double pulses_per_mm() const { return drive.steps_per_rev / drive.mm_per_rev; }
  /// What a board for it is set to. Throws Error(bad_input) if it cannot be.
  settings::Values settings() const;
};

/// Where an axis is, mm.
struct ServoPlace {
  double programmed = 0;  ///< by the plan, without pulses
  double commanded = 0;   ///< by the pulses that came
  double measured = 0;    ///< by the encoder
};
struct ServoSample {
  double at_s = 0;  ///< since the motion began
  std::array<ServoPlace, servo_axes> axis{};
};

struct ServoRun {
  std::vector<ServoSample> samples;       ///< from the first motion on; the last one at rest
  std::array<long, servo_axes> pulses{};  ///< where the drives were sent, of either direction
  double moving_s = 0;
  double steps_per_mm =
      0;  ///< what the controller counts with: the setting, with its three decimals
};

/// Runs it from zero to its end. Throws Error if it comes to none, or does not move: `name` says of
/// what.
ServoRun run_on_servos(std::string_view text, const ServoMachine& machine, const std::string& name);

/// A place in the plane, mm.
using PlanePoint = std::array<double, 2>;
/// The centre of the arc of a radius, the short way, that lies to the right of the way from one
/// end to the other. Throws Error(bad_input) if the ends are further apart than two radii.
PlanePoint centre_of(const PlanePoint& from, const PlanePoint& to, double radius);
/// The short way round a centre: G3 if the cross product of the ends as seen from there is
/// positive, G2 if not.
const char* arc_code(const PlanePoint& from, const PlanePoint& to, const PlanePoint& centre);

}  // namespace lamplock::program_run
