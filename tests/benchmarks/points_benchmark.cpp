// From a mesh to an ordered cloud: about a million points. Goal: 30 s and 1 GB in all on two cores.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "host/model/example.hpp"
#include "host/order/order.hpp"
#include "host/points/rays.hpp"
#include "host/points/slice.hpp"
#include "host/points/weld.hpp"

namespace lamplock {
namespace {

constexpr double pitch_mm = 0.088;    // a million hits on the example
constexpr double spacing_mm = 0.107;  // a million points on its contours
constexpr double weld_mm = 0.09;      // the lens of f = 43 mm

points::PointCloud ray_points() { return points::rays(model::example_model(), {pitch_mm}); }

void count(benchmark::State& state, std::size_t number) {
  state.counters["points"] = static_cast<double>(number);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;  // given in KiB
}

void rays(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  std::size_t number = 0;
  for (auto _ : state) number = points::rays(mesh, {pitch_mm}).size();
  count(state, number);
}
BENCHMARK(rays)->Unit(benchmark::kMillisecond);

void slice(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  std::size_t number = 0;
  for (auto _ : state) {
    number = points::slice(mesh, {.layer_mm = spacing_mm, .vertex_mm = spacing_mm}).size();
  }
  count(state, number);
}
BENCHMARK(slice)->Unit(benchmark::kMillisecond);

void weld(benchmark::State& state) {
  const points::PointCloud cloud = ray_points();
  for (auto _ : state) benchmark::DoNotOptimize(points::weld(cloud, weld_mm));
  count(state, cloud.size());
}
BENCHMARK(weld)->Unit(benchmark::kMillisecond);

/// Everything; argument: thickness of a layer in um (the last: all points in one layer).
void mesh_to_ordered_points(benchmark::State& state) {
  std::size_t number = 0;
  for (auto _ : state) {
    order::OrderOptions options;
    options.layer_mm = static_cast<double>(state.range(0)) / 1000;
    auto cloud = points::weld(ray_points(), weld_mm * 0.9).points;
    number = cloud.size();
    benchmark::DoNotOptimize(order::order(std::move(cloud), order::Ordering::layers, options));
  }
  count(state, number);
}
BENCHMARK(mesh_to_ordered_points)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(100000)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
