// Ordering of about a million points. Goal: 20 s and 1 GB on two cores; a proof in 2 s. Measured:
// order_best/0 takes 19 s of processor time (docs/ordering.md, section 3).
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/model/example.hpp"
#include "host/order/order.hpp"
#include "host/order/shadow.hpp"
#include "host/points/slice.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using order::Ordering;

constexpr double spacing_mm = 0.1;

/// Spiral with even areas, each point moved a little: the smallest distance is about 0.07 mm.
PointCloud surface(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> moved(-0.1, 0.1);
  const double radius = spacing_mm * std::sqrt(static_cast<double>(count) / (4 * std::numbers::pi));
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  PointCloud cloud;
  cloud.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double part = (static_cast<double>(i) + 0.5 + moved(random)) / static_cast<double>(count);
    const double z = 2 * part - 1, ring = std::sqrt(1 - z * z);
    const double angle = turn * static_cast<double>(i) + moved(random) / std::sqrt(count);
    cloud.push_back({radius * ring * std::cos(angle), radius * ring * std::sin(angle), radius * z});
  }
  return cloud;
}

/// A cubic lattice, each point moved by up to a fifth of the spacing in each coordinate.
PointCloud solid(std::size_t count) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> moved(-0.2 * spacing_mm, 0.2 * spacing_mm);
  const auto side = static_cast<std::size_t>(std::lround(std::cbrt(static_cast<double>(count))));
  PointCloud cloud;
  cloud.reserve(side * side * side);
  for (std::size_t i = 0; i < side * side * side; ++i) {
    const auto at = [&](std::size_t place) {
      return static_cast<double>(place % side) * spacing_mm + moved(random);
    };
    cloud.push_back({at(i), at(i / side), at(i / side / side)});
  }
  return cloud;
}

PointCloud sliced() {
  return points::slice(model::example_model(), {.layer_mm = 0.107, .vertex_mm = 0.107});
}

/// Argument of the benchmarks: 0 surface, 1 solid, 2 the example sliced; 3 and 4: ten times as many
/// points as 0 and 1.
PointCloud cloud_of(std::int64_t kind) {
  constexpr std::size_t million = 1'000'000;
  switch (kind) {
    case 0:
      return surface(million);
    case 1:
      return solid(million);
    case 2:
      return sliced();
    case 3:
      return surface(10 * million);
    default:
      return solid(10 * million);
  }
}

void count(benchmark::State& state, std::size_t number) {
  state.counters["points"] = static_cast<double>(number);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;  // given in KiB
}

/// Options for a machine on which beats are scarce.
order::OrderOptions options() {
  order::OrderOptions options;
  options.layer_mm = 0.9 * spacing_mm;
  options.motion = {{2000, 2000, 2000}, {1000, 1000, 1000}, 0.01};
  return options;
}

void order_of(benchmark::State& state, Ordering ordering) {
  const PointCloud cloud = cloud_of(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(order::order(cloud, ordering, options()));
  count(state, cloud.size());
}

void order_best(benchmark::State& state) { order_of(state, Ordering::best); }
BENCHMARK(order_best)
    ->DenseRange(0, 4)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void order_layers(benchmark::State& state) { order_of(state, Ordering::layers); }
void order_nearest(benchmark::State& state) { order_of(state, Ordering::nearest); }
void order_cone(benchmark::State& state) { order_of(state, Ordering::cone); }
BENCHMARK(order_layers)
    ->DenseRange(0, 2)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(order_nearest)->DenseRange(0, 2)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(order_cone)->DenseRange(0, 2)->Iterations(1)->Unit(benchmark::kMillisecond);

void proof_of_the_shadow_rule(benchmark::State& state) {
  const PointCloud cloud = order::order(cloud_of(state.range(0)), Ordering::nearest, options());
  for (auto _ : state) {
    benchmark::DoNotOptimize(order::first_shadowed(cloud, order::default_half_angle_deg));
  }
  count(state, cloud.size());
}
BENCHMARK(proof_of_the_shadow_rule)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
