// The temperature field below a beam that moves over a body: a grid that is fine around the beam
// and covers the whole body.
//
// In:  a body, a beam, its way and power step by step. Out: temperatures. Who: straight_run(),
//      run_path().
//
// The grid remains where it is while the beam is in its fine part, so that no heat is moved
// numerically. When the beam nears the edge of that part, the field is moved to a grid around the
// beam (remap.hpp), with all its energy.
#pragma once

#include "host/thermal/beam.hpp"
#include "host/thermal/heat_solver.hpp"

namespace lamplock::thermal {

struct Meshing {
  double cells_per_radius = 2;  ///< of the beam
  double growth = 1.5;          ///< of distances away from it
  double radii_per_step = 0.5;  ///< way of the beam in a step
};

struct MovingSetup {
  Body body{};
  Surface surface{};
  BeamProfile beam{};
  Meshing meshing{};
  /// Ends of the body. With low_y 0 and a beam along y = 0 it is one half of a symmetrical body,
  /// which receives half of the power.
  double low_x = 0, high_x = 0, low_y = 0, high_y = 0, depth_mm = 0;
  double speed_mm_s = 0;  ///< usual speed: decides how fine the depths are
};

class MovingField {
 public:
  explicit MovingField(const MovingSetup& setup);

  /// The beam moves in a straight line, or rests, with a constant power.
  void advance(const BeamWay& way, double power_w, double step_s);

  /// Largest temperature of the surface.
  double max_surface_k() const;
  /// Temperature at the node of the surface nearest to a place, and of those below it.
  std::vector<double> column_k(double x, double y) const;
  const HeatSolver& solver() const { return solver_; }

 private:
  Grid grid_around(double x, double y) const;

  MovingSetup setup_;
  double centre_x_ = 0, centre_y_ = 0;
  HeatSolver solver_;
  std::vector<double> power_;
};

}  // namespace lamplock::thermal
