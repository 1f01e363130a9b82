// Gain of planning, in beats per point: the figures of the table of `lamplock bench`.
//
// In:  the measured rows of a machine that stops at every point, the walks and courses of
//      walks.hpp. Out: the firmware's planner in each of its modes beside the exact optimum.
// Who: `lamplock bench`, the golden tests.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "firmware/motion/profile/limits.hpp"
#include "host/bench/glass_tables.hpp"
#include "host/bench/walks.hpp"
#include "shared/wire/target.hpp"

namespace lamplock::bench {

/// Beats per point of one stream, planned in every mode.
struct Figures {
  double start_stop = 0;
  std::optional<double> path;  ///< empty if the firmware cannot plan it
  double free = 0;
  double optimum = 0;  ///< exact: no plan needs fewer
  double labels = 0;   ///< of the search for the optimum, per point

  /// Beats of free planning above the optimum, per cent.
  double gap_percent() const { return 100 * (free / optimum - 1); }
  /// Per cent of the time of start-stop that free planning saves.
  double saved_percent() const { return 100 * (1 - free / start_stop); }
};

/// Called with the number of points planned since the last call.
using PointsPlanned = std::function<void(std::size_t)>;

/// Plans one stream. Throws std::runtime_error if a point cannot be reached.
Figures figures_of(const motion::Limits& limits, const std::vector<wire::Target>& targets,
                   const PointsPlanned& planned = {});

/// Measured beats per point.
double measured_beats(const StartStopTime& row);
/// Beats of start-stop by this planner for one step along one axis, on the machine of a measured
/// row. Steps of the machine are 1 um; a time that is a whole number of beats to the last digit
/// counts as reached.
double start_stop_beats(const StartStopTime& row, double step_um);
/// Beats per point of start-stop by this planner for all step lengths of the object along one axis,
/// by the fitted histogram.
double start_stop_on_one_axis(const StartStopTime& row);

/// A machine and a lamp.
struct Machine {
  double lamp_hz, accel_m_s2, speed_m_s;

  /// The beats of start-stop depend on this ratio only: a / f^2, um.
  double way_um() const { return accel_m_s2 / (lamp_hz * lamp_hz) * 1e6; }
};

/// Figures of a walk in a plane with the step lengths of the object.
Figures walk_figures(const Machine& machine, int points, std::uint64_t seed,
                     const PointsPlanned& planned = {});
/// The walks for the grading of planning.
inline constexpr std::array<Machine, 4> graded_walks{
    {{100, 2, 0.1}, {100, 4, 0.1}, {100, 10, 0.1}, {200, 10, 1}}};
inline constexpr int graded_points = 10'000;

/// Jerk limits whose cost is measured, m/s3, 0 = none: by free planning of a walk, and in path mode
/// on a straight row of the thesis below, with at most as many points.
inline constexpr std::array<double, 8> jerk_limits{0, 100'000, 5000, 2000, 1000, 500, 200, 100};
inline constexpr std::array<Machine, 6> jerk_machines{
    {{100, 2, 0.1}, {100, 4, 0.1}, {100, 10, 0.1}, {200, 10, 1}, {1000, 10, 1}, {4000, 10, 1}}};
using JerkBeats = std::array<double, jerk_limits.size()>;
JerkBeats jerk_beats(const Machine& machine, wire::JoinMode mode, int points, std::uint64_t seed,
                     const PointsPlanned& planned = {});

/// The example of the thesis on CNC systems for pulsed lasers (BSUIR Minsk).
inline constexpr Machine pulse_machine{40, 0.3, 0.03};
inline constexpr int pulse_points = 1200;
/// One of its courses, with the allowed jump of an axis' speed at a corner in path mode.
struct PulseCourse {
  const char* name;
  Course shape;
  double corner_jump_mm_s;
};
inline constexpr std::array<PulseCourse, 5> pulse_courses{
    {{"straight", Course::straight, 0},
     {"circle", Course::circle, 0},
     {"right angle every 15 points, full stop", Course::stairs, 0},
     {"right angle every 15 points, jump of 0.75 mm/s", Course::stairs, 0.75},
     {"turning back by 120 degrees every 15 points", Course::zigzag, 0}}};
/// Distances between its points are random, and single draws differ by up to 0.01 beats a point:
/// the figures are means over this number of draws.
inline constexpr int pulse_draws = 40;
/// Means over draws of a seed; different seeds have different draws, and those of seed 1 are 1,
/// 2, 3...
Figures course_figures(const PulseCourse& row, int draws, std::uint64_t seed,
                       const PointsPlanned& planned = {});

}  // namespace lamplock::bench
