// The learning run: chooses a law of the jerk for each block by the errors of simulated drives.
//
// In:  a program, candidates. Out: a law for each block, and the contour error before and after.
// Who: optimise_feed().
//
// Each candidate runs the whole program. A sample belongs to the block in which the way along the
// path is. Each block gets the law with the smallest root mean square of the distance beside the
// path, which mean and standard deviation are parts of; of equal ones the first.
#pragma once

#include <vector>

#include "host/run/feed_comparison.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

struct LearnedLaw {
  feed_optimiser::JerkLaw law{};
  double time_s = 0;  ///< on the board
  program_run::ContourError error{};
};

struct FeedLearned {
  std::vector<LearnedLaw> candidates{};  ///< the given law first
  std::vector<feed_optimiser::OptimisedBlock> blocks{};
  LearnedLaw after{};  ///< its law has no meaning: each block has its own
  bool mean_falls = false, deviation_falls = false;  ///< against the given law
};

/// The laws that are tried: growth of a and b by 0.05 first, which the patent found best.
std::vector<feed_optimiser::JerkLaw> candidate_laws(const feed_optimiser::JerkLaw& given);

/// Throws Error(bad_input) for a program that does not move in X and Y only.
FeedLearned learn_feed(const feed_optimiser::FeedProgram& program,
                       const feed_optimiser::Method& method,
                       const program_run::ServoMachine& drives, double piece_s,
                       const std::string& name, Frontend& frontend);

}  // namespace lamplock::run
