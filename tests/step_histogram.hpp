// Walks through space whose steps are as long as those of a real engraved object.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "host/points/point.hpp"

namespace lamplock::test {

/// Points of the object.
inline constexpr std::size_t histogram_object_points = 16'179;

/// Length of a step and the share of steps that have it. Fitted to the measured times of the
/// object of 16 179 points in "Mechatroniczne pozycjonowanie wiazki lasera impulsowego w
/// urzadzeniach do formowania obiektow trojwymiarowych w szkle".
struct StepShare {
  double um;
  double share;
};
inline constexpr std::array<StepShare, 24> step_histogram{{
    {45, .4228},  {56, .0840},  {70, .0416},  {80, .0538},   {94, .0353},   {106, .0377},
    {119, .0306}, {131, .0463}, {144, .0119}, {156, .0278},  {169, .0278},  {181, .0340},
    {194, .0362}, {206, .0143}, {231, .0147}, {275, .0161},  {325, .0166},  {375, .0139},
    {425, .0077}, {475, .0087}, {600, .0066}, {1000, .0102}, {5000, .0007}, {20000, .0005},
}};

/// `count` points from the origin on, steps in random directions, inside +-`half_size_mm`.
inline points::PointCloud histogram_walk(std::size_t count, std::uint64_t seed,
                                         double half_size_mm = 45) {
  std::mt19937_64 random(seed);
  std::normal_distribution<> normal;
  std::array<double, step_histogram.size()> shares{};
  for (std::size_t i = 0; i < shares.size(); ++i) shares[i] = step_histogram[i].share;
  std::discrete_distribution<std::size_t> pick(shares.begin(), shares.end());
  points::PointCloud cloud;
  std::array<double, 3> at{};
  for (std::size_t i = 0; i < count; ++i) {
    const double length_mm = step_histogram[pick(random)].um / 1000;
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
