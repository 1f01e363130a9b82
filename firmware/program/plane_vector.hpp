// Vectors in the plane of a curve, with exact products.
#pragma once

#include <cstdint>

#include "shared/int128.hpp"

namespace lamplock::program {

/// At most 2^61 on each axis.
struct Vector {
  std::int64_t x, y;
};

inline Int128 dot(Vector a, Vector b) {
  return Int128::product(a.x, b.x) + Int128::product(a.y, b.y);
}
/// Above 0 if b is to the left of a.
inline Int128 cross(Vector a, Vector b) {
  return Int128::product(a.x, b.y) - Int128::product(a.y, b.x);
}

}  // namespace lamplock::program
