// Converts brightness to density. Points in glass scatter light, so more points are brighter; the
// density for the brightness of a picture is a power of the picture's value (engraving shops use
// 1.8). In: brightness of a pixel or of a place of a surface. Out: the fraction of the densest
// filling. Called by the discretisers.
#pragma once

#include <string>

namespace lamplock::points {

struct ToneCurve {
  double gamma = 1.8;
  bool invert = false;  // dark becomes dense
  double lowest = 0;    // density of black
  double highest = 1;   // density of white

  /// `brightness` 0..1 (clamped) to density 0..1: lowest + (highest - lowest) * brightness^gamma.
  double density(double brightness) const;
};

/// Throws Error (bad_input) unless gamma is positive and 0 <= lowest <= highest <= 1.
void require_valid(const ToneCurve& tone, const std::string& where);

}  // namespace lamplock::points
