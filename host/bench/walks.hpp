// The streams of points for the measurement of planning.
//
// In:  numbers of points, a seed. Out: targets in steps, beginning at the machine's zero; the same
//      for the reference planner. Same seed, same points.
// Who: `lamplock bench`, the golden tests.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "firmware/motion/profile/limits.hpp"
#include "host/bench/reference_planner.hpp"
#include "shared/wire/target.hpp"

namespace lamplock::bench {

/// Whole numbers of steps per bin of the histogram (glass_tables.hpp) with the sum `total`, by
/// largest remainder: random draws would have larger errors than the effects to be measured.
std::vector<int> step_counts(int total);

/// Walk with these step lengths, shuffled, in uniformly random directions.
std::vector<wire::Target> histogram_walk(int points, int axes, double steps_per_mm,
                                         std::uint64_t seed);

/// Paths of the thesis on CNC systems for pulsed lasers (BSUIR Minsk): points 100-150 um apart.
enum class Course : std::uint8_t {
  straight,  ///< one row along x
  circle,    ///< one full circle, for any number of points
  stairs,    ///< along x and y by turns, a right angle at every 15th point
  zigzag     ///< turns back by 120 degrees at every 15th point
};
std::vector<wire::Target> course(Course shape, int points, double steps_per_mm, std::uint64_t seed);
/// Number of points from corner to corner.
inline constexpr int corner_every = 15;

/// The same sequence for the reference, with the true limits. The start is the machine's zero.
ReferenceProblem problem_of(const motion::Limits& limits, const std::vector<wire::Target>& targets);

}  // namespace lamplock::bench
