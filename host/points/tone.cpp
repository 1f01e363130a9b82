#include "host/points/tone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::points {

double ToneCurve::density(double brightness) const {
  // Written so that NaN counts as black.
  const double value = brightness > 0 ? std::min(brightness, 1.0) : 0.0;
  return lowest + (highest - lowest) * std::pow(invert ? 1 - value : value, gamma);
}

void require_valid(const ToneCurve& tone, const std::string& where) {
  geometry::require_positive(tone.gamma, where, "gamma");
  if (tone.lowest >= 0 && tone.lowest <= tone.highest && tone.highest <= 1) return;
  throw Error(Exit::bad_input, where,
              fmt::format("densities from {} to {}", tone.lowest, tone.highest),
              "give a lowest and a highest density from 0 to 1");
}

}  // namespace lamplock::points
