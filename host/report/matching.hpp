// Finds the point of each shot, by the rules in report.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/report/report.hpp"

namespace lamplock::report {

/// Index for no point.
inline constexpr std::uint32_t no_point = UINT32_MAX;

/// Result of matching shots to points.
struct Matching {
  std::vector<std::uint32_t> point_of_shot;  ///< no_point only if the job has no points
  std::uint64_t missed = 0;                  ///< points fired less often than ordered
  std::uint64_t doubled = 0;                 ///< shots beyond those ordered
};

/// Wanted position of a point of the stage in steps, not rounded, in the axes of points.
inline constexpr std::size_t point_axes = 3;
using WantedSteps = std::array<double, point_axes>;
WantedSteps wanted_steps(const geometry::Point& point, const PerAxis<double>& steps_per_mm);

/// Largest distance over the axes between a position and a wanted one, in steps.
double error_steps(const StepPosition& steps, const WantedSteps& wanted);

/// Matches every shot of a run.
Matching match_shots(const JobRun& run);

}  // namespace lamplock::report
