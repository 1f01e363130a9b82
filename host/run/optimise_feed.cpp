#include "host/run/optimise_feed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "host/duration_text.hpp"
#include "host/error.hpp"
#include "host/feed_optimiser/motion_chart.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/geometry/limits.hpp"
#include "host/number_text.hpp"
#include "host/output_error.hpp"
#include "host/run/feed_input.hpp"
#include "host/run/sent_file.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using feed_optimiser::FeedProgram;
using feed_optimiser::Method;
using feed_optimiser::OptimisedBlock;
using feed_optimiser::Variant;
using settings::Id;

/// A sample of the drives at each control period has to be kept.
constexpr double max_simulated_s = 1200;

void check_targets(const FeedOptions& options) {
  require_extension(options.chart, ".svg", "charts are written as SVG");
  if (!options.output.empty()) check_program_name(options.output);
  for (const std::string& file : {options.output, options.points, options.chart})
    if (!file.empty()) check_target(file);
}

feed_optimiser::PerAxis limits_of(const std::vector<double>& given, const std::string& name,
                                  const job::Profile* profile, Id setting, double unit,
                                  double example) {
  feed_optimiser::PerAxis limits;
  limits.fill(example);
  if (given.size() == 1) limits.fill(given.front());
  if (given.size() == 2)
    throw Error(Exit::bad_input, name, "has two numbers, not one or three",
                "give one for all axes, or three");
  if (given.size() == limits.size()) std::copy(given.begin(), given.end(), limits.begin());
  if (!given.empty() || profile == nullptr) return limits;
  for (int a = 0; a < static_cast<int>(limits.size()); ++a) {
    const double value = in_units(profile->settings, setting, a) * unit;
    if (value > 0) limits[static_cast<std::size_t>(a)] = value;
  }
  return limits;
}

Method method_of(const FeedOptions& options, const job::Profile& profile) {
  constexpr double min_per_s = 1.0 / 60, mm_per_m = 1000;
  Method method{options.variant, options.law, options.period_ms / 1e3, {}};
  const job::Profile* given = options.machine.machine.empty() ? nullptr : &profile;
  method.limits = {limits_of(options.speed_mm_s, "--max-speed", given, Id::max_rate_x, min_per_s,
                             feed_optimiser::example_speed_mm_s),
                   limits_of(options.accel_mm_s2, "--max-accel", given, Id::acceleration_x, 1,
                             feed_optimiser::example_accel_mm_s2),
                   limits_of(options.jerk_mm_s3, "--max-jerk", given, Id::jerk_x, mm_per_m,
                             feed_optimiser::example_jerk_mm_s3)};
  return method;
}

/// Equal drives stay on a straight line whatever its feed: Y is 10 % slower than X, which is an
/// assumption.
program_run::ServoMachine drives_of(const FeedOptions& options) {
  constexpr double y_over_x = 1.1;
  program_run::ServoMachine drives = options.drives;
  if (!drives.time_constant_y_ms)
    drives.time_constant_y_ms = y_over_x * drives.drive.time_constant_ms;
  return drives;
}

void require_total(const std::vector<OptimisedBlock>& blocks, const std::string& file) {
  double steps = 0;
  for (const OptimisedBlock& block : blocks) steps += static_cast<double>(block.profile.steps());
  if (steps <= static_cast<double>(geometry::max_points)) return;
  throw Error(Exit::bad_input, file,
              fmt::format("takes {:.3g} control periods, at most {} are possible", steps,
                          geometry::max_points),
              "lengthen the control period or divide the program");
}

double seconds_of(const std::vector<OptimisedBlock>& blocks) {
  double seconds = 0;
  for (const OptimisedBlock& block : blocks) seconds += block.seconds();
  return seconds;
}

void require_short(double planned_s, const std::string& file) {
  if (planned_s <= max_simulated_s) return;
  throw Error(Exit::bad_input, file,
              fmt::format("takes {}, and the learning run simulates at most {}",
                          duration_text(planned_s), duration_text(max_simulated_s)),
              "divide the program");
}

void write_points(const std::filesystem::path& path, const std::vector<OptimisedBlock>& blocks) {
  std::ofstream out(path, std::ios::binary);
  feed_optimiser::points_csv(blocks, [&](std::string_view text) {
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
  });
  out.close();
  if (!out) throw OutputError(path, errno);
}

void write_outputs(const FeedOptions& options, const FeedProgram& program,
                   const OptimisedFeed& feed, Frontend& frontend) {
  const auto write_with = [&](const std::string& file, const char* what, const auto& writer) {
    if (file.empty()) return;
    write_whole(file, writer);
    frontend.say("{:<9} {}", what, file);
  };
  const auto write = [&](const std::string& file, const char* what, const auto& text) {
    write_with(file, what, [&](const std::filesystem::path& path) { write_file(path, text()); });
  };
  write(options.output, "program",
        [&] { return optimised_program(program, feed.blocks, {}, options.piece_ms / 1e3); });
  write_with(options.points, "points",
             [&](const std::filesystem::path& path) { write_points(path, feed.blocks); });
  write(options.chart, "chart", [&] {
    return feed_optimiser::motion_chart(
        feed.blocks, feed.method,
        fmt::format("{}, {}, n={:g} k={:g}",
                    std::filesystem::path(options.input).filename().string(),
                    options.variant == Variant::printed ? "printed" : "strict", options.law.n,
                    options.law.k));
  });
}

void say_learned(const FeedLearned& learned, Frontend& frontend) {
  const auto row = [&](const std::string& name, const LearnedLaw& law) {
    frontend.say("{:<44}{:10.3f} s  mean {:.5f} mm  std {:.5f} mm", name, law.time_s,
                 law.error.mean_mm, law.error.deviation_mm);
  };
  frontend.line("");
  frontend.line("learning run: contour error on the simulated drives");
  for (const LearnedLaw& law : learned.candidates)
    row(fmt::format("n={:g} k={:g}, steps of a {:g}, of b {:g}", law.law.n, law.law.k,
                    law.law.step_a, law.law.step_b),
        law);
  row("a law for each block", learned.after);
  const auto verb = [](bool falls) { return falls ? "falls" : "does not fall"; };
  frontend.say("against n={:g} k={:g} for all blocks, the mean {} and the spread {}",
               learned.candidates.front().law.n, learned.candidates.front().law.k,
               verb(learned.mean_falls), verb(learned.deviation_falls));
}

/// A machine that limits the jerk does so once more at each piece of the program.
void say_machine(const MachineTimes& times, const job::Profile& profile, Frontend& frontend) {
  frontend.say("machine   {} with these feeds, {} unchanged", duration_text(times.optimised_s),
               duration_text(times.unchanged_s));
  bool limits_jerk = false;
  for (int a = 0; a < static_cast<int>(feed_optimiser::axes); ++a)
    limits_jerk = limits_jerk || in_units(profile.settings, Id::jerk_x, a) > 0;
  if (limits_jerk)
    frontend.notice(
        "the machine limits the jerk by itself, at each piece of the new program once more: set "
        "its jerk_x, jerk_y and jerk_z ($1081 to $1083) to 0 for this program");
}

/// The table is not needed for the program: without it the results are complete.
void compare(const FeedOptions& options, const FeedProgram& program,
             const program_run::ServoMachine& drives, OptimisedFeed& feed, Frontend& frontend) {
  const double planned_s = seconds_of(feed.blocks);
  if (planned_s > max_simulated_s) {
    frontend.notice(fmt::format("no comparison: it simulates at most {} of motion",
                                duration_text(max_simulated_s)));
    return;
  }
  try {
    feed.compared =
        compare_feeds(program, feed.method, drives,
                      std::max(options.piece_ms, options.period_ms) / 1e3, options.input, frontend);
    frontend.text(feed_table(feed.compared));
    if (!moves_only_xy(program))
      frontend.notice(
          "times and errors of drives are missing: the simulated drives move X and Y only");
  } catch (const Error& error) {
    frontend.notice(
        fmt::format("no comparison: the simulated board cannot run with these limits "
                    "({})",
                    error.message()));
  }
}

void say_results(const OptimisedFeed& feed, Frontend& frontend) {
  std::size_t steps = 0;
  for (const OptimisedBlock& block : feed.blocks) steps += block.profile.steps();
  frontend.say("time      {}", duration_text(feed.time_s));
  frontend.say("blocks    {}, {} of {:g} ms", grouped(feed.blocks.size()),
               count_text(steps, "control period"), feed.method.period_s * 1e3);
}

}  // namespace

OptimisedFeed optimise_feed(const FeedOptions& options, Frontend& frontend) {
  check_targets(options);
  const program_run::ServoMachine drives = drives_of(options);
  job::Profile profile = options.machine.profile();
  // Without a machine, M3 and M4 are those of a laser: the power of M4 follows the feed, which
  // changes, and too much of it burns the workpiece.
  if (options.machine.machine.empty())
    job::state_setting(profile, Id::laser_mode, 1, options.input);
  OptimisedFeed feed;
  feed.method = method_of(options, profile);
  feed_optimiser::law_table(feed.method);
  const bool has_machine = !options.machine.machine.empty();
  FeedProgram program = read_feed_program(options.input, profile, has_machine);
  for (const std::string& remark : program.remarks) frontend.notice(remark);
  join_straight(program, feed.method);
  feed.blocks = feed_optimiser::optimise(program.all_blocks(), feed.method, options.input);
  require_total(feed.blocks, options.input);
  const double piece_s = std::max(options.piece_ms, options.period_ms) / 1e3;
  if (options.learn) {
    require_short(seconds_of(feed.blocks), options.input);
    feed.learned = learn_feed(program, feed.method, drives, piece_s, options.input, frontend);
    if (feed.learned->mean_falls || feed.learned->deviation_falls)
      feed.blocks = feed.learned->blocks;
  }
  feed.time_s = seconds_of(feed.blocks);
  say_results(feed, frontend);
  if (has_machine) {
    feed.on_machine = times_on_machine(program, feed.blocks, feed.method, profile.settings, piece_s,
                                       options.input);
    say_machine(*feed.on_machine, profile, frontend);
  }
  if (options.compare) compare(options, program, drives, feed, frontend);
  if (feed.learned) say_learned(*feed.learned, frontend);
  write_outputs(options, program, feed, frontend);
  return feed;
}

}  // namespace lamplock::run
