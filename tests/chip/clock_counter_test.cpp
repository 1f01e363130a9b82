#include "sim/chip/system/clock_counter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/scale.hpp"

namespace lamplock::sim::chip::clock_counter_test {
namespace {

TEST(ClockCounter, SpellsShorterThanACycleAddUp) {
  ClockCounter counter;
  for (int spell = 0; spell < 1000; ++spell) {
    counter.set_frequency(1000, spell * ps_per_s);
    counter.set_frequency(0, spell * ps_per_s + ps_per_ms / 4);
  }
  EXPECT_EQ(counter.cycles(1000 * ps_per_s), 250u);
}

// Equals the sum of all spells exactly; a cycle is counted at its time and not before.
TEST(ClockCounter, CountsWithoutDriftWhateverTheFrequencyDoes) {
  constexpr std::array<std::uint64_t, 5> frequencies{0, 46'875, 6'500'000, 48'000'000, 12'000'001};
  std::mt19937_64 random(1);
  for (int run = 0; run < test::scaled(50); ++run) {
    ClockCounter counter;
    Picoseconds now = static_cast<Picoseconds>(random() % ps_per_s);
    Wide parts = 0;
    std::uint64_t hz = 0;
    for (int change = 0; change < 100; ++change) {
      const auto spell = static_cast<Picoseconds>(random() % (ps_per_us / 4));
      parts += static_cast<Wide>(spell) * static_cast<Wide>(hz);
      now += spell;
      hz = frequencies[random() % frequencies.size()];
      counter.set_frequency(hz, now);
      const auto whole = static_cast<std::uint64_t>(parts / ps_per_s);
      ASSERT_EQ(counter.cycles(now), whole);
      ASSERT_EQ(counter.next_edge(now), whole + (parts % ps_per_s != 0 ? 1u : 0u));
      const std::uint64_t next = whole + 1 + random() % 3;
      const Picoseconds at = counter.time_of(next);
      if (hz == 0) {
        ASSERT_EQ(at, never);
        continue;
      }
      ASSERT_GE(counter.cycles(at), next);
      if (at > now) {
        ASSERT_LT(counter.cycles(at - 1), next);
      }
    }
  }
}

TEST(ClockCounter, UnreachableCyclesNeverCome) {
  ClockCounter counter;
  counter.set_frequency(1, 0);
  EXPECT_EQ(counter.time_of(86'400), 86'400 * ps_per_s);
  EXPECT_EQ(counter.time_of(~std::uint64_t{0}), never);
}

}  // namespace
}  // namespace lamplock::sim::chip::clock_counter_test
