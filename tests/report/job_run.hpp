// Builds records of perfect runs of a job, to which tests add faults.
#pragma once

#include <cmath>
#include <random>

#include "host/report/report.hpp"

namespace lamplock::report::test {

inline StepPosition rounded_steps(const geometry::Point& p, const PerAxis<double>& steps_per_mm) {
  const auto round = [](double v) { return static_cast<std::int32_t>(std::lround(v)); };
  return {round(p.x * steps_per_mm[0]), round(p.y * steps_per_mm[1]), round(p.z * steps_per_mm[2]),
          0};
}

/// Appends a shot at a position, one beat after the last.
inline void add_shot(JobRun& run, const StepPosition& lattice) {
  sim::Shot shot;
  shot.index = static_cast<std::uint32_t>(run.shots.size());
  shot.beat = static_cast<std::int64_t>(run.shots.size()) + 11;
  shot.at = shot.beat * 10 * sim::ps_per_ms + 5'000'123;
  shot.steps = lattice;
  shot.width = 150 * sim::ps_per_us;
  run.shots.push_back(shot);
  run.lattice_steps.push_back(lattice);
}

inline void add_shot_at_point(JobRun& run, std::size_t point) {
  add_shot(run, rounded_steps(run.points[point], run.steps_per_mm));
}

/// Random points at least about `spacing` mm apart from their grid neighbours.
inline JobRun job(int count, std::uint64_t seed, double spacing = 0.1) {
  JobRun run;
  run.input = "cloud.xyz";
  run.mode = "free";
  run.board = "virtual";
  run.steps_per_mm = {200, 200, 400, 1};
  run.beats_before = 10;
  std::mt19937_64 random(seed);
  const auto jitter = [&] { return static_cast<double>(random() % 1000) * 1e-3 * spacing * 0.3; };
  for (int i = 0; i < count; ++i) {
    const int row = i / 40 % 40;
    const int layer = i / 1600;
    const int column = row % 2 == 0 ? i % 40 : 39 - i % 40;
    run.points.push_back({spacing * column + jitter() - 2, spacing * row + jitter() - 2,
                          spacing * layer + jitter() - 1});
  }
  return run;
}

/// The same with every point fired once, in order.
inline JobRun perfect_run(int count, std::uint64_t seed) {
  JobRun run = job(count, seed);
  for (std::size_t i = 0; i < run.points.size(); ++i) add_shot_at_point(run, i);
  run.beats = run.shots.size();
  run.time_s = static_cast<double>(run.beats) / 100;
  return run;
}

}  // namespace lamplock::report::test
