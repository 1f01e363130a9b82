// Optimises the feed of a path: a profile of the jerk for each block, from rest to rest.
//
// In:  blocks, limits of the axes, the law of the jerk, the control period. Out: profiles, and the
//      place at each step of control. Who: `lamplock jerk`, the benchmark, tests.
//
// Limited jerk permits no corner at a speed: the jump v |u2 - u1| of the speed within one control
// period T is a jerk of v |u2 - u1| / T^2. So each block begins and ends at rest, and blocks in one
// direction are one block (join_straight()).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/feed_optimiser/block.hpp"
#include "host/feed_optimiser/profile.hpp"

namespace lamplock::feed_optimiser {

struct Method {
  Variant variant = Variant::strict;
  JerkLaw law{};
  double period_s = 0;
  AxisLimits limits{};
};

/// Limits and period of the example in patent PL 242312 B1, recomputed from its tables: speeds of
/// 19.3 to 19.9 mm/s along the line are 17.3 to 17.8 mm/s of X; dt^3 = 1.10328e-8 with the jerk in
/// mm/s3; 10 000 mm/s3 on both axes. Its limit of the acceleration is not reached and not known.
inline constexpr double example_speed_mm_s = 17.5, example_accel_mm_s2 = 1000,
                        example_jerk_mm_s3 = 10'000, example_period_ms = 2.2261884;

struct OptimisedBlock {
  Block block{};
  Task task{};
  Profile profile{};
  std::shared_ptr<const LawTable> table{};

  double seconds() const { return static_cast<double>(profile.steps()) * table->period_s(); }
};

/// The table of a law for all blocks under these limits. Throws Error(bad_input) for a method that
/// is not possible.
std::shared_ptr<const LawTable> law_table(const Method& method);

/// `file` names the program in errors. Throws Error(bad_input) for a block that takes less than a
/// control period, or too many of them.
OptimisedBlock optimise_block(const Block& block, const Method& method,
                              const std::shared_ptr<const LawTable>& table,
                              const std::string& file);
std::vector<OptimisedBlock> optimise(std::span<const Block> blocks, const Method& method,
                                     const std::string& file);

/// Joins straight blocks of one direction, feed and kind, and drops those without a length.
std::vector<Block> join_straight(std::span<const Block> blocks, const Method& method);

/// Places before the first step and after each step.
std::vector<Point> places(const OptimisedBlock& optimised);

}  // namespace lamplock::feed_optimiser
