#include "host/thermal/depth_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamplock::thermal {
namespace {

/// Mean intensity over a step, over that in the middle of the beam at rest.
double mean_passage(const DepthSource& source, double from_s, double to_s) {
  if (source.speed_mm_s <= 0) return 1;
  const double from = source.speed_mm_s * (from_s - source.arrival_s());
  const double to = source.speed_mm_s * (to_s - source.arrival_s());
  const double half = source.beam.half_x_mm;
  if (source.beam.is_rectangle)
    return (std::clamp(to, -half, half) - std::clamp(from, -half, half)) / (to - from);
  return std::sqrt(std::numbers::pi) / 2 * half * (std::erf(to / half) - std::erf(from / half)) /
         (to - from);
}

}  // namespace

double DepthResult::rate_k_s(std::size_t time, std::size_t node, double ambient_k) const {
  const double before_k = time == 0 ? ambient_k : temperatures_k[time - 1][node];
  const double before_s = time == 0 ? 0 : times_s[time - 1];
  return (temperatures_k[time][node] - before_k) / (times_s[time] - before_s);
}

double DepthResult::max_surface_k() const {
  double max = 0;
  for (const std::vector<double>& field : temperatures_k) max = std::max(max, field.front());
  return max;
}

double depth_growth(std::size_t nodes) {
  constexpr double usual_growth = 1.03, usual_gaps = 49;
  return std::pow(usual_growth, (usual_gaps - 1) / static_cast<double>(nodes - 2));
}

double reached_depth_mm(const Body& body, double time_s) {
  constexpr double conduction_lengths = 3, absorption_lengths = 7;
  const double absorbed = body.absorption_per_mm ? absorption_lengths / *body.absorption_per_mm : 0;
  return conduction_lengths * std::sqrt(4 * body.diffusivity_mm2_s() * time_s) + absorbed;
}

DepthResult run_depth(const DepthSetup& setup) {
  DepthResult result;
  const Grid grid{Axis::single(1), Axis::single(1),
                  Axis(depth_nodes(setup.depth_mm, setup.nodes, setup.growth))};
  result.depths_mm = grid.z.nodes();
  HeatSolver solver(grid, setup.body, setup.surface);
  const DepthSource& source = setup.source;
  const bool is_flux = source.flux_w_mm2 > 0;
  std::vector<double> shares(grid.size());
  if (is_flux)
    shares[0] = 1;
  else
    shares = depth_shares(grid.z, setup.body);
  const double intensity =
      is_flux ? source.flux_w_mm2
              : setup.body.absorption * source.power_w * source.beam.peak_per_mm2();
  const auto steps =
      static_cast<std::size_t>(std::max(1.0, std::round(setup.time_s / setup.step_s)));
  const double step_s = setup.time_s / static_cast<double>(steps);
  std::vector<double> power(grid.size());
  for (std::size_t n = 0; n < steps; ++n) {
    const double from_s = static_cast<double>(n) * step_s;
    const double now = intensity * (is_flux ? 1 : mean_passage(source, from_s, from_s + step_s));
    for (std::size_t k = 0; k < power.size(); ++k) power[k] = now * shares[k];
    solver.step(step_s, power);
    result.times_s.push_back(from_s + step_s);
    std::vector<double>& field = result.temperatures_k.emplace_back(grid.size());
    for (std::size_t k = 0; k < field.size(); ++k) field[k] = solver.temperature_k(k);
  }
  result.balance = solver.balance();
  return result;
}

double depth_refinement(const DepthSetup& setup, const DepthResult& coarse) {
  DepthSetup fine = setup;
  fine.nodes = 2 * setup.nodes - 1;
  fine.growth = std::sqrt(setup.growth);
  fine.step_s = setup.step_s / 2;
  const double ambient = setup.surface.ambient_k;
  const double rise = coarse.max_surface_k() - ambient;
  const double fine_rise = run_depth(fine).max_surface_k() - ambient;
  return rise > 0 ? std::abs(fine_rise - rise) / rise : 0;
}

}  // namespace lamplock::thermal
