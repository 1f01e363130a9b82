// The temperature in depth alone, below a flux or below the middle of a beam that passes.
//
// In:  a material, a source, time, nodes and steps. Out: temperatures and heating rates of
//      each node at each step, the balance of energy. Who: `lamplock heat` without a program.
//
// Heat flows in depth only: right for a source that is wide against the depth that is heated.
// A passing Gaussian beam has the intensity I(t) = P/(pi w^2) exp(-(v (t - t0) / w)^2).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/thermal/beam.hpp"
#include "host/thermal/heat_solver.hpp"

namespace lamplock::thermal {

struct DepthSource {
  double flux_w_mm2 = 0;  ///< absorbed in the surface; 0: the beam
  BeamProfile beam{};
  double power_w = 0, speed_mm_s = 0;  ///< speed 0: the beam rests
  /// Time from the begin to the beam's middle: where the intensity is exp(-9) of its maximum.
  double arrival_s() const { return speed_mm_s > 0 ? 3 * beam.half_x_mm / speed_mm_s : 0; }
};

struct DepthSetup {
  Body body{};
  Surface surface{};
  DepthSource source{};
  double depth_mm = 0, time_s = 1;
  std::size_t nodes = 50;
  double step_s = 0.05;
  /// Of the distances between nodes; with `depth_growth()` the last one is as many times the first
  /// for every number of nodes.
  double growth = 1.03;
};

struct DepthResult {
  std::vector<double> depths_mm{}, times_s{};         ///< times from the end of the first step
  std::vector<std::vector<double>> temperatures_k{};  ///< of each time, all nodes
  EnergyBalance balance{};

  /// K/s in the step that ends at a time.
  double rate_k_s(std::size_t time, std::size_t node, double ambient_k) const;
  double max_surface_k() const;
};

/// 1.03 for 50 nodes. At least three nodes.
double depth_growth(std::size_t nodes);

/// A depth that the heat does not reach in this time: 3 sqrt(4 alpha t), and the beam's absorption.
double reached_depth_mm(const Body& body, double time_s);

DepthResult run_depth(const DepthSetup& setup);

/// Change of the largest rise of the surface with half the distances and half the steps, over that
/// rise.
double depth_refinement(const DepthSetup& setup, const DepthResult& coarse);

}  // namespace lamplock::thermal
