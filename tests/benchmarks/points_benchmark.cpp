// From a mesh to an ordered cloud: about a million points. Goal: 30 s and 1 GB in all on two cores.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "host/model/example.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/order/order.hpp"
#include "host/points/blue_noise.hpp"
#include "host/points/fill_faces.hpp"
#include "host/points/fill_solid.hpp"
#include "host/points/rays.hpp"
#include "host/points/shells.hpp"
#include "host/points/slice.hpp"
#include "host/points/spacing.hpp"
#include "host/points/weld.hpp"

namespace lamplock {
namespace {

constexpr double pitch_mm = 0.088;    // a million hits on the example
constexpr double spacing_mm = 0.107;  // a million points on its contours
constexpr double weld_mm = 0.09;      // the lens of f = 43 mm

geometry::PointCloud ray_points() { return points::rays(model::example_model(), {pitch_mm}); }

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

/// Argument: smallest distance in um; the first gives a million points, the second ten.
void blue_noise(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  const double distance_mm = static_cast<double>(state.range(0)) / 1000;
  std::size_t number = 0;
  for (auto _ : state) number = points::blue_noise(mesh, {.distance_mm = distance_mm}).size();
  count(state, number);
}
BENCHMARK(blue_noise)->Arg(100)->Arg(31)->UseRealTime()->Unit(benchmark::kMillisecond);

void fill_faces(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  std::size_t number = 0;
  for (auto _ : state) number = points::fill_faces(mesh, {.distance_mm = 0.1}).points.size();
  count(state, number);
}
BENCHMARK(fill_faces)->Unit(benchmark::kMillisecond);

void fill_solid(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  std::size_t number = 0;
  for (auto _ : state) number = points::fill_solid(mesh, {.distance_mm = 0.18}).size();
  count(state, number);
}
BENCHMARK(fill_solid)->UseRealTime()->Unit(benchmark::kMillisecond);

void shells(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  const geometry::PointCloud cloud = points::blue_noise(mesh, {.distance_mm = 0.1});
  for (auto _ : state) {
    const auto inward = points::inward_ways(mesh, cloud, 0.01);
    benchmark::DoNotOptimize(points::spread_over_shells(cloud, inward, {}));
  }
  count(state, cloud.size());
}
BENCHMARK(shells)->UseRealTime()->Unit(benchmark::kMillisecond);

void spacing(benchmark::State& state) {
  const auto cloud = points::blue_noise(model::example_model(), {.distance_mm = 0.1});
  for (auto _ : state) benchmark::DoNotOptimize(points::spacing_of(cloud));
  count(state, cloud.size());
}
BENCHMARK(spacing)->UseRealTime()->Unit(benchmark::kMillisecond);

void mesh_faults(benchmark::State& state) {
  const model::Mesh mesh = model::example_model();
  for (auto _ : state) benchmark::DoNotOptimize(model::find_faults(mesh));
  count(state, mesh.triangles.size());
}
BENCHMARK(mesh_faults)->Unit(benchmark::kMillisecond);

void weld(benchmark::State& state) {
  const geometry::PointCloud cloud = ray_points();
  for (auto _ : state) benchmark::DoNotOptimize(points::weld(cloud, weld_mm));
  count(state, cloud.size());
}
BENCHMARK(weld)->Unit(benchmark::kMillisecond);

/// All stages; argument: thickness of a layer in um (the last: all points in one layer).
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
