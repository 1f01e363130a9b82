// Estimating a job of a million points, and its page. Goals: 10 s, 1 GB; a page of 15 MB.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <random>

#include "host/estimate/estimate.hpp"
#include "host/job/job.hpp"
#include "host/report/page.hpp"

namespace lamplock {
namespace {

/// A surface in layers, as engraved: rows of points about 0.1 mm apart.
geometry::PointCloud surface(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter(-0.02, 0.02);
  constexpr double pitch_mm = 0.1, half_mm = 25;
  const auto row = static_cast<std::size_t>(2 * half_mm / pitch_mm);
  geometry::PointCloud cloud;
  cloud.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t line = i / row, column = line % 2 == 0 ? i % row : row - 1 - i % row;
    const double x = pitch_mm * static_cast<double>(column) - half_mm + jitter(random);
    const double y = pitch_mm * static_cast<double>(line % row) - half_mm + jitter(random);
    cloud.push_back({x, y, 2 * static_cast<double>(line / row) + jitter(random)});
  }
  return cloud;
}

job::Job job_of(const geometry::PointCloud& cloud, double lamp_hz, double accel_m_s2) {
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, lamp_hz);
  job::set_acceleration(profile, accel_m_s2);
  return job::make_job(cloud, profile, {});
}

void count(benchmark::State& state, std::size_t number) {
  state.counters["points"] = static_cast<double>(number);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;  // given in KiB
}

/// Arguments: thousands of points, lamp in Hz, acceleration in m/s2.
void estimate_job(benchmark::State& state) {
  const auto points = static_cast<std::size_t>(1000 * state.range(0));
  const job::Job job = job_of(surface(points), static_cast<double>(state.range(1)),
                              static_cast<double>(state.range(2)));
  std::uint64_t beats = 0;
  for (auto _ : state) beats = estimate::estimate_job(job).beats;
  count(state, points);
  state.counters["beats"] = static_cast<double>(beats);
}
BENCHMARK(estimate_job)
    ->Args({1000, 100, 4})
    ->Args({1000, 100, 2})
    ->Args({1000, 1000, 10})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

void page(benchmark::State& state) {
  report::JobRun run;
  run.points = surface(static_cast<std::size_t>(1000 * state.range(0)));
  run.shots_known = false;
  for (std::uint32_t i = 0; i < run.points.size(); ++i) run.foreseen_beats.push_back(i + i / 7);
  run.beats = run.foreseen_beats.back() + 1;
  const report::Report report = report::evaluate(run);
  std::size_t bytes = 0;
  for (auto _ : state) bytes = report::page(report, run).size();
  count(state, run.points.size());
  state.counters["page_MB"] = static_cast<double>(bytes) / 1e6;
}
BENCHMARK(page)->Arg(1000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
