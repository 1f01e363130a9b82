#include "host/thermal/moving_field.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::thermal {
namespace {

/// Fine part of the grid at each side of the beam, and where the beam leaves it, in radii.
constexpr double fine_radii = 3, reach_radii = 1.2;

/// Distances near the surface resolve the depth in which the power is absorbed, or that the heat
/// reaches while the beam passes.
double fine_depth(const MovingSetup& setup) {
  const double radius = setup.beam.radius_mm();
  double depth = radius;
  if (setup.speed_mm_s > 0)
    depth = std::sqrt(setup.body.diffusivity_mm2_s() * radius / setup.speed_mm_s);
  if (setup.body.absorption_per_mm) depth = std::max(depth, 1 / *setup.body.absorption_per_mm);
  return std::min({radius, depth, setup.depth_mm}) / (setup.meshing.cells_per_radius + 1);
}

}  // namespace

MovingField::MovingField(const MovingSetup& setup)
    : setup_(setup), solver_(grid_around(0, 0), setup.body, setup.surface) {}

Grid MovingField::grid_around(double x, double y) const {
  const double rx = setup_.beam.half_x_mm, ry = setup_.beam.half_y_mm;
  const Meshing& mesh = setup_.meshing;
  return {Axis(graded_nodes(setup_.low_x, setup_.high_x, x - fine_radii * rx, x + fine_radii * rx,
                            {rx / mesh.cells_per_radius, mesh.growth})),
          Axis(graded_nodes(setup_.low_y, setup_.high_y, y - fine_radii * ry, y + fine_radii * ry,
                            {ry / mesh.cells_per_radius, mesh.growth})),
          Axis(graded_nodes(0, setup_.depth_mm, 0, 0, {fine_depth(setup_), mesh.growth}))};
}

void MovingField::advance(const BeamWay& way, double power_w, double step_s) {
  const auto is_outside = [&](double x, double y) {
    return std::abs(x - centre_x_) > reach_radii * setup_.beam.half_x_mm ||
           std::abs(y - centre_y_) > reach_radii * setup_.beam.half_y_mm;
  };
  // A dark way needs no fine grid.
  if (power_w > 0 && (is_outside(way.x0, way.y0) || is_outside(way.x1, way.y1))) {
    const double length = std::hypot(way.x1 - way.x0, way.y1 - way.y0);
    // The beam continues: the middle is ahead, so that grids change seldom.
    const double ahead = length > 0 ? reach_radii * setup_.beam.radius_mm() / length : 0;
    centre_x_ = way.x0 + std::min(ahead, 1.0) * (way.x1 - way.x0);
    centre_y_ = way.y0 + std::min(ahead, 1.0) * (way.y1 - way.y0);
    solver_.change_grid(grid_around(centre_x_, centre_y_));
  }
  absorbed_power(solver_.grid(), setup_.body, setup_.beam, way, power_w, power_);
  solver_.step(step_s, power_);
}

double MovingField::max_surface_k() const {
  const auto begin = solver_.rises().begin();
  const auto count = static_cast<std::ptrdiff_t>(solver_.grid().surface_size());
  return setup_.surface.ambient_k + *std::max_element(begin, begin + count);
}

std::vector<double> MovingField::column_k(double x, double y) const {
  const Grid& grid = solver_.grid();
  const std::size_t i = grid.x.nearest(x), j = grid.y.nearest(y);
  std::vector<double> column(grid.z.size());
  for (std::size_t k = 0; k < column.size(); ++k)
    column[k] = solver_.temperature_k(grid.index(i, j, k));
  return column;
}

}  // namespace lamplock::thermal
