// Products, quotients and roots with intermediate results above 64 bits.
//
// Positions have 38 bits and fractions 62, so nearly all numbers of curves have about 100.
// Quotients, roots and exact products are computed only when a curve begins; each of its pieces
// uses times_q48(), three products of 32 x 32 bits.
#pragma once

#include <cstdint>

#include "shared/int128.hpp"

namespace lamplock::program {

/// a b 2^-62, rounded to nearest; the result must fit.
[[gnu::cold]] std::int64_t times_q62(std::int64_t a, std::int64_t b_q62);

/// a b 2^-48, towards zero and up to 2 nearer to it; |a| < 2^55, |b| <= 2^48.
std::int64_t times_q48(std::int64_t a, std::int64_t b_q48);

/// 2^48 a / b, rounded down, for a <= b < 2^48; 0 for b = 0.
std::int64_t quotient_q48(std::uint64_t a, std::uint64_t b);

/// Largest r with r r <= x, for 0 <= x < 2^126.
std::uint64_t wide_root(Int128 x);

/// Length of a vector of less than 2^61 on each axis, rounded down.
std::int64_t length_of(std::int64_t x, std::int64_t y);

}  // namespace lamplock::program
