// Joins of short lines, compared with the same rule in wide arithmetic.
#include "firmware/motion/line/join.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <vector>

#include "tests/scale.hpp"

namespace lamplock::test::line_join_test {
namespace {

using motion::LineJoin, motion::LineLimits, motion::LinePlace, motion::LineShape, motion::WayParts;
using motion::make_shape, motion::way_between;

__extension__ using Wide = __int128;

using Way = PerAxis<std::int64_t>;

/// A way per axis in steps of the coarsest axis, Q8; empty if it is too long for a join.
std::optional<Way> weighted(const WayParts& way, const LineLimits& limits) {
  if (way.bits != motion::place_bits) return {};
  Way out{};
  for (int a = 0; a < limits.axes; ++a) {
    const std::int64_t part = way.parts[index(a)];
    if (std::abs(part) > 1 << 24) return {};
    const Wide size = Wide{std::abs(part)} * limits.axis[index(a)].weight_q31 >> 31;
    out[index(a)] = static_cast<std::int64_t>(part < 0 ? -size : size);
  }
  return out;
}

/// The places lie in order along the direction of the shape, and each beside it by at most a
/// sixteenth of a step and the last decimal.
bool passes(const std::vector<Way>& places, const Way& to, const LineShape& shape, int digit_um,
            const LineLimits& limits) {
  const auto along = [&](const Way& way) {
    Wide sum = 0;
    for (int a = 0; a < limits.axes; ++a) sum += Wide{way[index(a)]} * shape.cosine_q30[index(a)];
    return sum >> 30;
  };
  Wide before = 0;
  for (const Way& place : places) {
    const Wide here = along(place);
    if (here < before) return false;
    before = here;
    for (int a = 0; a < limits.axes; ++a) {
      const Wide beside = place[index(a)] - (here * shape.cosine_q30[index(a)] >> 30);
      const Wide most =
          (Wide{16} * limits.axis[index(a)].weight_q31 >> 31) + Wide{digit_um} * limits.um_q8;
      if (beside > most || -beside > most) return false;
    }
  }
  return before <= along(to);
}

/// A machine of some axes, the finer ones with up to 64 steps for one of the coarsest.
LineLimits random_limits(std::mt19937_64& random) {
  LineLimits limits;
  limits.axes = 2 + static_cast<int>(random() % 3);
  for (int a = 0; a < limits.axes; ++a)
    limits.axis[index(a)].weight_q31 =
        random() % 2 == 0 ? 1u << 31 : (1u << 25) + static_cast<std::uint32_t>(random() >> 34);
  limits.axis[random() % 2].weight_q31 = 1u << 31;
  limits.um_q8 = static_cast<std::uint32_t>(random() % 120);
  return limits;
}

TEST(LineJoin, PassesThePlacesThatWideArithmeticPasses) {
  std::mt19937_64 random(977);
  int joined = 0, refused = 0, wide = 0;
  for (int round = 0; round < scaled(6000); ++round) {
    const LineLimits limits = random_limits(random);
    const auto digit_um = static_cast<std::uint8_t>(random() % 3 == 0 ? 10 : 1);
    // Lines of 1/4 to 4096 steps, more or less straight.
    const double length = std::exp2(static_cast<double>(random() % 57) / 4 - 2);
    std::uniform_real_distribution<double> any(-1, 1);
    Way direction_q8{};
    for (int a = 0; a < limits.axes; ++a)
      if (random() % 4 != 0)
        direction_q8[index(a)] = static_cast<std::int64_t>(any(random) * length * 256);
    const double off_q8 = 16 + any(random) * digit_um * limits.um_q8;
    LinePlace from;
    for (std::int32_t& step : from.steps) step = static_cast<std::int32_t>(random() % 2001) - 1000;
    const auto place_at = [&](int n) {
      LinePlace place = from;
      for (int a = 0; a < limits.axes; ++a) {
        const std::int64_t to = n * direction_q8[index(a)] + std::lround(off_q8 * any(random));
        place.steps[index(a)] += static_cast<std::int32_t>((to + 128) >> 8);
        place.off_q8[index(a)] = static_cast<std::int8_t>(((to + 128) & 255) - 128);
      }
      return place;
    };
    LineJoin join;
    const WayParts first = way_between(from, place_at(1));
    join.start(from, first, limits);
    std::vector<Way> places;
    if (const auto way = weighted(first, limits)) places.push_back(*way);
    for (int n = 2; n < 22; ++n) {
      const WayParts parts = way_between(from, place_at(n));
      const LineShape shape = make_shape(parts, limits);
      const auto way = weighted(parts, limits);
      const bool expected = way && !places.empty() && places.size() < LineJoin::max_lines &&
                            passes(places, *way, shape, digit_um, limits);
      ASSERT_EQ(join.reaches(parts, shape, digit_um, limits), expected) << round << " " << n;
      if (expected) {
        join.extend();
        places.push_back(*way);
        ++joined;
        for (const std::int64_t part : *way) wide += std::abs(part) >= 1 << 18 ? 1 : 0;
      } else {
        ++refused;
      }
    }
  }
  EXPECT_GT(joined, refused / 20);
  EXPECT_GT(refused, joined / 20);
  EXPECT_GT(wide, joined / 200);
}

}  // namespace
}  // namespace lamplock::test::line_join_test
