// The streams of points that planning is measured on.
//
// In:  numbers of points, a seed. Out: targets in steps, from the machine's zero on; the same for
//      the reference planner. Same seed, same points.
// Who: `lamplock bench`, the golden tests.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/target.hpp"
#include "host/bench/reference_planner.hpp"

namespace lamplock::bench {

/// Whole numbers of steps per bin of the histogram (glass_tables.hpp) that add up to `total`, by
/// largest remainder: a random draw misses the fractions by more than what is to be shown.
std::vector<int> step_counts(int total);

/// Walk with these step lengths, shuffled, in uniformly random directions.
std::vector<motion::Target> histogram_walk(int points, int axes, double steps_per_mm,
                                           std::uint64_t seed);

/// Paths of the thesis on CNC systems for pulsed lasers (BSUIR Minsk): points 100-150 um apart.
enum class Course : std::uint8_t {
  straight,  ///< one row along x
  circle,    ///< once round, whatever the number of points
  stairs,    ///< along x and y by turns, a right angle at every 15th point
  zigzag     ///< turns back by 120 degrees at every 15th point
};
std::vector<motion::Target> course(Course shape, int points, double steps_per_mm,
                                   std::uint64_t seed);
/// Points from corner to corner.
inline constexpr int corner_every = 15;

/// The same sequence for the reference, with the true limits. The start is the machine's zero.
ReferenceProblem problem_of(const motion::Limits& limits,
                            const std::vector<motion::Target>& targets);

}  // namespace lamplock::bench
