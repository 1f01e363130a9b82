#include "firmware/program/angle.hpp"

#include <array>
#include <bit>
#include <cstddef>

#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr int table_bits = 8;  // places in a turn
constexpr int place_bits = turn_bits - table_bits;
constexpr int quarter = 64;  // places

constexpr std::int64_t rounded_q62(std::int64_t a, std::int64_t b) {
  return ((Int128::product(a, b) + Int128(std::int64_t{1} << 61)) >> 62).to_int64();
}

/// Sine (from x) or cosine (from 1) by its series, at compile time, for x up to pi / 4.
constexpr std::int64_t series_q62(std::int64_t x_q62, bool sine) {
  const std::int64_t square = rounded_q62(x_q62, x_q62);
  std::int64_t term = sine ? x_q62 : one_q62, sum = term;
  for (std::int64_t n = sine ? 2 : 1; term != 0; n += 2) {
    term = -(rounded_q62(term, square) / (n * (n + 1)));
    sum += term;
  }
  return sum;
}

constexpr std::int64_t rounded_to_q48(std::int64_t v_q62) { return (v_q62 + (1 << 13)) >> 14; }

/// Sines of a quarter turn in 64 places; cosines are the same reversed.
constexpr std::array<std::int64_t, quarter + 1> sine_table_q48 = [] {
  std::array<std::int64_t, quarter + 1> table{};
  for (int i = 0; i <= quarter / 2; ++i) {
    const std::int64_t x_q62 = mul_div(radians_of_eighth_q62, i, quarter / 2);
    table[static_cast<std::size_t>(i)] = rounded_to_q48(series_q62(x_q62, true));
    table[static_cast<std::size_t>(quarter - i)] = rounded_to_q48(series_q62(x_q62, false));
  }
  return table;
}();

SineCosine at_place(std::uint32_t place) {
  return {sine_table_q48[place], sine_table_q48[quarter - place]};
}

/// Sine, and 1 - cosine, of an angle of at most half a place.
struct SmallAngle {
  std::int64_t sine_q60;
  std::uint32_t versine_q45;
};

SmallAngle small_angle(std::int64_t angle_q48) {
  // Radians: 2 pi = 8 (pi / 4), and 2^3 2^12 = 2^15. Below 2^-6.3.
  constexpr std::int64_t radians_q48 = rounded_to_q48(radians_of_eighth_q62);
  const bool negative = angle_q48 < 0;
  const std::int64_t size_q48 = negative ? -angle_q48 : angle_q48;
  const std::int64_t x_q60 = times_q48(size_q48 << 15, radians_q48);
  const auto x_q38 = static_cast<std::uint32_t>((x_q60 + (1 << 21)) >> 22);
  const std::uint64_t square_q76 = wide_product(x_q38, x_q38);
  const auto square_q44 = static_cast<std::uint32_t>(square_q76 >> 32);
  const auto fourth_q56 = static_cast<std::uint32_t>(wide_product(square_q44, square_q44) >> 32);
  // x^2 / 2 - x^4 / 24; the next term is below 2^-47. 2^-11 / 24 is 2^32 / 24 in Q43.
  const std::uint32_t versine_q45 =
      static_cast<std::uint32_t>((square_q76 + (1u << 31)) >> 32) -
      static_cast<std::uint32_t>(wide_product(fourth_q56, (1u << 31) / 12) >> 43);
  // x - x (x^2 / 6 - x^4 / 120); 2/3 in Q32, 2^15 / 120 = 273.
  const std::uint32_t less_q46 =
      static_cast<std::uint32_t>(wide_product(square_q44, 0xaaaaaaabu) >> 32) -
      ((fourth_q56 >> 15) * 273 >> 10);
  const auto less_q60 = static_cast<std::int64_t>(wide_product(x_q38, less_q46) >> 24);
  const std::int64_t sine_q60 = x_q60 - less_q60;
  return {negative ? -sine_q60 : sine_q60, versine_q45};
}

/// a (1 - versine) + b sine.
std::int64_t combined_q48(std::int64_t a_q48, std::int64_t b_q48, const SmallAngle& small) {
  const auto a_q31 = static_cast<std::uint32_t>((a_q48 + (1 << 16)) >> 17);
  const auto less_q60 = static_cast<std::int64_t>(wide_product(a_q31, small.versine_q45) >> 16);
  const std::int64_t beside_q60 = times_q48(small.sine_q60, b_q48) - less_q60;
  return a_q48 + ((beside_q60 + (1 << 11)) >> 12);
}

/// Sine and cosine in the first quarter, and slightly outside.
SineCosine in_quarter(std::uint32_t place, std::int64_t beside_q48) {
  const SineCosine at = at_place(place);
  const SmallAngle small = small_angle(beside_q48);
  return {combined_q48(at.sine_q48, at.cosine_q48, small),
          combined_q48(at.cosine_q48, -at.sine_q48, small)};
}

/// Both shifted by the same number of bits so that the larger is from 2^53 to 2^54.
struct Pair {
  std::int64_t x, y;
};
Pair normalised(Int128 x, Int128 y) {
  const Int128 larger = x < y ? y : x;
  const int zeros = larger.hi() != 0 ? std::countl_zero(static_cast<std::uint64_t>(larger.hi()))
                                     : 64 + std::countl_zero(larger.lo());
  const int right = 74 - zeros;  // 128 bits less zeros become 54
  if (right >= 0) return {(x >> right).to_int64(), (y >> right).to_int64()};
  return {(x << -right).to_int64(), (y << -right).to_int64()};
}

/// The table place nearest to a vector with 0 <= y <= x, or its neighbour if both are about as
/// near: atan t = t (pi/4 + 0.273 (1 - t)) to within 0.004 rad.
std::uint32_t near_place(Pair v) {
  constexpr std::uint32_t highest_bit = 1u << 14;  // it is set; a reader sees no division by 0
  const std::uint32_t x = static_cast<std::uint32_t>(v.x >> 39) | highest_bit;
  const std::uint32_t t_q15 = static_cast<std::uint32_t>(v.y >> 24) / x;  // to 2^15
  const std::uint32_t up_q15 = t_q15 > 0x8000u ? 0x8000u : t_q15;
  // 0.273 / (pi / 4) = 0.348 = 11390 / 2^15; 32 places.
  const std::uint32_t bend_q15 = 0x8000u + ((0x8000u - up_q15) * 11390u >> 15);
  return ((up_q15 * bend_q15 >> 15) * 32 + 0x4000u) >> 15;
}

/// The arc tangent of y / x in turns, for |y / x| < 2^-5.9.
std::int64_t small_arc_tangent_q48(Pair v) {
  constexpr std::int64_t turns_of_radian_q48 = rounded_to_q48(turns_of_radian_q62);
  constexpr std::int64_t one_q48 = std::int64_t{1} << 48;
  const bool negative = v.y < 0;
  const auto y = static_cast<std::uint64_t>(negative ? -v.y : v.y);
  // 32 t, so that no bits are lost.
  const std::int64_t t_q53 = quotient_q48(y >> 2, static_cast<std::uint64_t>(v.x >> 7));
  const std::int64_t t_q48 = t_q53 >> 5;
  const std::int64_t square_q53 = times_q48(t_q53, t_q48), square_q48 = square_q53 >> 5;
  // t - t^3/3 + t^5/5 - t^7/7; the next term is below 2^-56.
  std::int64_t sum_q48 = one_q48 / 5 - times_q48(square_q48, one_q48 / 7);
  sum_q48 = one_q48 / 3 - times_q48(square_q48, sum_q48);
  const std::int64_t angle_q53 = t_q53 - times_q48(times_q48(square_q53, sum_q48), t_q48);
  const std::int64_t turns = (times_q48(angle_q53, turns_of_radian_q48) + 16) >> 5;
  return negative ? -turns : turns;
}

/// For 0 <= y <= x, not both 0.
std::int64_t angle_in_eighth_q48(Pair v) {
  const std::uint32_t place = near_place(v);
  const SineCosine at = at_place(place);
  const Pair back = {times_q48(v.x, at.cosine_q48) + times_q48(v.y, at.sine_q48),
                     times_q48(v.y, at.cosine_q48) - times_q48(v.x, at.sine_q48)};
  return (std::int64_t{place} << place_bits) + small_arc_tangent_q48(back);
}

Int128 size_of(Int128 x) { return x.negative() ? -x : x; }

}  // namespace

SineCosine sine_cosine(std::int64_t angle_q48) {
  const auto angle = static_cast<std::uint64_t>(angle_q48);
  const std::uint64_t place = (angle + (std::uint64_t{1} << (place_bits - 1))) >> place_bits;
  const auto beside = static_cast<std::int64_t>(angle - (place << place_bits));
  const SineCosine at = in_quarter(static_cast<std::uint32_t>(place) % quarter, beside);
  switch (place / quarter % 4) {
    case 0:
      return at;
    case 1:
      return {at.cosine_q48, -at.sine_q48};
    case 2:
      return {-at.sine_q48, -at.cosine_q48};
    default:
      return {-at.cosine_q48, at.sine_q48};
  }
}

std::int64_t angle_of(Int128 x, Int128 y) {
  if (x == Int128{} && y == Int128{}) return 0;
  const Int128 across = size_of(x), up = size_of(y);
  const Pair v = normalised(across, up);
  std::int64_t angle =
      v.y <= v.x ? angle_in_eighth_q48(v) : turn_q48 / 4 - angle_in_eighth_q48({v.y, v.x});
  if (x.negative()) angle = turn_q48 / 2 - angle;
  if (y.negative()) angle = turn_q48 - angle;
  return angle;
}

}  // namespace lamplock::program
