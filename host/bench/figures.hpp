// What planning gains, in beats per point: the figures of the table of `lamplock bench`.
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

#include "firmware/motion/limits.hpp"
#include "firmware/motion/target.hpp"
#include "host/bench/glass_tables.hpp"
#include "host/bench/walks.hpp"

namespace lamplock::bench {

/// Beats per point of one stream, planned in every way.
struct Figures {
  double start_stop = 0;
  std::optional<double> path;  ///< nothing where the firmware cannot plan it
  double free = 0;
  double optimum = 0;  ///< exact: no plan needs fewer
  double labels = 0;   ///< of the search for the optimum, per point

  /// How many per cent more beats than the optimum free planning takes.
  double gap_percent() const { return 100 * (free / optimum - 1); }
  /// Per cent of the time of start-stop that free planning saves.
  double saved_percent() const { return 100 * (1 - free / start_stop); }
};

/// Told how many points have been planned since the last call.
using PointsPlanned = std::function<void(std::size_t)>;

/// Plans one stream. Throws std::runtime_error if a point cannot be reached.
Figures figures_of(const motion::Limits& limits, const std::vector<motion::Target>& targets,
                   const PointsPlanned& planned = {});

/// Beats per point that were measured.
double measured_beats(const StartStopTime& row);
/// Beats of our start-stop for one step along one axis, on the machine of a measured row. Steps of
/// the machine are 1 um; a time that is a whole number of beats to the last digit counts as
/// reached.
double start_stop_beats(const StartStopTime& row, double step_um);
/// Beats per point of our start-stop for all step lengths of the object along one axis, as its
/// histogram was fitted.
double start_stop_on_one_axis(const StartStopTime& row);

/// A machine and a lamp.
struct Machine {
  double lamp_hz, accel_m_s2, speed_m_s;

  /// On this ratio alone the beats of start-stop depend: a / f^2, um.
  double way_um() const { return accel_m_s2 / (lamp_hz * lamp_hz) * 1e6; }
};

/// Figures of a walk in a plane with the step lengths of the object.
Figures walk_figures(const Machine& machine, int points, std::uint64_t seed,
                     const PointsPlanned& planned = {});
/// The walks that planning is graded on.
inline constexpr std::array<Machine, 4> graded_walks{
    {{100, 2, 0.1}, {100, 4, 0.1}, {100, 10, 0.1}, {200, 10, 1}}};
inline constexpr int graded_points = 10'000;

/// What a limit of jerk costs, under each of these, m/s3, 0 = none: free planning of a walk; path
/// mode on a straight row of the thesis below, as long as there at most.
inline constexpr std::array<double, 8> jerk_limits{0, 100'000, 5000, 2000, 1000, 500, 200, 100};
inline constexpr std::array<Machine, 6> jerk_machines{
    {{100, 2, 0.1}, {100, 4, 0.1}, {100, 10, 0.1}, {200, 10, 1}, {1000, 10, 1}, {4000, 10, 1}}};
using JerkBeats = std::array<double, jerk_limits.size()>;
JerkBeats jerk_beats(const Machine& machine, motion::JoinMode mode, int points, std::uint64_t seed,
                     const PointsPlanned& planned = {});

/// The example of the thesis on CNC systems for pulsed lasers (BSUIR Minsk).
inline constexpr Machine pulse_machine{40, 0.3, 0.03};
inline constexpr int pulse_points = 1200;
/// One of its courses; the speed of an axis may jump by so much at a corner in path mode.
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
/// Distances between its points are drawn, and single draws differ by up to 0.01 beats a point:
/// what is shown are means over so many.
inline constexpr int pulse_draws = 40;
/// Means over draws of a seed; no two seeds share one, and those of seed 1 are 1, 2, 3...
Figures course_figures(const PulseCourse& row, int draws, std::uint64_t seed,
                       const PointsPlanned& planned = {});

}  // namespace lamplock::bench
