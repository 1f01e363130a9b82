#include "host/thermal/heat_solver.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host/error.hpp"
#include "host/thermal/remap.hpp"

namespace lamplock::thermal {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;

constexpr double stage_gamma = 1 - 1 / std::numbers::sqrt2;
constexpr double solver_tolerance = 1e-11;
constexpr int max_solver_rounds = 2000;
constexpr double loss_tolerance_k = 1e-5;
constexpr int max_loss_rounds = 100;
/// Bounds of the change of a temperature from iterate to iterate. Evaporation grows exponentially:
/// a tangent at a low temperature leads to one that no material has.
constexpr double max_heating = 1.25, max_cooling = 0.5;

Error no_convergence(const char* what) {
  return {Exit::job_failed, "temperature field", what,
          "shorten the time step, lower the power, or leave out losses by --losses"};
}

}  // namespace

double EnergyBalance::relative_error() const {
  if (absorbed_j == 0) return 0;
  return std::abs(absorbed_j - lost_j.total() - stored_j) / absorbed_j;
}

struct HeatSolver::Equations {
  using Direct = Eigen::SimplicialLDLT<Matrix>;
  using Iterative = Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper,
                                             Eigen::IncompleteCholesky<double>>;

  Grid grid;
  Body body;
  Surface surface;
  Vector capacity;            ///< J/K of each volume
  std::vector<double> rises;  ///< K
  Vector before;              ///< rises at the step before, for a first guess
  Matrix matrix;              ///< of a stage
  Vector diagonal;            ///< of the matrix without losses
  double step_s = 0;          ///< for which the matrix was made; 0: none
  Direct direct;
  Iterative iterative;
  bool had_steep = false;  ///< the incomplete factor is that of large slopes
  EnergyBalance energy{};

  Equations(Grid a_grid, const Body& a_body, const Surface& a_surface)
      : grid(std::move(a_grid)), body(a_body), surface(a_surface) {
    measure();
    rises.assign(grid.size(), 0);
  }

  bool is_direct() const { return grid.surface_size() == 1; }
  double area(std::size_t node) const {
    const std::size_t i = node % grid.x.size(), j = node / grid.x.size();
    return grid.x.width(i) * grid.y.width(j);
  }

  void measure() {
    capacity.resize(static_cast<Eigen::Index>(grid.size()));
    for (std::size_t k = 0; k < grid.z.size(); ++k)
      for (std::size_t j = 0; j < grid.y.size(); ++j)
        for (std::size_t i = 0; i < grid.x.size(); ++i)
          capacity[static_cast<Eigen::Index>(grid.index(i, j, k))] =
              body.heat_j_mm3k * grid.x.width(i) * grid.y.width(j) * grid.z.width(k);
    before.resize(0);
    step_s = 0;
  }

  /// C / (gamma dt) + K.
  void make_matrix(double new_step_s) {
    if (new_step_s == step_s) return;
    step_s = new_step_s;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(grid.size() * 7);
    diagonal = capacity / (stage_gamma * step_s);
    const auto join = [&](std::size_t a, std::size_t b, double w_k) {
      const auto row = static_cast<Eigen::Index>(a), column = static_cast<Eigen::Index>(b);
      entries.emplace_back(row, column, -w_k);
      entries.emplace_back(column, row, -w_k);
      diagonal[row] += w_k;
      diagonal[column] += w_k;
    };
    const double conductivity = body.conductivity_w_mmk;
    for (std::size_t k = 0; k < grid.z.size(); ++k)
      for (std::size_t j = 0; j < grid.y.size(); ++j)
        for (std::size_t i = 0; i < grid.x.size(); ++i) {
          const double dx = grid.x.width(i), dy = grid.y.width(j), dz = grid.z.width(k);
          const std::size_t here = grid.index(i, j, k);
          if (i + 1 < grid.x.size())
            join(here, grid.index(i + 1, j, k), conductivity * dy * dz / grid.x.gap(i));
          if (j + 1 < grid.y.size())
            join(here, grid.index(i, j + 1, k), conductivity * dx * dz / grid.y.gap(j));
          if (k + 1 < grid.z.size())
            join(here, grid.index(i, j, k + 1), conductivity * dx * dy / grid.z.gap(k));
        }
    for (Eigen::Index n = 0; n < diagonal.size(); ++n) entries.emplace_back(n, n, diagonal[n]);
    const auto size = static_cast<Eigen::Index>(grid.size());
    matrix.resize(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (is_direct()) {
      direct.analyzePattern(matrix);
      direct.factorize(matrix);
    } else {
      make_iterative();
      had_steep = false;
    }
  }

  void make_iterative() {
    iterative.setTolerance(solver_tolerance);
    iterative.setMaxIterations(max_solver_rounds);
    iterative.compute(matrix);
  }

  /// The matrix has the slopes of the losses about these rises. The incomplete factor of the
  /// iterative solver, which only speeds the solution up, is made again for large slopes.
  void set_slopes(const Vector& guess, Vector& right) {
    bool is_steep = false;
    for (std::size_t n = 0; n < grid.surface_size(); ++n) {
      const auto row = static_cast<Eigen::Index>(n);
      const double t = surface.ambient_k + guess[row];
      const double slope = area(n) * loss_slope(surface, t);
      matrix.coeffRef(row, row) = diagonal[row] + slope;
      is_steep = is_steep || slope > diagonal[row];
      right[row] += slope * guess[row] - area(n) * losses_at(surface, t).total();
    }
    if (is_direct())
      direct.factorize(matrix);
    else if (is_steep || had_steep)
      make_iterative();
    had_steep = is_steep;
  }

  Vector solve(const Vector& right, const Vector& guess) {
    if (is_direct()) return direct.solve(right);
    Vector found = iterative.solveWithGuess(right, guess);
    if (iterative.info() != Eigen::Success)
      throw no_convergence("the equations of a time step do not converge");
    // What remains is spread over all nodes so that the sum of the equations holds: it is the
    // balance of energy.
    const double remains = right.sum() - (matrix * found).sum();
    found.array() += remains / matrix.sum();
    return found;
  }

  /// Rises at the end of a stage: C (u - base) / (gamma dt) + K u + losses(u) = power.
  Vector stage(const Vector& base, const Vector& power, Vector guess) {
    const Vector right = capacity.cwiseProduct(base) / (stage_gamma * step_s) + power;
    if (!surface.has_losses()) return solve(right, guess);
    // A guess from two steps may be colder than any temperature.
    guess = guess.cwiseMax(-max_cooling * surface.ambient_k);
    for (int round = 0; round < max_loss_rounds; ++round) {
      Vector with_losses = right;
      set_slopes(guess, with_losses);
      Vector found = solve(with_losses, guess);
      const auto surface_part = static_cast<Eigen::Index>(grid.surface_size());
      const auto was = guess.head(surface_part).array() + surface.ambient_k;
      const Eigen::ArrayXd low = max_cooling * was, high = max_heating * was;
      const double change = (found - guess).head(surface_part).cwiseAbs().maxCoeff();
      guess = std::move(found);
      if (change < loss_tolerance_k) return guess;
      guess.head(surface_part) =
          (guess.head(surface_part).array() + surface.ambient_k).max(low).min(high).matrix() -
          Vector::Constant(surface_part, surface.ambient_k);
    }
    throw no_convergence("the losses of the surface do not converge");
  }

  Losses lost_w(const double* rise) const {
    Losses sum;
    if (!surface.has_losses()) return sum;
    for (std::size_t n = 0; n < grid.surface_size(); ++n) {
      const Losses one = losses_at(surface, surface.ambient_k + rise[n]);
      sum.convection += area(n) * one.convection;
      sum.radiation += area(n) * one.radiation;
      sum.evaporation += area(n) * one.evaporation;
    }
    return sum;
  }

  void count_losses(const Vector& rise, double seconds) {
    const Losses lost = lost_w(rise.data());
    energy.lost_j.convection += seconds * lost.convection;
    energy.lost_j.radiation += seconds * lost.radiation;
    energy.lost_j.evaporation += seconds * lost.evaporation;
  }

  void step(double seconds, const std::vector<double>& power_w) {
    make_matrix(seconds);
    const auto size = static_cast<Eigen::Index>(grid.size());
    const Vector now = Eigen::Map<const Vector>(rises.data(), size);
    const Vector power = Eigen::Map<const Vector>(power_w.data(), size);
    const Vector change = before.size() == size ? Vector(now - before) : Vector::Zero(size);
    const Vector middle = stage(now, power, now + stage_gamma * change);
    const Vector base = now + (1 - stage_gamma) / stage_gamma * (middle - now);
    const Vector end = stage(base, power, now + (middle - now) / stage_gamma);
    count_losses(middle, (1 - stage_gamma) * seconds);
    count_losses(end, stage_gamma * seconds);
    energy.absorbed_j += seconds * power.sum();
    before = now;
    Eigen::Map<Vector>(rises.data(), size) = end;
  }
};

HeatSolver::HeatSolver(Grid grid, const Body& body, const Surface& surface)
    : equations_(std::make_unique<Equations>(std::move(grid), body, surface)) {}
HeatSolver::~HeatSolver() = default;
HeatSolver::HeatSolver(HeatSolver&&) noexcept = default;
HeatSolver& HeatSolver::operator=(HeatSolver&&) noexcept = default;

void HeatSolver::step(double step_s, const std::vector<double>& power_w) {
  equations_->step(step_s, power_w);
}

void HeatSolver::change_grid(Grid grid) {
  equations_->rises = remapped(equations_->rises, equations_->grid, grid);
  equations_->grid = std::move(grid);
  equations_->measure();
}

const Grid& HeatSolver::grid() const { return equations_->grid; }
double HeatSolver::temperature_k(std::size_t node) const {
  return equations_->surface.ambient_k + equations_->rises[node];
}
const std::vector<double>& HeatSolver::rises() const { return equations_->rises; }
double HeatSolver::max_rise() const {
  return *std::max_element(equations_->rises.begin(), equations_->rises.end());
}
EnergyBalance HeatSolver::balance() const {
  EnergyBalance balance = equations_->energy;
  const auto size = static_cast<Eigen::Index>(equations_->rises.size());
  balance.stored_j =
      equations_->capacity.dot(Eigen::Map<const Vector>(equations_->rises.data(), size));
  return balance;
}
Losses HeatSolver::losses_w() const { return equations_->lost_w(equations_->rises.data()); }

}  // namespace lamplock::thermal
