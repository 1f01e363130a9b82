// The feed optimiser beside the firmware's planner: processor time of this computer for 100 000
// blocks of a polyline with random corners, on one core.
//
// Counters:
//   blocks_per_s     planned
//   of_firmware      time over that of the firmware's line planner for the same blocks
// The firmware plans in fixed point with a look-ahead and makes the segments of all ticks; the
// optimiser plans each block alone from rest to rest. Profiles are made, the points of the control
// periods are not: `places` is the time with them.
#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <random>
#include <vector>

#include "host/feed_optimiser/optimise.hpp"
#include "host/job/profile.hpp"
#include "host/program/line_run.hpp"

namespace lamplock {
namespace {

constexpr std::size_t block_count = 100'000;
constexpr double feed_mm_s = 17.5, steps_per_mm = 200;

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<feed_optimiser::Block> corners() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 6.283), length(0.5, 2);
  std::vector<feed_optimiser::Block> blocks;
  feed_optimiser::Point at;
  while (blocks.size() < block_count) {
    const double turn = angle(random), mm = length(random);
    const feed_optimiser::Point to{at.x + mm * std::cos(turn), at.y + mm * std::sin(turn), 0};
    if (std::abs(to.x) > 40 || std::abs(to.y) > 40) continue;
    blocks.push_back(feed_optimiser::straight_block(at, to));
    at = to;
  }
  return blocks;
}

feed_optimiser::Method method_of(feed_optimiser::Variant variant) {
  using namespace feed_optimiser;
  Method method{variant, {}, example_period_ms / 1e3, {}};
  method.limits.speed_mm_s.fill(feed_mm_s);
  method.limits.accel_mm_s2.fill(example_accel_mm_s2);
  method.limits.jerk_mm_s3.fill(example_jerk_mm_s3);
  return method;
}

/// Seconds of this computer for the firmware's plan under the same limits.
double firmware_s(const std::vector<feed_optimiser::Block>& blocks) {
  using settings::Id;
  job::Profile profile;
  job::state_setting(profile, Id::lamp_mode, 0, "benchmark");
  for (int a = 0; a < 2; ++a) {
    const auto state = [&](Id id, double value) {
      job::state_setting(profile, settings::for_axis(id, a), value, "benchmark");
    };
    state(Id::acceleration_x, feed_optimiser::example_accel_mm_s2);
    state(Id::jerk_x, feed_optimiser::example_jerk_mm_s3 / 1000);
  }
  const auto begin = processor_s();
  program_run::LineRun run(profile.settings);
  for (const feed_optimiser::Block& block : blocks) {
    motion::LineTarget target;
    target.steps[0] = static_cast<std::int32_t>(std::lround(block.to.x * steps_per_mm));
    target.steps[1] = static_cast<std::int32_t>(std::lround(block.to.y * steps_per_mm));
    target.feed_um_min = static_cast<std::uint32_t>(feed_mm_s * 60'000);
    run.take(target);
  }
  run.finish();
  benchmark::DoNotOptimize(run.ticks());
  return processor_s() - begin;
}

void optimise_feed(benchmark::State& state, feed_optimiser::Variant variant, bool with_places) {
  const std::vector<feed_optimiser::Block> blocks = corners();
  const feed_optimiser::Method method = method_of(variant);
  static const double planned_s = firmware_s(blocks);
  double seconds = 0, rounds = 0;
  for (auto _ : state) {
    const auto begin = processor_s();
    const auto optimised = feed_optimiser::optimise(blocks, method, "benchmark");
    if (with_places)
      for (const feed_optimiser::OptimisedBlock& block : optimised)
        benchmark::DoNotOptimize(feed_optimiser::places(block));
    benchmark::DoNotOptimize(optimised.back());
    seconds += processor_s() - begin;
    ++rounds;
  }
  state.counters["blocks_per_s"] = static_cast<double>(block_count) * rounds / seconds;
  state.counters["of_firmware"] = seconds / rounds / planned_s;
}

using feed_optimiser::Variant;
BENCHMARK_CAPTURE(optimise_feed, strict, Variant::strict, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimise_feed, printed, Variant::printed, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimise_feed, strict_places, Variant::strict, true)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
