// Optimises the feed of a program or polyline by jerk functions.
//
// In:  a file, limits, a law of the jerk, drives to simulate. Out: a program with a feed for each
//      piece, intermediate points, a chart, a comparison. Who: `jerk`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/run/feed_comparison.hpp"
#include "host/run/feed_learning.hpp"
#include "host/run/frontend.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::run {

/// Drives of a usual machine with ball screws: 1 um a pulse, 0.25 um a count.
inline program_run::ServoMachine feed_drives() {
  program_run::ServoMachine machine;
  machine.drive.steps_per_rev = 10'000;
  machine.drive.mm_per_rev = 10;
  machine.drive.counts_per_rev = 40'000;
  return machine;
}

struct FeedOptions {
  std::string input{};
  std::string output{}, points{}, chart{};  ///< G-code, CSV, SVG; empty: none
  MachineOptions machine{};
  feed_optimiser::Variant variant = feed_optimiser::Variant::strict;
  feed_optimiser::JerkLaw law{};
  double period_ms = feed_optimiser::example_period_ms;
  /// One number for all axes, or one for each. Empty: those of the machine's file, else of the
  /// patent's example.
  std::vector<double> speed_mm_s{}, accel_mm_s2{}, jerk_mm_s3{};
  double piece_ms = 20;  ///< of the written program
  bool compare = true, learn = false;
  program_run::ServoMachine drives = feed_drives();
};

struct OptimisedFeed {
  feed_optimiser::Method method{};
  std::vector<feed_optimiser::OptimisedBlock> blocks{};
  std::vector<ComparedFeed> compared{};
  std::optional<FeedLearned> learned{};
  std::optional<MachineTimes> on_machine{};  ///< with a file of a machine
  double time_s = 0;
};

/// Writes the outputs and shows the results. Throws Error.
OptimisedFeed optimise_feed(const FeedOptions& options, Frontend& frontend);

}  // namespace lamplock::run
