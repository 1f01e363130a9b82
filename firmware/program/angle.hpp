// Angles as fractions of a turn, their sines and cosines, and the angle of a vector.
//
// An angle counts 2^-48 of a turn ("q48"): on a circle of 4 m radius 10^-10 mm, so angles can be
// divided and added without regard to rounding, and whole turns vanish by wrapping.
//
// Sine and cosine: a table of 65 sines of a quarter turn gives the nearest multiple of a 256th
// turn; the rest is at most 2^-6.3 rad, where few terms of the series are enough. Small terms are
// computed with few bits. The error is below 2^-43.5 (measured by tests/program/angle_test.cpp): 3
// 10^-10 mm at 4 m radius. 16 products of 32 x 32 bits.
//
// Angle of a vector: the vector is turned back by the nearest table place, and the series of the
// arc tangent gives the rest; only when a curve begins.
#pragma once

#include <cstdint>

#include "shared/int128.hpp"

namespace lamplock::program {

inline constexpr int turn_bits = 48;
inline constexpr std::int64_t turn_q48 = std::int64_t{1} << turn_bits;
/// Pi / 4 and 1 / (2 pi).
inline constexpr std::int64_t radians_of_eighth_q62 = 3'622'009'729'038'561'421;
inline constexpr std::int64_t turns_of_radian_q62 = 733'972'625'820'500'307;

struct SineCosine {
  std::int64_t sine_q48, cosine_q48;
};

/// Of any angle, also negative or of several turns.
SineCosine sine_cosine(std::int64_t angle_q48);

/// Angle from the first axis to the vector (x, y), from 0 to one turn, within 2 units; 0 for the
/// zero vector. |x|, |y| < 2^126.
std::int64_t angle_of(Int128 x, Int128 y);

}  // namespace lamplock::program
