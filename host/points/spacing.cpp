#include "host/points/spacing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>

#include "host/error.hpp"
#include "host/geometry/kd_tree.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::points {
namespace {

constexpr std::size_t bins = 60;
constexpr double bins_to_means = 3;  // range of the histogram

/// The nearest other position.
struct Nearest {
  double distance = 0;
  std::uint32_t position = 0;
};

void require_usable(std::span<const geometry::Point> cloud) {
  geometry::require_count(static_cast<double>(cloud.size()), "spacing");
  constexpr double largest = 1e100;  // squares of larger ones overflow
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& [x, y, z] = cloud[i];
    if (std::abs(x) < largest && std::abs(y) < largest && std::abs(z) < largest) continue;
    throw Error(
        Exit::bad_input, "spacing",
        fmt::format("point {} has a coordinate that is not finite or too large: ({}, {}, {})", i, x,
                    y, z),
        "correct the point list");
  }
}

/// Indices of the points at different positions; counts and records the others.
std::vector<std::uint32_t> distinct_positions(std::span<const geometry::Point> cloud,
                                              SpacingReport& report) {
  std::vector<std::uint32_t> order(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const geometry::Point &p = cloud[i], &q = cloud[j];
    return std::tie(p.x, p.y, p.z, i) < std::tie(q.x, q.y, q.z, j);
  });
  std::vector<std::uint32_t> distinct;
  distinct.reserve(order.size());
  for (const std::uint32_t i : order) {
    if (distinct.empty() || cloud[distinct.back()] != cloud[i]) {
      distinct.push_back(i);
      continue;
    }
    if (report.duplicates == 0 || i < report.second) {
      report.first = distinct.back();
      report.second = i;
    }
    ++report.duplicates;
  }
  return distinct;
}

std::vector<Nearest> find_nearest(std::span<const geometry::Point> cloud,
                                  std::span<const std::uint32_t> positions) {
  const auto position = [&](std::size_t i) -> const geometry::Point& {
    return cloud[positions[i]];
  };
  const geometry::KdTree tree(positions.size(), position);
  std::vector<Nearest> nearest(positions.size());
  geometry::for_each_index(positions.size(), 0, [&](std::size_t i) {
    std::array<std::uint32_t, 2> index{};
    std::array<double, 2> squared{};
    tree.nearest(position(i), index.size(), index, squared);
    // One of the two is the position itself, unless others are so near that the squares are 0.
    const std::size_t other = index[0] == i ? 1 : 0;
    nearest[i] = {std::sqrt(squared[other]), index[other]};
  });
  return nearest;
}

void fill_histogram(std::span<const Nearest> nearest, SpacingReport& report) {
  for (const Nearest& one : nearest) {
    report.mean_mm += one.distance / static_cast<double>(nearest.size());
    report.max_mm = std::max(report.max_mm, one.distance);
  }
  report.bin_mm = bins_to_means * report.mean_mm / static_cast<double>(bins);
  if (!(report.bin_mm > 0)) return;
  report.counts.assign(bins, 0);
  for (const Nearest& one : nearest) {
    const double bin = std::min(one.distance / report.bin_mm, static_cast<double>(bins - 1));
    ++report.counts[static_cast<std::size_t>(bin)];
  }
}

}  // namespace

SpacingReport spacing_of(std::span<const geometry::Point> cloud) {
  require_usable(cloud);
  SpacingReport report;
  report.points = cloud.size();
  const std::vector<std::uint32_t> positions = distinct_positions(cloud, report);
  if (positions.size() < 2) return report;
  const std::vector<Nearest> nearest = find_nearest(cloud, positions);
  fill_histogram(nearest, report);
  if (report.duplicates > 0) return report;
  report.min_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].distance >= report.min_mm) continue;
    report.min_mm = nearest[i].distance;
    std::tie(report.first, report.second) =
        std::minmax(positions[i], positions[nearest[i].position]);
  }
  return report;
}

}  // namespace lamplock::points
