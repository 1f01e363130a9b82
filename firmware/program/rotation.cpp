#include "firmware/program/rotation.hpp"

#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr std::int64_t right_angle_e7 = 90 * one_e7;
/// pi / 180 / 10^7 in Q92: what 10^-7 degrees are in radians.
constexpr std::int64_t radian_q92 = 8'642'451'851'119'134'904;

std::int64_t mul_q62(std::int64_t a, std::int64_t b) {
  return (Int128::product(a, b) >> 62).to_int64();
}

/// Power series of sine (from term 1) or cosine (from term 0) at x of at most pi/4: terms after
/// x^19 / 19! are below 2^-66.
std::int64_t series_q62(std::int64_t term_q62, std::uint32_t n, std::int64_t square_q62) {
  std::int64_t sum = 0;
  for (; term_q62 != 0 && n < 22; n += 2) {
    sum += term_q62;
    term_q62 = -mul_q62(term_q62, square_q62) / std::int64_t{(n + 1) * (n + 2)};
  }
  return sum;
}

struct SineCosineQ62 {
  std::int64_t sine_q62, cosine_q62;
};

/// Of 0 to 45 degrees.
SineCosineQ62 of_half_quadrant(std::int64_t angle_e7) {
  const std::int64_t x_q62 = (Int128::product(angle_e7, radian_q92) >> 30).to_int64();
  const std::int64_t square_q62 = mul_q62(x_q62, x_q62);
  return {series_q62(x_q62, 1, square_q62), series_q62(one_q62, 0, square_q62)};
}

SineCosineQ62 of_angle(std::int64_t angle_e7) {
  std::int64_t rest = angle_e7 % (4 * right_angle_e7);
  if (rest < 0) rest += 4 * right_angle_e7;
  int quadrant = 0;
  for (; rest >= right_angle_e7; ++quadrant) rest -= right_angle_e7;
  SineCosineQ62 s{};
  if (2 * rest <= right_angle_e7) {
    s = of_half_quadrant(rest);
  } else {
    const SineCosineQ62 other = of_half_quadrant(right_angle_e7 - rest);
    s = {other.cosine_q62, other.sine_q62};
  }
  for (; quadrant > 0; --quadrant) s = {s.cosine_q62, -s.sine_q62};
  return s;
}

/// (a b + c d) / 2^62, rounded to nearest.
std::int64_t sum_of_products(std::int64_t a, std::int64_t b_q62, std::int64_t c,
                             std::int64_t d_q62) {
  const Int128 sum = Int128::product(a, b_q62) + Int128::product(c, d_q62);
  return ((sum + Int128{one_q62 / 2}) >> 62).to_int64();
}

}  // namespace

Rotation::Rotation(int first, int second, const Place& centre_e7, std::int64_t angle_e7)
    : angle_e7_(angle_e7),
      first_centre_e7_(centre_e7[index(first)]),
      second_centre_e7_(centre_e7[index(second)]),
      first_(static_cast<std::uint8_t>(first)),
      second_(static_cast<std::uint8_t>(second)),
      active_(true) {
  const SineCosineQ62 s = of_angle(angle_e7);
  sine_q62_ = s.sine_q62;
  cosine_q62_ = s.cosine_q62;
}

Place Rotation::turn(const Place& place, std::int64_t sine_q62) const {
  const std::int64_t x = place[first_] - first_centre_e7_, y = place[second_] - second_centre_e7_;
  Place out = place;
  out[first_] = first_centre_e7_ + sum_of_products(x, cosine_q62_, -y, sine_q62);
  out[second_] = second_centre_e7_ + sum_of_products(x, sine_q62, y, cosine_q62_);
  return out;
}

Place Rotations::turned(const Place& place) const { return program.turned(system.turned(place)); }

Place Rotations::turned_back(const Place& place) const {
  return system.turned_back(program.turned_back(place));
}

}  // namespace lamplock::program
