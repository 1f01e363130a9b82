// What the line planner needs of Real beyond products: differences, roots, and a form to keep.
//
// In:  numbers as in path_real.hpp, positive or zero.
// Out: the same. A LinePacked is four bytes, for the ring of lines; it is rounded down, so that a
//      limit that is kept is never above the limit.
// Called by the line planner (main loop, or the core that plans).
#pragma once

#include <cstdint>

#include "firmware/motion/path_real.hpp"

namespace lamplock::motion {

inline Real least(Real a, Real b) { return b < a ? b : a; }
inline Real most(Real a, Real b) { return a < b ? b : a; }
inline bool is_zero(Real a) { return a.mantissa() == 0; }

/// a 2^n, exact.
inline Real times_power(Real a, int n) { return Real(a.mantissa(), a.exponent() + n); }

/// a - b, or zero if that is negative.
Real difference(Real a, Real b);

/// Rounded down, 31 significant bits or more.
Real square_root(Real a);

/// Whole number, rounded up; `most` if it is above that.
std::uint32_t whole_up(Real a, std::uint32_t most);
/// The same rounded down.
std::uint32_t whole_down(Real a, std::uint32_t most);

/// A Real of 24 significant bits.
class LinePacked {
 public:
  LinePacked() = default;
  explicit LinePacked(Real value);

  Real real() const;
  friend bool operator==(LinePacked, LinePacked) = default;
  friend bool operator<(LinePacked a, LinePacked b) { return a.bits_ < b.bits_; }

 private:
  std::uint32_t bits_ = 0;  ///< exponent above mantissa: compares as the number does
};

}  // namespace lamplock::motion
