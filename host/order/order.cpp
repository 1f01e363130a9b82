#include "host/order/order.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <thread>
#include <vector>

#include "host/order/cost.hpp"
#include "host/order/tour.hpp"
#include "host/points/limits.hpp"

namespace lamplock::order {
namespace {

using points::Point;
using points::PointCloud;

/// Where each layer begins in a cloud sorted by layers; one more entry for the end.
using Starts = std::vector<std::size_t>;

/// Sorts the cloud by layers, stable within each.
Starts sort_into_layers(PointCloud& cloud, double layer_mm) {
  const double lowest =
      std::min_element(cloud.begin(), cloud.end(), [](auto& p, auto& q) { return p.z < q.z; })->z;
  // Planes of a discretiser that lie on the boundary of layers must not be parted by rounding.
  constexpr double rounding = 1e-6;
  const auto layer = [&](const Point& point) {
    return std::floor((point.z - lowest) / layer_mm + rounding);
  };
  std::stable_sort(cloud.begin(), cloud.end(),
                   [&](const Point& p, const Point& q) { return layer(p) < layer(q); });
  Starts starts{0};
  for (std::size_t i = 1; i < cloud.size(); ++i) {
    if (layer(cloud[i]) != layer(cloud[i - 1])) starts.push_back(i);
  }
  starts.push_back(cloud.size());
  return starts;
}

/// Puts every layer of the cloud into the order of its tour. Layers are independent, so any number
/// of threads gives the same result. Only the caller's thread reports progress.
void make_tours(PointCloud& cloud, const Starts& starts, const OrderOptions& options) {
  const std::size_t layers = starts.size() - 1;
  std::atomic<std::size_t> next = 0, done = 0;
  const auto work = [&](bool report) {
    for (std::size_t layer = next++; layer < layers; layer = next++) {
      const std::span<Point> points(cloud.begin() + static_cast<std::ptrdiff_t>(starts[layer]),
                                    starts[layer + 1] - starts[layer]);
      const PointCloud copy(points.begin(), points.end());
      const auto tour = closed_tour(copy);
      for (std::size_t i = 0; i < tour.size(); ++i) points[i] = copy[tour[i]];
      done += points.size();
      if (!report || !options.progress) continue;
      options.progress(static_cast<double>(done) / static_cast<double>(cloud.size()));
    }
  };
  const unsigned hardware = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t threads = std::min<std::size_t>(
      options.threads > 0 ? options.threads : hardware, std::max<std::size_t>(layers, 1));
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back(work, false);
  try {
    work(true);
  } catch (...) {
    next = layers;  // the others finish the layer they are in
    throw;
  }
}

/// Cuts the closed tour and goes it the way that costs least for a machine at `from`.
void cut_tour(std::span<Point> tour, const Point& from) {
  std::size_t best = 0;
  bool backward = false;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tour.size(); ++i) {
    const std::size_t before = (i + tour.size() - 1) % tour.size();
    const double removed = distance(tour[before], tour[i]);
    // Cut between `before` and i: begin at i and go forward, or begin at `before` and go back.
    const double forward_cost = distance(from, tour[i]) - removed;
    const double backward_cost = distance(from, tour[before]) - removed;
    if (std::min(forward_cost, backward_cost) >= lowest) continue;
    lowest = std::min(forward_cost, backward_cost);
    best = i;
    backward = backward_cost < forward_cost;
  }
  std::rotate(tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(best), tour.end());
  if (backward) std::reverse(tour.begin(), tour.end());
}

}  // namespace

PointCloud order(PointCloud cloud, Ordering ordering, const OrderOptions& options) {
  if (ordering == Ordering::given || cloud.empty()) return cloud;
  points::require_positive(options.layer_mm, "order", "layer thickness");
  const Starts starts = sort_into_layers(cloud, options.layer_mm);
  make_tours(cloud, starts, options);
  Point from = options.start;
  for (std::size_t layer = 0; layer + 1 < starts.size(); ++layer) {
    const std::span<Point> tour(cloud.begin() + static_cast<std::ptrdiff_t>(starts[layer]),
                                starts[layer + 1] - starts[layer]);
    cut_tour(tour, from);
    from = tour.back();
  }
  if (options.progress) options.progress(1);
  return cloud;
}

}  // namespace lamplock::order
