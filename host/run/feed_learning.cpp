#include "host/run/feed_learning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/error.hpp"

namespace lamplock::run {
namespace {

using feed_optimiser::Block;
using feed_optimiser::FeedProgram;
using feed_optimiser::JerkLaw;
using feed_optimiser::Method;
using feed_optimiser::OptimisedBlock;

/// Differences of errors below a ten-thousandth of a micrometre are rounding.
constexpr double same_square_mm2 = 1e-14;

/// Mean square of the distance beside the path in each block.
std::vector<double> mean_squares(const BoardMotion& motion, const std::vector<Block>& blocks) {
  std::vector<double> squares(blocks.size()), counts(blocks.size());
  std::size_t block = 0;
  double end = blocks.front().length_mm;
  for (std::size_t i = 0; i < motion.beside_mm.size(); ++i) {
    while (motion.distance_mm[i] > end && block + 1 < blocks.size())
      end += blocks[++block].length_mm;
    squares[block] += motion.beside_mm[i] * motion.beside_mm[i];
    ++counts[block];
  }
  for (std::size_t b = 0; b < squares.size(); ++b)
    if (counts[b] > 0) squares[b] /= counts[b];
  return squares;
}

LearnedLaw measured(const JerkLaw& law, const BoardMotion& motion) {
  return {law, motion.time_s, motion.error};
}

/// The whole program with one law.
BoardMotion run_with(const FeedProgram& program, const std::vector<OptimisedBlock>& blocks,
                     const program_run::ServoMachine& machine, double piece_s,
                     const std::string& name) {
  return run_on_drives(
      optimised_program(program, blocks, program.start.value_or(geometry::Point{}), piece_s),
      machine, name);
}

}  // namespace

std::vector<JerkLaw> candidate_laws(const JerkLaw& given) {
  std::vector<JerkLaw> laws{given};
  const auto add = [&laws](const JerkLaw& law) {
    if (std::find(laws.begin(), laws.end(), law) == laws.end()) laws.push_back(law);
  };
  // The pairs of the patent's tables, with its best steps and those of its tables.
  for (const auto& [n, k] : {std::pair{given.n, given.k}, {2.0, 7.0}, {14.0, 2.0}})
    for (const auto& [a, b] :
         {std::pair{0.05, 0.05}, {0.0, 0.05}, {0.05, 0.0}, {0.0, 0.1}, {1.0, 0.0}})
      add({n, k, a, b});
  return laws;
}

FeedLearned learn_feed(const FeedProgram& program, const Method& method,
                       const program_run::ServoMachine& drives, double piece_s,
                       const std::string& name, Frontend& frontend) {
  if (!moves_only_xy(program))
    throw Error(Exit::bad_input, name, "moves Z, and the simulated drives have only X and Y",
                "leave out the moves in Z for the learning run");
  const program_run::ServoMachine machine = drives_with(drives, method, JerkLimit::program);
  const std::vector<Block> blocks = program.all_blocks();
  FeedLearned learned;
  std::vector<double> best(blocks.size(), std::numeric_limits<double>::max());
  const std::vector<JerkLaw> laws = candidate_laws(method.law);
  const auto progress = frontend.progress("laws tried", laws.size(), 0);
  for (const JerkLaw& law : laws) {
    Method other = method;
    other.law = law;
    const std::vector<OptimisedBlock> optimised = feed_optimiser::optimise(blocks, other, name);
    const BoardMotion motion = run_with(program, optimised, machine, piece_s, name);
    learned.candidates.push_back(measured(law, motion));
    if (learned.blocks.empty()) learned.blocks = optimised;
    const std::vector<double> squares = mean_squares(motion, blocks);
    for (std::size_t b = 0; b < blocks.size(); ++b)
      if (squares[b] < best[b] - same_square_mm2) {
        best[b] = squares[b];
        learned.blocks[b] = optimised[b];
      }
    progress->update(learned.candidates.size());
  }
  learned.after = measured(method.law, run_with(program, learned.blocks, machine, piece_s, name));
  const program_run::ContourError &before = learned.candidates.front().error,
                                  &after = learned.after.error;
  learned.mean_falls = after.mean_mm < before.mean_mm;
  learned.deviation_falls = after.deviation_mm < before.deviation_mm;
  return learned;
}

}  // namespace lamplock::run
