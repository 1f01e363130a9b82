// The temperature field of a body with a heated, cooled surface: finite volumes, implicit in time.
//
// In:  a grid, constants, the power absorbed in each volume. Out: the temperature of each
//      node after a time step, and where the energy is. Who: the runs of this room.
//
//   rho c dT/dt = div(k grad T) + S,   at the surface  -k dT/dz = -losses(T),   other sides
//   adiabatic
//
// Time steps are those of the singly diagonally implicit Runge-Kutta method of order 2 with
// gamma = 1 - 1/sqrt(2) (R. Alexander, SIAM J. Numer. Anal. 14, 1977), which is L-stable: large
// steps do not oscillate. Losses are linearised about the last iterate until they agree with the
// temperature to 1e-5 K. The equations of a column are solved directly, those of a body by
// conjugate gradients with an incomplete Cholesky factor (Eigen).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "host/thermal/constants.hpp"
#include "host/thermal/grid.hpp"
#include "host/thermal/surface_loss.hpp"

namespace lamplock::thermal {

/// J since the begin.
struct EnergyBalance {
  double absorbed_j = 0;
  Losses lost_j{};
  double stored_j = 0;  ///< by the temperatures

  /// Energy that is not accounted for, over that absorbed; 0 if none was absorbed.
  double relative_error() const;
};

class HeatSolver {
 public:
  /// All at ambient temperature.
  HeatSolver(Grid grid, const Body& body, const Surface& surface);
  ~HeatSolver();
  HeatSolver(HeatSolver&&) noexcept;
  HeatSolver& operator=(HeatSolver&&) noexcept;

  /// `power_w`: mean power absorbed in each volume during the step. Throws Error(job_failed) if the
  /// losses or the equations do not converge.
  void step(double step_s, const std::vector<double>& power_w);

  /// Moves the field to another grid with the same ends. The energy remains.
  void change_grid(Grid grid);

  const Grid& grid() const;
  double temperature_k(std::size_t node) const;
  /// Temperature above ambient, of all nodes.
  const std::vector<double>& rises() const;
  double max_rise() const;
  EnergyBalance balance() const;
  /// Losses now, W over the whole surface.
  Losses losses_w() const;

 private:
  struct Equations;
  std::unique_ptr<Equations> equations_;
};

}  // namespace lamplock::thermal
