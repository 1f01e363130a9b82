// The temperature along the path of a program, and what to change where it becomes too hot.
//
// In:  a material, a beam, moves with speed and power. Out: the temperature of the hottest place at
//      each time, the largest one of each line, proposals of power or feed. Who: `lamplock heat
//      PROGRAM`.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "host/thermal/beam_motion.hpp"
#include "host/thermal/moving_field.hpp"

namespace lamplock::thermal {

struct PathSetup {
  Body body{};
  Surface surface{};
  BeamProfile beam{};
  Meshing meshing{};
  std::optional<double> thickness_mm{};  ///< none: thick
  double accel_mm_s2 = 500, deviation_mm = 0.01;
};

/// At the end of a time step.
struct PathSample {
  double time_s = 0;
  std::size_t move = 0;
  double x = 0, y = 0;  ///< the middle of the beam
  double speed_mm_s = 0, power_w = 0;
  double max_k = 0;     ///< of the surface
  double rate_k_s = 0;  ///< change of max_k over the step
};

struct PathResult {
  std::vector<PathSample> samples{};
  EnergyBalance balance{};
  double seconds = 0, depth_mm = 0;
};

/// Number of time steps that run_path() would make.
std::size_t path_steps(const std::vector<BeamMove>& moves, const PathSetup& setup);

/// Called at the end of each step. False ends the run.
using EachStep = std::function<bool(const PathSample&, const MovingField&)>;
PathResult run_path(const std::vector<BeamMove>& moves, const PathSetup& setup,
                    const EachStep& each_step = {});

/// The hottest moment of the moves of one line of the program.
struct LineHeat {
  std::size_t line = 0;
  PathSample hottest{};
  double power_w = 0, speed_mm_s = 0;  ///< programmed
};
/// Lines with light, in their order in the program.
std::vector<LineHeat> hottest_of_lines(const std::vector<BeamMove>& moves,
                                       const PathResult& result);
/// The median over the lines, weighted by their time: the temperature of the undisturbed path.
double usual_temperature_k(const std::vector<BeamMove>& moves, const PathResult& result);

/// A line above the limit, and what lowers it to the limit: either the power or the feed.
struct Overheated {
  LineHeat heat{};
  double power_factor = 1;  ///< the rise is proportional to the power
  /// A fast beam heats in proportion to 1/sqrt(v): the feed grows by the square. Empty where the
  /// beam is at rest or slower than the feed at the hottest moment, as in turns and stops.
  std::optional<double> feed_factor{};

  std::optional<double> feed_mm_min() const {
    constexpr double s_per_min = 60;
    if (!feed_factor) return std::nullopt;
    return heat.speed_mm_s * *feed_factor * s_per_min;
  }
};
std::vector<Overheated> overheated_lines(const std::vector<LineHeat>& lines, double limit_k,
                                         double ambient_k);
/// The moves with the proposed feeds.
std::vector<BeamMove> with_proposed_feed(std::vector<BeamMove> moves,
                                         const std::vector<Overheated>& lines);
/// Removes the proposals of feeds with which, in a run with all of them, a line stays above the
/// limit by more than 5 % of the rise.
void keep_effective_feeds(std::vector<Overheated>& lines, const std::vector<LineHeat>& with_feeds,
                          double limit_k, double ambient_k);
/// The moves with the proposed powers.
std::vector<BeamMove> with_proposed_power(std::vector<BeamMove> moves,
                                          const std::vector<Overheated>& lines);

}  // namespace lamplock::thermal
