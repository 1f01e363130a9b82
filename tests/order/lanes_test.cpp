#include "host/order/lanes.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>

#include "tests/scale.hpp"

namespace lamplock {
namespace {

using order::Lanes;
using order::PlainLanes;

using Four = std::array<float, 4>;

/// Numbers of all sizes and both signs, zeros, and equal ones now and then.
Four random_four(std::mt19937_64& random) {
  std::uniform_real_distribution<float> mantissa(-1, 1);
  Four four{};
  for (float& one : four) {
    const int exponent = static_cast<int>(random() % 60) - 30;
    one = random() % 8 == 0 ? static_cast<float>(random() % 3) - 1
                            : std::ldexp(mantissa(random), exponent);
  }
  return four;
}

template <class Any>
Any lanes_of(const Four& four) {
  return Any(four[0], four[1], four[2], four[3]);
}

template <class Any>
Four four_of(const Any& lanes) {
  return {lanes[0], lanes[1], lanes[2], lanes[3]};
}

/// Equal bits, so that -0 and 0 differ.
void expect_same(const Lanes& lanes, const PlainLanes& plain, const char* operation) {
  using Bits = std::array<std::uint32_t, 4>;
  EXPECT_EQ(std::bit_cast<Bits>(four_of(lanes)), std::bit_cast<Bits>(four_of(plain))) << operation;
}

TEST(Lanes, EqualThePlainOnesBitByBit) {
  std::mt19937_64 random(52);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const Four a = random_four(random), b = random() % 4 == 0 ? a : random_four(random);
    const auto p = lanes_of<Lanes>(a), q = lanes_of<Lanes>(b);
    const auto r = lanes_of<PlainLanes>(a), s = lanes_of<PlainLanes>(b);
    expect_same(Lanes(a[0]), PlainLanes(a[0]), "all");
    expect_same(p + q, r + s, "+");
    expect_same(p - q, r - s, "-");
    expect_same(p * q, r * s, "*");
    const Lanes over = abs(q) + Lanes(1e-3f);
    const PlainLanes plain_over = abs(s) + PlainLanes(1e-3f);
    expect_same(p / over, r / plain_over, "/");
    expect_same(min(p, q), min(r, s), "min");
    expect_same(max(p, q), max(r, s), "max");
    expect_same(abs(p), abs(r), "abs");
    expect_same(sqrt(abs(p)), sqrt(abs(r)), "sqrt");
    expect_same(where_less(p, q, p + q, q), where_less(r, s, r + s, s), "where_less");
    EXPECT_EQ(any_less(p, q), any_less(r, s));
    EXPECT_EQ(p == q, r == s);
  }
}

TEST(Lanes, OneAxisDecidesWhetherAnyIsLess) {
  for (std::size_t axis = 0; axis < 4; ++axis) {
    Four lower{1, 1, 1, 1};
    lower[axis] = 0;
    EXPECT_TRUE(any_less(lanes_of<Lanes>(lower), Lanes(1)));
    EXPECT_FALSE(any_less(Lanes(1), lanes_of<Lanes>(lower)));
    EXPECT_FALSE(lanes_of<Lanes>(lower) == Lanes(1));
  }
  EXPECT_FALSE(any_less(Lanes(1), Lanes(1)));
  EXPECT_TRUE(Lanes(1) == Lanes(1));
}

}  // namespace
}  // namespace lamplock
