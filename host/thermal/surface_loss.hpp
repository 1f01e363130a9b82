// Heat that leaves the surface: convection, radiation, evaporation.
//
// In:  the constants of a surface, its temperature. Out: W/mm2 of each, and their derivative.
// Who: the heat solver, the tables of shares.
//
//   convection   h (T - T0)
//   radiation    eps sigma (T^4 - T0^4)                                (Stefan, Boltzmann)
//   evaporation  L_v m(T),  m = p(T) sqrt(M / (2 pi R T))              (Hertz, Knudsen)
//                p = 101 325 Pa exp(L_v M / R (1/T_b - 1/T))           (Clausius, Clapeyron)
//
// All vapour leaves: an accommodation coefficient of 1 and no vapour that condenses again, so the
// evaporation is the largest that is possible. That at ambient temperature is subtracted.
#pragma once

#include "host/thermal/constants.hpp"

namespace lamplock::thermal {

/// W/mm2; in sums over a surface and a time, J.
struct Losses {
  double convection = 0, radiation = 0, evaporation = 0;
  double total() const { return convection + radiation + evaporation; }
};

/// At a temperature of the surface, above 0 K.
Losses losses_at(const Surface& surface, double temperature_k);
/// Derivative of the sum, W/(mm2 K).
double loss_slope(const Surface& surface, double temperature_k);

}  // namespace lamplock::thermal
