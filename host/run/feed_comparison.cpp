#include "host/run/feed_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/error.hpp"
#include "host/feed_optimiser/motion_meter.hpp"
#include "host/feed_optimiser/time_optimum.hpp"
#include "host/job/profile.hpp"
#include "host/program/program_run.hpp"

namespace lamplock::run {
namespace {

using feed_optimiser::Block;
using feed_optimiser::FeedProgram;
using feed_optimiser::Method;
using feed_optimiser::MotionMeter;
using feed_optimiser::OptimisedBlock;
using feed_optimiser::Part;
using feed_optimiser::Variant;
using program_run::ServoMachine;
using program_run::ServoRun;
using program_run::ServoSample;

double largest(const feed_optimiser::PerAxis& values) {
  return *std::max_element(values.begin(), values.end());
}

ComparedFeed optimum_of(const std::vector<Block>& blocks, const Method& method) {
  double time_s = 0, jerk = 0;
  for (const Block& block : blocks)
    time_s += feed_optimiser::optimum_s(block.length_mm,
                                        feed_optimiser::path_limits(block, method.limits));
  for (std::size_t a = 0; a < feed_optimiser::axes; ++a)
    for (const Block& block : blocks)
      if (std::abs(block.to.x - block.from.x) * (a == 0) +
              std::abs(block.to.y - block.from.y) * (a == 1) +
              std::abs(block.to.z - block.from.z) * (a == 2) >
          0)
        jerk = std::max(jerk, method.limits.jerk_mm_s3[a]);
  return {"time optimum, stop at each end", time_s, jerk, {}};
}

/// The time of the firmware's plan, without drives.
double firmware_s(const std::string& text, const Method& method) {
  constexpr double mm_per_m = 1000, s_per_min = 60;
  using settings::Id;
  job::Profile profile;
  job::state_setting(profile, Id::soft_limits, 0, "limits");
  for (int a = 0; a < static_cast<int>(feed_optimiser::axes); ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const auto state = [&](Id id, double value) {
      job::state_setting(profile, settings::for_axis(id, a), value, "limits");
    };
    state(Id::max_rate_x, method.limits.speed_mm_s[axis] * s_per_min);
    state(Id::acceleration_x, method.limits.accel_mm_s2[axis]);
    state(Id::jerk_x, method.limits.jerk_mm_s3[axis] / mm_per_m);
  }
  return program_run::run_program(text, profile.settings, 1).seconds();
}

}  // namespace

ServoMachine drives_with(const ServoMachine& machine, const Method& method, JerkLimit by) {
  ServoMachine drives = machine;
  drives.sample_s = method.period_s;
  drives.limits.emplace();
  for (std::size_t a = 0; a < program_run::servo_axes; ++a)
    (*drives.limits)[a] = {method.limits.speed_mm_s[a], method.limits.accel_mm_s2[a],
                           by == JerkLimit::board ? method.limits.jerk_mm_s3[a] : 0};
  return drives;
}

BoardMotion run_on_drives(const std::string& text, const ServoMachine& machine,
                          const std::string& name) {
  const ServoRun run = program_run::run_on_servos(text, machine, name);
  BoardMotion motion;
  motion.time_s = run.moving_s;
  MotionMeter meter(machine.sample_s);
  double way = 0;
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    const ServoSample& sample = run.samples[i];
    meter.add({sample.axis[0].programmed, sample.axis[1].programmed, 0});
    if (i > 0) {
      const ServoSample& before = run.samples[i - 1];
      way += std::hypot(sample.axis[0].programmed - before.axis[0].programmed,
                        sample.axis[1].programmed - before.axis[1].programmed);
    }
    motion.distance_mm.push_back(way);
    motion.beside_mm.push_back(program_run::beside_path_mm(run, i));
  }
  motion.max_jerk_mm_s3 = largest(meter.max().jerk);
  motion.error = program_run::contour_error(motion.beside_mm);
  return motion;
}

bool moves_only_xy(const FeedProgram& program) {
  for (const Block& block : program.all_blocks())
    if (block.from.z != block.to.z || (block.arc && block.arc->along != 2)) return false;
  return true;
}

ComparedFeed planned_feed(const std::string& name, const std::vector<OptimisedBlock>& blocks,
                          const Method& method) {
  MotionMeter meter(method.period_s);
  double time_s = 0;
  for (const OptimisedBlock& block : blocks) {
    const std::vector<geometry::Point> at = feed_optimiser::places(block);
    for (std::size_t i = meter.places() == 0 ? 0 : 1; i < at.size(); ++i) meter.add(at[i]);
    time_s += block.seconds();
  }
  meter.finish();
  return {name, time_s, largest(meter.max().jerk), {}};
}

std::vector<ComparedFeed> compare_feeds(const FeedProgram& program, const Method& method,
                                        const ServoMachine& drives, double piece_s,
                                        const std::string& name, Frontend& frontend) {
  constexpr std::size_t compared = 3;
  const auto progress = frontend.progress("feeds compared", compared, 0);
  const bool has_drives = moves_only_xy(program);
  const geometry::Point origin = program.start.value_or(geometry::Point{});
  std::vector<ComparedFeed> rows;
  const std::string plain = plain_program(program, origin, largest(method.limits.speed_mm_s));
  rows.push_back({"firmware's own plan", {}, {}, {}});
  if (has_drives)
    rows.back().board = run_on_drives(plain, drives_with(drives, method, JerkLimit::board), name);
  else
    rows.back().time_s = firmware_s(plain, method);
  for (const Variant variant : {Variant::printed, Variant::strict}) {
    progress->update(rows.size());
    Method other = method;
    other.variant = variant;
    const auto blocks = feed_optimiser::optimise(program.all_blocks(), other, name);
    rows.push_back(planned_feed(
        fmt::format("f(n)^g(k) {}, n={:g} k={:g}",
                    variant == Variant::printed ? "printed" : "strict", method.law.n, method.law.k),
        blocks, other));
    if (has_drives)
      rows.back().board = run_on_drives(optimised_program(program, blocks, origin, piece_s),
                                        drives_with(drives, method, JerkLimit::program), name);
  }
  rows.push_back(optimum_of(program.all_blocks(), method));
  return rows;
}

MachineTimes times_on_machine(const FeedProgram& program, const std::vector<OptimisedBlock>& blocks,
                              const Method& method, const settings::Values& values, double piece_s,
                              const std::string& name) {
  const auto seconds = [&](const std::string& text) {
    const program_run::ProgramRun run = program_run::run_program(text, values, 1);
    if (run.problems.empty()) return run.seconds();
    const program_run::Problem& problem = run.problems.front();
    throw Error(Exit::bad_input, name, problem.text,
                problem.remedy.empty() ? "give the file of another machine" : problem.remedy);
  };
  return {seconds(plain_program(program, {}, largest(method.limits.speed_mm_s))),
          seconds(optimised_program(program, blocks, {}, piece_s))};
}

std::string feed_table(const std::vector<ComparedFeed>& rows) {
  std::size_t width = 0;
  for (const ComparedFeed& row : rows) width = std::max(width, row.name.size());
  const auto cell = [](const std::optional<double>& value, int decimals) {
    return value ? fmt::format("{:12.{}f}", *value, decimals) : fmt::format("{:>12}", "-");
  };
  std::string text =
      fmt::format("{:<{}}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", width, "plan s",
                  "jerk mm/s3", "board s", "jerk mm/s3", "mean mm", "std mm", "max mm");
  for (const ComparedFeed& row : rows) {
    std::optional<double> time, jerk, mean, deviation, max;
    if (row.board) {
      time = row.board->time_s;
      jerk = row.board->max_jerk_mm_s3;
      mean = row.board->error.mean_mm;
      deviation = row.board->error.deviation_mm;
      max = row.board->error.max_mm;
    }
    text += fmt::format("{:<{}}", row.name, width) + cell(row.time_s, 3) +
            cell(row.max_jerk_mm_s3, 0) + cell(time, 3) + cell(jerk, 0) + cell(mean, 5) +
            cell(deviation, 5) + cell(max, 5) + '\n';
  }
  return text;
}

}  // namespace lamplock::run
