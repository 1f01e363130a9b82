#include "host/order/layers.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "host/order/local_search.hpp"

namespace lamplock::order {
namespace {

using geometry::Point;
using geometry::PointCloud;

// Rounding must not divide planes of a discretiser on the boundary of layers.
constexpr double rounding = 1e-6;

bool lower(const Point& p, const Point& q) { return p.z < q.z; }

/// Mean number of points on a plane of equal height (to 1e-6 mm); the cloud is sorted by height.
double points_a_plane(const PointCloud& cloud) {
  std::size_t planes = 1;
  for (std::size_t i = 1; i < cloud.size(); ++i) {
    if (cloud[i].z - cloud[i - 1].z > rounding) ++planes;
  }
  return static_cast<double>(cloud.size()) / static_cast<double>(planes);
}

Starts starts_where(std::size_t points, const auto& begins) {
  Starts starts{0};
  for (std::size_t i = 1; i < points; ++i) {
    if (begins(i)) starts.push_back(i);
  }
  starts.push_back(points);
  return starts;
}

}  // namespace

double usual_spacing_mm(const PointCloud& cloud) {
  constexpr std::size_t max_asked = 20'000;  // consecutive, so that their neighbours are included
  const std::size_t count = std::min(cloud.size(), max_asked);
  const std::size_t first = (cloud.size() - count) / 2;
  const std::span<const Point> part = std::span(cloud).subspan(first, count);
  const Neighbours neighbours = find_neighbours(part, 1);
  if (neighbours.per_point == 0) return 0;
  std::vector<double> nearest(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    nearest[i] = distance(part[i], part[neighbours.of(i)[0]]);
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

Starts sort_into_layers(PointCloud& cloud, double layer_mm) {
  const double lowest = std::min_element(cloud.begin(), cloud.end(), lower)->z;
  const auto layer = [&](const Point& point) {
    return std::floor((point.z - lowest) / layer_mm + rounding);
  };
  std::stable_sort(cloud.begin(), cloud.end(),
                   [&](const Point& p, const Point& q) { return layer(p) < layer(q); });
  return starts_where(cloud.size(),
                      [&](std::size_t i) { return layer(cloud[i]) != layer(cloud[i - 1]); });
}

Starts sort_into_fitting_layers(PointCloud& cloud, double tangent) {
  constexpr double fewest_on_a_plane = 8;
  std::stable_sort(cloud.begin(), cloud.end(), lower);
  if (points_a_plane(cloud) >= fewest_on_a_plane) {
    return starts_where(cloud.size(),
                        [&](std::size_t i) { return cloud[i].z - cloud[i - 1].z > rounding; });
  }
  const double cosine = 1 / std::sqrt(1 + tangent * tangent);
  const double layer_mm = usual_spacing_mm(cloud) * cosine;
  const double height = cloud.back().z - cloud.front().z;
  // Coincident points give no thickness: the fallback is that of a solid lattice.
  const double fallback = height / std::cbrt(static_cast<double>(cloud.size()));
  return sort_into_layers(cloud, layer_mm > height * 1e-9 ? layer_mm : fallback);
}

void for_each_layer(PointCloud& cloud, const Starts& starts, unsigned threads,
                    const LayerWork& work, const std::function<void(std::size_t)>& progress) {
  const std::size_t layers = starts.size() - 1;
  std::atomic<std::size_t> next = 0, done = 0;
  std::exception_ptr failed;
  std::mutex failing;
  const auto run = [&](bool report) {
    try {
      for (std::size_t layer = next++; layer < layers; layer = next++) {
        const std::size_t count = starts[layer + 1] - starts[layer];
        work(std::span(cloud).subspan(starts[layer], count));
        done += count;
        if (report && progress) progress(done);
      }
    } catch (...) {
      next = layers;  // the other threads finish their layers
      const std::scoped_lock lock(failing);
      if (!failed) failed = std::current_exception();
    }
  };
  {
    const unsigned hardware = std::max(1u, std::thread::hardware_concurrency());
    const std::size_t most = std::min<std::size_t>(threads > 0 ? threads : hardware, layers);
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < most; ++i) others.emplace_back(run, false);
    run(true);
  }
  if (failed) std::rethrow_exception(failed);
}

}  // namespace lamplock::order
