#include "host/thermal/surface_loss.hpp"

#include <cmath>
#include <numbers>

namespace lamplock::thermal {
namespace {

constexpr double one_atmosphere_pa = 101'325;

/// L_v m, W/mm2.
double evaporation_w_mm2(const Evaporation& e, double t) {
  const double molar_kg = e.molar_g_mol / 1e3;
  const double per_k = e.latent_j_g * e.molar_g_mol / gas_constant_j_molk;
  const double pressure = one_atmosphere_pa * std::exp(per_k * (1 / e.boiling_k - 1 / t));
  const double kg_m2s =
      pressure * std::sqrt(molar_kg / (2 * std::numbers::pi * gas_constant_j_molk * t));
  return kg_m2s * e.latent_j_g * 1e3 / w_m2_per_w_mm2;
}

}  // namespace

Losses losses_at(const Surface& s, double t) {
  const double t0 = s.ambient_k;
  Losses losses;
  losses.convection = s.convection_w_mm2k * (t - t0);
  losses.radiation = s.emissivity * stefan_boltzmann_w_mm2k4 * (t * t * t * t - t0 * t0 * t0 * t0);
  if (s.evaporation)
    losses.evaporation =
        evaporation_w_mm2(*s.evaporation, t) - evaporation_w_mm2(*s.evaporation, t0);
  return losses;
}

double loss_slope(const Surface& s, double t) {
  double slope = s.convection_w_mm2k + 4 * s.emissivity * stefan_boltzmann_w_mm2k4 * t * t * t;
  if (s.evaporation) {
    const double per_k =
        s.evaporation->latent_j_g * s.evaporation->molar_g_mol / gas_constant_j_molk;
    slope += evaporation_w_mm2(*s.evaporation, t) * (per_k / (t * t) - 0.5 / t);
  }
  return slope;
}

}  // namespace lamplock::thermal
