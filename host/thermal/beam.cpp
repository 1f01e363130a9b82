#include "host/thermal/beam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lamplock::thermal {
namespace {

/// Three points of Gauss and Legendre on 0..1: the mean over a way.
constexpr std::array<double, 3> gauss_places{0.11270166537925831, 0.5, 0.88729833462074169};
constexpr std::array<double, 3> gauss_weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
/// Places per half width of the beam.
constexpr double places_per_half = 2;
constexpr double negligible_share = 1e-14;

/// Part of the power below a place.
double share_below(double place, double half, bool is_rectangle) {
  if (is_rectangle) return std::clamp(0.5 + place / (2 * half), 0.0, 1.0);
  return 0.5 * std::erfc(-place / half);
}

/// Adds the shares of one place, times a weight.
void add_place(const Grid& grid, const std::vector<double>& x, const std::vector<double>& y,
               double weight, std::vector<double>& surface) {
  for (std::size_t j = 0; j < y.size(); ++j) {
    if (y[j] < negligible_share) continue;
    for (std::size_t i = 0; i < x.size(); ++i) surface[grid.index(i, j, 0)] += weight * x[i] * y[j];
  }
}

}  // namespace

double BeamProfile::peak_per_mm2() const {
  return 1 / ((is_rectangle ? 4 : std::numbers::pi) * half_x_mm * half_y_mm);
}

std::vector<double> lateral_shares(const Axis& axis, double half_mm, bool is_rectangle,
                                   double centre) {
  std::vector<double> shares(axis.size());
  double below = share_below(axis.face(0) - centre, half_mm, is_rectangle);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double next = share_below(axis.face(i + 1) - centre, half_mm, is_rectangle);
    shares[i] = next - below;
    below = next;
  }
  return shares;
}

std::vector<double> depth_shares(const Axis& depth, const Body& body) {
  std::vector<double> shares(depth.size());
  if (!body.absorption_per_mm) {
    shares[0] = 1;
    return shares;
  }
  const double mu = *body.absorption_per_mm;
  for (std::size_t k = 0; k < shares.size(); ++k)
    shares[k] = std::exp(-mu * depth.face(k)) * -std::expm1(-mu * depth.width(k));
  return shares;
}

void absorbed_power(const Grid& grid, const Body& body, const BeamProfile& beam, const BeamWay& way,
                    double power_w, std::vector<double>& power) {
  std::vector<double> surface(grid.surface_size());
  const double length = std::hypot(way.x1 - way.x0, way.y1 - way.y0);
  const double pieces = std::max(1.0, std::ceil(length / beam.radius_mm() * places_per_half / 3));
  for (std::size_t piece = 0; piece < static_cast<std::size_t>(pieces); ++piece) {
    for (std::size_t g = 0; g < gauss_places.size(); ++g) {
      const double part = (static_cast<double>(piece) + gauss_places[g]) / pieces;
      add_place(grid,
                lateral_shares(grid.x, beam.half_x_mm, beam.is_rectangle,
                               way.x0 + (way.x1 - way.x0) * part),
                lateral_shares(grid.y, beam.half_y_mm, beam.is_rectangle,
                               way.y0 + (way.y1 - way.y0) * part),
                gauss_weights[g] / pieces, surface);
      if (length == 0) break;
    }
  }
  // A beam at rest has one place, the first, whose weight is not the whole.
  const double scale = length == 0 ? 1 / gauss_weights[0] : 1;
  const std::vector<double> depth = depth_shares(grid.z, body);
  power.assign(grid.size(), 0);
  for (std::size_t k = 0; k < depth.size(); ++k)
    for (std::size_t i = 0; i < surface.size(); ++i)
      power[k * surface.size() + i] = power_w * body.absorption * scale * surface[i] * depth[k];
}

}  // namespace lamplock::thermal
