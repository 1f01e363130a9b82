#include "host/serve/cloud.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "host/serve/shares.hpp"

namespace lamplock::serve {
namespace {

using geometry::Point;

/// A uniform sample without repetition, in random order (Fisher and Yates, ended early).
std::vector<std::uint32_t> sample_of(std::size_t size, std::size_t count) {
  std::vector<std::uint32_t> numbers(size);
  std::iota(numbers.begin(), numbers.end(), 0u);
  std::mt19937_64 random;  // the same sample each time
  for (std::size_t i = 0; i < count; ++i) std::swap(numbers[i], numbers[i + random() % (size - i)]);
  numbers.resize(count);
  numbers.shrink_to_fit();
  return numbers;
}

double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

}  // namespace

Cloud::Cloud(geometry::PointCloud points)
    : points_(std::move(points)),
      bounds_(geometry::bounds(points_)),
      sample_(sample_of(points_.size(), std::min(points_.size(), max_shown))) {}

std::string Cloud::part(std::size_t from) const {
  const std::size_t end = std::min(sample_.size(), from + max_part);
  const auto& [low, high] = bounds_;
  std::string bytes;
  if (from < end) bytes.reserve((end - from) * bytes_per_point);
  for (std::size_t i = from; i < end; ++i) {
    const Point& point = points_[sample_[i]];
    put_share(bytes, share_of(point.x, low.x, high.x));
    put_share(bytes, share_of(point.y, low.y, high.y));
    put_share(bytes, share_of(point.z, low.z, high.z));
    put_share(bytes, static_cast<double>(sample_[i]) / static_cast<double>(points_.size()));
  }
  return bytes;
}

std::vector<NearPoint> Cloud::near(const Sight& sight, double mm) const {
  const double length_2 = dot(sight.along, sight.along);
  std::vector<NearPoint> found;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& p = points_[i];
    const Point off{p.x - sight.at.x, p.y - sight.at.y, p.z - sight.at.z};
    const double along = dot(off, sight.along);
    const double distance_2 = dot(off, off) - along * along / length_2;
    if (distance_2 <= mm * mm) found.push_back({i, std::sqrt(std::max(distance_2, 0.0)), p});
  }
  const auto end = found.begin() + static_cast<std::ptrdiff_t>(std::min(found.size(), max_near));
  std::partial_sort(found.begin(), end, found.end(), [](const NearPoint& a, const NearPoint& b) {
    return std::pair(a.distance_mm, a.number) < std::pair(b.distance_mm, b.number);
  });
  found.erase(end, found.end());
  return found;
}

}  // namespace lamplock::serve
