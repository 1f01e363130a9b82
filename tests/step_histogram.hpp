// Random walks whose step lengths are those of a real engraved object
// (host/bench/glass_tables.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "host/bench/glass_tables.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::test {

/// `count` points from the origin on, steps in random directions, inside +-`half_size_mm`.
inline geometry::PointCloud histogram_walk(std::size_t count, std::uint64_t seed,
                                           double half_size_mm = 45) {
  std::mt19937_64 random(seed);
  std::normal_distribution<> normal;
  std::array<double, bench::glass_step_lengths.size()> shares{};
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i] = bench::glass_step_lengths[i].fraction;
  std::discrete_distribution<std::size_t> pick(shares.begin(), shares.end());
  geometry::PointCloud cloud;
  std::array<double, 3> at{};
  for (std::size_t i = 0; i < count; ++i) {
    const double length_mm = bench::glass_step_lengths[pick(random)].step_um / 1000;
    std::array<double, 3> way{normal(random), normal(random), normal(random)};
    const double norm = std::hypot(way[0], way[1], way[2]);
    for (std::size_t a = 0; a < 3; ++a) {
      way[a] *= length_mm / norm;
      at[a] += std::abs(at[a] + way[a]) > half_size_mm ? -way[a] : way[a];
    }
    cloud.push_back({at[0], at[1], at[2]});
  }
  return cloud;
}

}  // namespace lamplock::test
