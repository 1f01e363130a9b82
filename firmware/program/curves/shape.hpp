// Common parts of all kinds of curves: a plane, even division, and the interface of a shape.
//
// A curve is a shape in a plane; the other axes move evenly along with it. A shape (arc.hpp,
// spline.hpp) returns the number of pieces into which it must be divided and then the ends of the
// pieces in its plane, in sequence; curve.hpp does the rest. Called by the interpreter, main loop.
#pragma once

#include <cstdint>

#include "firmware/program/value.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {

/// Axes of the plane of a curve: anticlockwise is from the first to the second, seen from the
/// positive end of the normal. G17 = {0, 1, 2}, G18 = {2, 0, 1}, G19 = {1, 2, 0}.
struct CurvePlane {
  std::uint8_t first, second, normal;
};

/// Result of begin() of a shape.
struct Division {
  std::uint32_t pieces;    ///< at least 1
  std::int64_t length_e7;  ///< of the whole curve
};

struct PlanePoint {
  std::int64_t first_e7, second_e7;
};

/// The lowest and highest coordinates that something reaches.
struct Range {
  std::int64_t low_e7, high_e7;

  constexpr void add(std::int64_t e7) {
    if (e7 < low_e7) low_e7 = e7;
    if (e7 > high_e7) high_e7 = e7;
  }
};

/// Coordinates and tolerances above this (7 km) are invalid.
inline constexpr std::int64_t max_coordinate_e7 = std::int64_t{1} << 46;

constexpr bool sane(std::int64_t coordinate_e7) {
  return abs64(coordinate_e7) <= max_coordinate_e7;
}
/// Both axes of the plane are valid.
constexpr bool sane(const Place& place, const CurvePlane& plane) {
  return sane(place[plane.first]) && sane(place[plane.second]);
}

/// From one number to another, less than 2^63 apart, in n equal steps, n < 2^31: after i steps the
/// value is from + i (to - from) / n, rounded to nearest, independent of the number of steps.
class IntegerDivider {
 public:
  void begin(std::int64_t from, std::int64_t to, std::uint32_t steps) {
    const std::int64_t way = to - from;
    value_ = from;
    step_ = way / steps;
    std::int64_t rest = way % steps;
    if (rest < 0) {
      rest += steps;
      --step_;
    }
    rest_ = static_cast<std::uint32_t>(rest);
    sum_ = steps / 2;
  }
  std::int64_t value() const { return value_; }
  /// The next value; `steps` as in begin().
  std::int64_t next(std::uint32_t steps) {
    value_ += step_;
    sum_ += rest_;
    if (sum_ >= steps) {
      sum_ -= steps;
      ++value_;
    }
    return value_;
  }

 private:
  std::int64_t value_, step_;
  std::uint32_t rest_, sum_;
};

}  // namespace lamplock::program
