// Products, quotients and roots that are wider than 64 bits on the way.
//
// Positions have 38 bits and fractions 62, so nearly everything that curves compute has about 100.
// Called when a curve begins (quotients and roots, 1000 cycles and more each) and for each of its
// pieces (products only, about 200 cycles each).
#pragma once

#include <cstdint>

#include "shared/int128.hpp"

namespace lamplock::program {

/// a b 2^-62, rounded to nearest; the result must fit.
std::int64_t times_q62(std::int64_t a, std::int64_t b_q62);

/// 2^62 a / b, rounded down, for a <= b < 2^63; 0 for b = 0.
std::int64_t quotient_q62(std::uint64_t a, std::uint64_t b);

/// Largest r with r r <= x, for 0 <= x < 2^126.
std::uint64_t wide_root(Int128 x);

/// Length of a vector of less than 2^61 on each axis, rounded down.
std::int64_t length_of(std::int64_t x, std::int64_t y);

}  // namespace lamplock::program
