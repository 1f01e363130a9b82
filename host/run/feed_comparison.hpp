// Compares an optimised feed with the firmware's own plan and with the time optimum.
//
// In:  a program before and after the optimisation, limits, simulated servo drives. Out: time,
//      largest jerk and contour error of each. Who: optimise_feed(), learn_feed().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/feed_optimiser/feed_program.hpp"
#include "host/program/servo_errors.hpp"
#include "host/program/servo_run.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

/// One program on the simulated board and drives.
struct BoardMotion {
  double time_s = 0;
  double max_jerk_mm_s3 = 0;  ///< of one axis, by the plan of the board at the control periods
  program_run::ContourError error{};
  std::vector<double> beside_mm{}, distance_mm{};  ///< per sample: error, way along the path
};

/// A row of the table; no board: a plan without it.
struct ComparedFeed {
  std::string name;
  std::optional<double> time_s{}, max_jerk_mm_s3{};  ///< of the plan
  std::optional<BoardMotion> board{};
};

/// Who limits the jerk: the board in its plan, or the program with its feeds.
enum class JerkLimit { board, program };

/// The drives with these limits. Their pulses and dynamics are those of `machine`.
program_run::ServoMachine drives_with(const program_run::ServoMachine& machine,
                                      const feed_optimiser::Method& method, JerkLimit by);

/// Runs G-code in X and Y. Throws Error.
BoardMotion run_on_drives(const std::string& text, const program_run::ServoMachine& machine,
                          const std::string& name);
/// Simulated drives have two axes.
bool moves_only_xy(const feed_optimiser::FeedProgram& program);

/// Time and largest jerk of optimised blocks at the steps of control.
ComparedFeed planned_feed(const std::string& name,
                          const std::vector<feed_optimiser::OptimisedBlock>& blocks,
                          const feed_optimiser::Method& method);

/// The firmware's own plan, both variants, and the optimum. Throws Error.
std::vector<ComparedFeed> compare_feeds(const feed_optimiser::FeedProgram& program,
                                        const feed_optimiser::Method& method,
                                        const program_run::ServoMachine& drives, double piece_s,
                                        const std::string& name, Frontend& frontend);

/// Times of a program on a machine with its own settings.
struct MachineTimes {
  double unchanged_s = 0, optimised_s = 0;
};
/// Throws Error(bad_input) about `name` if the machine refuses one of the programs.
MachineTimes times_on_machine(const feed_optimiser::FeedProgram& program,
                              const std::vector<feed_optimiser::OptimisedBlock>& blocks,
                              const feed_optimiser::Method& method, const settings::Values& values,
                              double piece_s, const std::string& name);

/// The table as text, lines with their ends.
std::string feed_table(const std::vector<ComparedFeed>& rows);

}  // namespace lamplock::run
