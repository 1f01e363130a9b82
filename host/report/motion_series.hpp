// A traced run in common units for drawing: over beats, each axis in mm, m/s, m/s2.
//
// In:  the trace of a virtual board (its ticks), the settings of the job.
// Out: for each axis that moves, position, speed and acceleration at the ends of every stretch of
//      constant acceleration, and its limits; beats with and without flash, shots, holds.
// Who: motion_plot.hpp; tests, which compare the numbers with the limits.
//
// The numbers are the rates of the tick generator, without measurement or smoothing. Speeds are in
// real time: a beat whose ticks were stretched to follow the lamp is slower by this factor.
// Between vertices speed is linear, acceleration constant, position a parabola, which is cut into
// pieces for drawing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/settings_table.hpp"
#include "shared/wire/status.hpp"
#include "sim/virtual_board/motion_trace.hpp"

namespace lamplock::report {

/// A value at a time, beats counted from beat 0 of the trace.
struct Vertex {
  double beat = 0;
  double value = 0;
};
using Curve = std::vector<Vertex>;

/// One axis; the acceleration jumps at equal beats. All axes have their vertices at the same beats.
struct AxisSeries {
  int number = 0;
  std::string name;  ///< X, Y, Z, A
  Curve position_mm, speed_m_s, accel_m_s2;
  double max_speed_m_s = 0, max_accel_m_s2 = 0;  ///< limits
};

/// A beat of the lattice.
struct BeatMark {
  double beat = 0;     ///< a whole number
  bool flash = false;  ///< the lamp has flashed
  bool shot = false;   ///< a pulse began
  double tick_us = 0;  ///< mean length of its ticks
};

/// A shot and the position of the drives.
struct ShotMark {
  double beat = 0;
  PerAxis<double> position_mm{};
};

/// An interval in which the machine did not run its job.
struct StateBand {
  double from = 0, to = 0;
  std::string name;
};

/// Everything in a window of beats.
struct MotionSeries {
  double from = 0, to = 0;       ///< whole beats
  double beat_ms = 0;            ///< nominal
  bool lamp = false;             ///< the lamp has flashed at least once
  std::vector<AxisSeries> axes;  ///< those that move
  std::vector<BeatMark> beats;
  std::vector<ShotMark> shots;
  std::vector<StateBand> bands;

  /// Longest tick over shortest one, less 1.
  double tick_spread() const;
};

/// Part of the window that a picture shows.
enum class Fit {
  window,  ///< all of it, so that several pictures have one scale
  motion   ///< from the first motion in it to the last
};

/// Without motion the series has no axes.
MotionSeries motion_series(const sim::MotionTrace& trace, const settings::Values& values,
                           const sim::BeatWindow& window, Fit fit);

}  // namespace lamplock::report
