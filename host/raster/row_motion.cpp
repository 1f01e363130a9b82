#include "host/raster/row_motion.hpp"

#include <cmath>

#include "firmware/motion/line/rise.hpp"
#include "firmware/motion/profile/limits.hpp"
#include "host/job/rate_excess.hpp"
#include "host/program/line_run.hpp"
#include "host/units.hpp"
#include "shared/wire/run_pace.hpp"
#include "shared/wire/runs.hpp"

namespace lamplock::raster {
namespace {

using motion::UFloat;
using settings::Id;

/// Lines have no beat, but limits in ticks are made for one.
constexpr std::uint32_t some_beat_ticks = ticks_per_second / 100;
constexpr double s_per_min = 60;
/// Fraction bits of ticks.
constexpr int tick_bits = 20;

motion::LineRise rise_of(const settings::Values& values) {
  motion::Limits limits;
  std::uint16_t setting = 0;
  if (motion::make_limits(values, some_beat_ticks, full_tick_q16, limits, setting) != Result::ok)
    throw job::no_motion(values, setting);
  return motion::make_rise(limits);
}

/// Time of a change of speed with the machine's jerk limit, from its time without the limit.
double change_s(const motion::LineRise& rise, double steady_s) {
  if (rise.none()) return steady_s;
  const double ticks = std::ldexp(steady_s * ticks_per_second, tick_bits);
  const UFloat change =
      rise.change_ticks(UFloat(static_cast<std::uint64_t>(std::llround(ticks)), -tick_bits));
  return std::ldexp(static_cast<double>(change.fixed(tick_bits)), -tick_bits) / ticks_per_second;
}

}  // namespace

double run_up_mm(const settings::Values& values, double feed_mm_min) {
  const double speed = feed_mm_min / s_per_min;
  return speed / 2 * change_s(rise_of(values), speed / in_units(values, Id::acceleration_x));
}

namespace {

/// The least feed override of a board.
constexpr std::uint32_t min_feed_percent = 10;

void run_rows(const job::Job& job, std::uint32_t job_speed, program_run::LineRun& run) {
  run.change_speed({{0, std::max(job_speed, min_feed_percent), wire::full_job_speed}});
  std::uint32_t number = 0;
  for (const job::Line& line : job.rows.lines) {
    motion::LineTarget target;
    target.line = ++number;
    target.steps = line.to.steps;
    target.feed_um_min = line.to.feed_milli;
    target.rapid = !line.to.light;
    wire::RunPace pace;
    for (const std::uint16_t pixels : job.rows.runs_of(line)) pace.add(wire::run_cells(pixels));
    target.time_us = pace.min_us();
    run.receive(line.runs * sizeof(std::uint16_t));
    run.take(target);
  }
  run.finish();
}

double seconds(std::uint64_t ticks) { return static_cast<double>(ticks) / ticks_per_second; }

}  // namespace

std::vector<double> line_ends_s(const job::Job& job, std::uint32_t job_speed) {
  program_run::LineRun run(job.settings);
  run_rows(job, job_speed, run);
  std::vector<double> ends;
  ends.reserve(run.line_ends().size());
  for (const std::uint64_t ticks : run.line_ends()) ends.push_back(seconds(ticks));
  return ends;
}

double seconds_of(const job::Job& job, std::uint32_t job_speed, std::size_t first) {
  const std::vector<double> ends = line_ends_s(job, job_speed);
  if (first >= ends.size()) return 0;
  return ends.back() - (first == 0 ? 0 : ends[first - 1]);
}

}  // namespace lamplock::raster
