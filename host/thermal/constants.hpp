// Constants of a material and of its surface for the temperature field, in mm, s, W, J and K.
//
// In:  numbers of the material library (host/material) or of a test. Who: every model of this room.
#pragma once

#include <optional>

namespace lamplock::thermal {

inline constexpr double stefan_boltzmann_w_mm2k4 = 5.670374419e-14;  ///< CODATA 2018
inline constexpr double gas_constant_j_molk = 8.314462618;           ///< CODATA 2018
inline constexpr double zero_celsius_k = 273.15;
inline constexpr double w_m2_per_w_mm2 = 1e6;

/// Of the body: conduction, and where the beam is absorbed.
struct Body {
  double conductivity_w_mmk = 0;  ///< k
  double heat_j_mm3k = 0;         ///< rho c, volumetric heat capacity
  double absorption = 1;          ///< 1 - R, part of the power that enters the body
  /// mu of Beer and Lambert; empty: all power is absorbed in the surface.
  std::optional<double> absorption_per_mm{};

  double diffusivity_mm2_s() const { return conductivity_w_mmk / heat_j_mm3k; }
};

/// What the law of Hertz and Knudsen needs.
struct Evaporation {
  double latent_j_g = 0;   ///< L_v
  double molar_g_mol = 0;  ///< M
  double boiling_k = 0;    ///< at 101 325 Pa
};

/// Of the surface that the beam hits.
struct Surface {
  double ambient_k = 293.15;
  double convection_w_mm2k = 0;  ///< h; 0: none
  double emissivity = 0;         ///< 0: no radiation
  std::optional<Evaporation> evaporation{};

  bool has_losses() const {
    return convection_w_mm2k > 0 || emissivity > 0 || evaporation.has_value();
  }
};

}  // namespace lamplock::thermal
