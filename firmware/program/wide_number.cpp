#include "firmware/program/wide_number.hpp"

#include <bit>

#include "shared/fixed_point.hpp"

namespace lamplock::program {

std::int64_t times_q62(std::int64_t a, std::int64_t b_q62) {
  const Int128 product = Int128::product(a, b_q62) + Int128(std::int64_t{1} << 61);
  // Shifted by 62: two bits of the lower half.
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(product.hi()) << 2 |
                                   product.lo() >> 62);
}

std::int64_t times_q48(std::int64_t a, std::int64_t b_q48) {
  // Both in parts of 24 bits. The product of the lower ones is omitted: less than 1.
  const auto u = static_cast<std::uint64_t>(a < 0 ? -a : a);
  const auto v = static_cast<std::uint64_t>(b_q48 < 0 ? -b_q48 : b_q48);
  constexpr std::uint32_t mask = (1u << 24) - 1;
  const auto u1 = static_cast<std::uint32_t>(u >> 24), v1 = static_cast<std::uint32_t>(v >> 24);
  const auto u0 = static_cast<std::uint32_t>(u) & mask, v0 = static_cast<std::uint32_t>(v) & mask;
  const std::uint64_t sum =
      wide_product(u1, v1) + ((wide_product(u1, v0) + wide_product(u0, v1)) >> 24);
  const auto size = static_cast<std::int64_t>(sum);
  return (a < 0) != (b_q48 < 0) ? -size : size;
}

std::int64_t quotient_q48(std::uint64_t a, std::uint64_t b) {
  if (b == 0) return 0;
  std::uint64_t rest = a, quotient = 0;
  for (int digit = 0; digit < 3; ++digit) {  // of 16 bits; the first is 2^16 for a = b
    rest <<= 16;
    quotient = (quotient << 16) + rest / b;
    rest %= b;
  }
  return static_cast<std::int64_t>(quotient);
}

std::uint64_t wide_root(Int128 x) {
  if (x.hi() == 0) return isqrt(x.lo());
  const int shift = std::countl_zero(static_cast<std::uint64_t>(x.hi())) & ~1;
  const Int128 n = x << shift;
  const auto high = static_cast<std::uint64_t>(n.hi());
  // Half of the digits, then the other half by one step of Newton's iteration, which is too large
  // by less than one: e^2 / (2 root) for e < 2^32.
  const std::uint32_t first = isqrt(high) | 1u << 31;            // this bit is set
  const std::uint64_t rest = high - wide_product(first, first);  // at most 2 first
  const std::uint64_t second = (rest << 31 | n.lo() >> 33) / first;
  std::uint64_t root = (std::uint64_t{first} << 32) + (second >> 32 != 0 ? 0xffffffffu : second);
  root >>= shift / 2;
  while (Int128::portable_product(root, root) > x) --root;
  return root;
}

std::int64_t length_of(std::int64_t x, std::int64_t y) {
  if (x == 0) return abs64(y);
  if (y == 0) return abs64(x);
  return static_cast<std::int64_t>(wide_root(Int128::product(x, x) + Int128::product(y, y)));
}

}  // namespace lamplock::program
