#include "host/bench/figures.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "host/bench/machine.hpp"
#include "host/bench/plan_stream.hpp"

namespace lamplock::bench {
namespace {

/// Resolution for walks: at 1 m/s not many more are possible with at most one step a microsecond.
constexpr double bench_steps_per_mm = 500;
/// Steps of 1 um, the unit of lengths in the histogram.
constexpr double fine_steps_per_mm = 1000;

double beats_per_point(const motion::Limits& limits, const std::vector<wire::Target>& targets,
                       wire::JoinMode mode) {
  const auto planner = std::make_unique<motion::Planner>();
  StreamOptions options;
  options.mode = mode;
  const StreamPlan plan = plan_stream(limits, targets, options, *planner);
  if (plan.result != Result::ok)
    throw std::runtime_error("point " + std::to_string(plan.beats.size()) + " cannot be reached");
  return static_cast<double>(plan.total_beats()) / static_cast<double>(targets.size());
}

/// Mean of each column; there must be at least one row.
Figures mean(const std::vector<Figures>& rows) {
  const auto of = [&rows](auto value) {
    double sum = 0;
    for (const Figures& row : rows) sum += value(row);
    return sum / static_cast<double>(rows.size());
  };
  const auto planned = [](const Figures& f) { return f.path.has_value(); };
  Figures figures;
  figures.start_stop = of([](const Figures& f) { return f.start_stop; });
  if (std::all_of(rows.begin(), rows.end(), planned))
    figures.path = of([](const Figures& f) { return *f.path; });
  figures.free = of([](const Figures& f) { return f.free; });
  figures.optimum = of([](const Figures& f) { return f.optimum; });
  figures.labels = of([](const Figures& f) { return f.labels; });
  return figures;
}

/// True if the time of a step is a whole number of beats, within rounding.
bool ends_on_a_beat(const StartStopTime& row, double way_m) {
  const double a = row.accel_m_s2, v = row.speed_m_s;
  const double time_s = std::sqrt(way_m * a) <= v ? 2 * std::sqrt(way_m / a) : way_m / v + v / a;
  const double beats = time_s * row.lamp_hz;
  return std::fabs(beats - std::round(beats)) < 1e-9;
}

}  // namespace

Figures figures_of(const motion::Limits& limits, const std::vector<wire::Target>& targets,
                   const PointsPlanned& planned) {
  using wire::JoinMode;
  const std::size_t count = targets.size();
  // Three plans and the search, each counted as a third of the points except the shortest.
  std::size_t reported = 0;
  const auto report = [&](std::size_t done) {
    if (planned) planned(done - reported);
    reported = done;
  };
  Figures figures;
  figures.start_stop = beats_per_point(limits, targets, JoinMode::start_stop);
  figures.path = beats_per_point(limits, targets, JoinMode::path);
  report(count / 3);
  figures.free = beats_per_point(limits, targets, JoinMode::free);
  report(count / 3 * 2);
  const ReferenceResult best = fewest_beats(
      problem_of(limits, targets), [&](std::size_t done) { report(count / 3 * 2 + done / 3); });
  report(count);
  figures.optimum = static_cast<double>(best.beats) / static_cast<double>(count);
  figures.labels = static_cast<double>(best.labels) / static_cast<double>(count);
  return figures;
}

double measured_beats(const StartStopTime& row) { return row.lamp_hz * row.time_s / glass_points; }

double start_stop_beats(const StartStopTime& row, double step_um) {
  const motion::Limits limits =
      limits_of(machine_settings(row.lamp_hz, row.accel_m_s2, row.speed_m_s, 1, fine_steps_per_mm));
  wire::Target target;
  target.steps[0] =
      static_cast<std::int32_t>(step_um) - (ends_on_a_beat(row, step_um * 1e-6) ? 1 : 0);
  return beats_per_point(limits, {target}, wire::JoinMode::start_stop);
}

double start_stop_on_one_axis(const StartStopTime& row) {
  const std::vector<int> counts = step_counts(glass_points);
  double beats = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    beats += counts[i] * start_stop_beats(row, glass_step_lengths[i].step_um);
  return beats / glass_points;
}

Figures walk_figures(const Machine& machine, int points, std::uint64_t seed,
                     const PointsPlanned& planned) {
  constexpr int axes = 2;
  const motion::Limits limits = limits_of(machine_settings(
      machine.lamp_hz, machine.accel_m_s2, machine.speed_m_s, axes, bench_steps_per_mm));
  return figures_of(limits, histogram_walk(points, axes, bench_steps_per_mm, seed), planned);
}

JerkBeats jerk_beats(const Machine& machine, wire::JoinMode mode, int points, std::uint64_t seed,
                     const PointsPlanned& planned) {
  constexpr int axes = 2;
  const auto walk =
      mode == wire::JoinMode::path
          ? course(Course::straight, std::min(points, pulse_points), bench_steps_per_mm, seed)
          : histogram_walk(points, axes, bench_steps_per_mm, seed);
  JerkBeats beats{};
  for (std::size_t i = 0; i < beats.size(); ++i) {
    settings::Values values = machine_settings(machine.lamp_hz, machine.accel_m_s2,
                                               machine.speed_m_s, axes, bench_steps_per_mm);
    for (int a = 0; a < axes; ++a)
      values.set_milli(settings::for_axis(settings::Id::jerk_x, a),
                       static_cast<std::int32_t>(std::lround(jerk_limits[i] * 1000)));
    beats[i] = beats_per_point(limits_of(values), walk, mode);
    if (planned) planned(walk.size());
  }
  return beats;
}

Figures course_figures(const PulseCourse& row, int draws, std::uint64_t seed,
                       const PointsPlanned& planned) {
  settings::Values values = machine_settings(pulse_machine.lamp_hz, pulse_machine.accel_m_s2,
                                             pulse_machine.speed_m_s, 2, bench_steps_per_mm);
  const auto jump_milli = static_cast<std::int32_t>(std::lround(row.corner_jump_mm_s * 1000));
  for (int a = 0; a < 2; ++a)
    values.set_milli(settings::for_axis(settings::Id::speed_jump_x, a), jump_milli);
  const motion::Limits limits = limits_of(values);
  std::vector<Figures> all;
  for (int draw = 1; draw <= draws; ++draw) {
    const std::uint64_t draw_seed = (seed - 1) * pulse_draws + static_cast<std::uint64_t>(draw);
    all.push_back(figures_of(limits, course(row.shape, pulse_points, bench_steps_per_mm, draw_seed),
                             planned));
  }
  return mean(all);
}

}  // namespace lamplock::bench
