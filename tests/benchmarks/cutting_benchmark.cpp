// A drawing of many parts with holes, every line and arc of it a curve by itself: joined, checked,
// nested, compensated, ordered. Goal: 20 000 contours of 400 000 pieces in 5 s and 500 MB on two
// cores, and a time that grows about as n log n.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/cutting/cut_order.hpp"
#include "host/cutting/offset.hpp"

namespace lamplock::cutting {
namespace {

using std::numbers::pi;

constexpr int pieces_of_a_contour = 20;
constexpr int contours_of_a_part = 5;
constexpr double part_mm = 25;

/// A gear of lines and arcs, each a path by itself, in any direction.
void add_gear(model::Curves& curves, Vec centre, double radius, std::mt19937_64& random) {
  std::uniform_real_distribution<double> deep(0.8, 1), any(0, 1);
  std::vector<Vec> corners;
  for (int i = 0; i < pieces_of_a_contour; ++i) {
    const double turn = 2 * pi * i / pieces_of_a_contour;
    const double away = i % 4 < 2 ? radius : radius * deep(random);
    corners.push_back(centre + Vec{std::cos(turn), std::sin(turn)} * away);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Vec from = corners[i], to = corners[(i + 1) % corners.size()];
    if (i % 4 == 0) {
      const double start = 2 * pi * static_cast<double>(i) / pieces_of_a_contour;
      curves.paths.push_back({{model::Arc{{centre.x, centre.y, 0},
                                          {radius, 0, 0},
                                          {0, radius, 0},
                                          start,
                                          start + 2 * pi / pieces_of_a_contour}}});
    } else {
      if (any(random) < 0.5) std::swap(from, to);
      curves.paths.push_back({{model::Line{{from.x, from.y, 0}, {to.x, to.y, 0}}}});
    }
  }
}

/// A sheet of square parts, each a contour with holes.
model::Curves sheet(std::size_t contours) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> moved(-1, 1);
  const std::size_t parts = contours / contours_of_a_part;
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(parts))));
  model::Curves curves;
  curves.layers = {"0"};
  for (std::size_t i = 0; i < parts; ++i) {
    const Vec centre{part_mm * static_cast<double>(i % columns) + moved(random),
                     part_mm * static_cast<double>(i / columns) + moved(random)};
    add_gear(curves, centre, 0.44 * part_mm, random);
    for (int hole = 1; hole < contours_of_a_part; ++hole) {
      const double turn = 2 * pi * hole / (contours_of_a_part - 1);
      add_gear(curves, centre + Vec{std::cos(turn), std::sin(turn)} * (0.22 * part_mm),
               0.08 * part_mm, random);
    }
  }
  std::shuffle(curves.paths.begin(), curves.paths.end(), random);
  return curves;
}

/// Outside contours counter-clockwise, holes clockwise: the beam is to the right of all.
void direct(std::vector<Contour>& contours, const std::vector<ContourPlace>& places) {
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const bool is_hole = places[i].kind == ContourKind::hole;
    if ((signed_area(contours[i]) < 0) != is_hole) contours[i] = reversed(contours[i]);
  }
}

/// Processor time of all threads.
class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const std::clock_t now = std::clock();
    const double passed = static_cast<double>(now - last_) / CLOCKS_PER_SEC;
    last_ = now;
    return passed;
  }

 private:
  std::clock_t last_ = std::clock();
};

void drawing_to_order(benchmark::State& state) {
  const model::Curves curves = sheet(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    Stopwatch watch;
    JoinedContours joined = join_contours(curves, {});
    state.counters["join_s"] = watch.lap();
    benchmark::DoNotOptimize(contour_faults(joined.contours));
    state.counters["check_s"] = watch.lap();
    const std::vector<ContourPlace> places = contour_tree(joined.contours);
    state.counters["tree_s"] = watch.lap();
    direct(joined.contours, places);
    const OffsetContours moved = offset(joined.contours, {.distance_mm = 0.1});
    state.counters["compensate_s"] = watch.lap();
    const CutOrder order = cut_order(joined.contours, places, {0, 0});
    state.counters["order_s"] = watch.lap();
    state.counters["contours"] = static_cast<double>(moved.contours.size());
    state.counters["rapid_m"] = order.rapid_mm / 1000;
  }
  state.counters["pieces"] = static_cast<double>(curves.paths.size());
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;  // given in KiB
}
BENCHMARK(drawing_to_order)
    ->Arg(5'000)
    ->Arg(20'000)
    ->Arg(80'000)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock::cutting
