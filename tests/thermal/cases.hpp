// Materials and columns that several tests of the temperature field use.
#pragma once

#include <cstddef>
#include <vector>

#include "host/thermal/heat_solver.hpp"

namespace lamplock::thermal::test {

/// Acrylic with k = 0.19 W/(m K), rho = 1180 kg/m3, c = 1466 J/(kg K).
inline Body acrylic() { return {0.19e-3, 1.18e-3 * 1.466, 1, {}}; }

inline Surface no_losses() { return {}; }

/// A surface on which each of the losses has a share. The constants of evaporation are those of
/// water (CRC Handbook of Chemistry and Physics).
inline Surface hot_surface() { return {293.15, 10e-6, 0.9, Evaporation{2257, 18.015, 373.15}}; }

/// `count` nodes at equal distances, at least two.
inline std::vector<double> uniform_nodes(double low, double high, std::size_t count) {
  std::vector<double> nodes;
  nodes.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    nodes.push_back(low + (high - low) * static_cast<double>(i) / static_cast<double>(count - 1));
  return nodes;
}

/// A column of 1 mm2.
inline Grid column(double depth_mm, std::size_t nodes) {
  return {Axis::single(1), Axis::single(1), Axis(uniform_nodes(0, depth_mm, nodes))};
}

/// `flux_w_mm2` into the surface of a column.
inline std::vector<double> into_surface(const Grid& grid, double flux_w_mm2) {
  std::vector<double> power(grid.size());
  power[0] = flux_w_mm2;
  return power;
}

}  // namespace lamplock::thermal::test
