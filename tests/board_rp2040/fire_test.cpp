// Tokens and stamps: whether the token is loaded, and which edge a result belongs to.
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "firmware/boards/rp2040/fire/token_keeper.hpp"
#include "firmware/boards/rp2040/lattice/stamp_reader.hpp"
#include "shared/units.hpp"
#include "tests/scale.hpp"

namespace lamplock::rp2040 {
namespace {

using Action = TokenKeeper::Action;

TEST(TokenKeeper, IsLoadedOnlyInItsTimeAndOnlyIfPermitted) {
  TokenKeeper keeper;
  EXPECT_EQ(keeper.next(0, false), Action::nothing);
  EXPECT_EQ(keeper.next(0, true), Action::take);
  keeper.taken({.beat = 1, .not_before_tick = 100, .expires_tick = 150});
  EXPECT_EQ(keeper.next(99, true), Action::nothing);
  EXPECT_EQ(keeper.next(100, true), Action::load);
  EXPECT_EQ(keeper.next(100, false), Action::drop);
  EXPECT_EQ(keeper.next(150, true), Action::drop);
  keeper.loaded();
  EXPECT_EQ(keeper.next(149, true), Action::nothing);
  EXPECT_EQ(keeper.next(149, false), Action::withdraw);
  EXPECT_EQ(keeper.next(150, true), Action::withdraw);
  // An edge came before the withdrawal.
  EXPECT_TRUE(keeper.result(true));
  EXPECT_FALSE(keeper.is_out());
}

TEST(TokenKeeper, AnEdgeWithoutATokenSpendsNone) {
  TokenKeeper keeper;
  keeper.taken({.beat = 1, .not_before_tick = 100, .expires_tick = 150});
  EXPECT_FALSE(keeper.result(false));
  EXPECT_TRUE(keeper.is_out());
  keeper.loaded();
  EXPECT_FALSE(keeper.result(false));
  EXPECT_TRUE(keeper.is_loaded());
}

/// STAMP, clock by clock and path by path as in its program.
class StampMachine {
 public:
  StampMachine(std::uint64_t start, StampRing& ring) : clock_(start), ring_(ring) {}
  /// Pulses [rise, fall) on the pad, in order.
  void run(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& pulses,
           std::uint64_t until) {
    std::size_t next = 0;
    const auto level = [&](std::uint64_t at) {
      while (next < pulses.size() && pulses[next].second <= at) ++next;
      return next < pulses.size() && pulses[next].first <= at;
    };
    while (clock_ < until) {
      const bool now = level(clock_ - pio::synchroniser_clocks);
      if (now == high_) {
        clock_ += 2, x_ -= 1;
        continue;
      }
      ring_.words[count_++ % stamp_ring_words] = x_;
      clock_ += now ? 4 : 6;
      x_ -= now ? 1 : 4;
      high_ = now;
    }
  }
  std::uint32_t count() const { return count_ % stamp_ring_words; }

 private:
  std::uint64_t clock_;
  StampRing& ring_;
  std::uint32_t x_ = ~0u;
  bool high_ = false;
  std::uint32_t count_ = 0;
};

TEST(StampReader, FindsTheAcceptedEdgeBetweenRuntsWithinAClock) {
  std::mt19937_64 random(11);
  auto ring = std::make_unique<StampRing>();
  const std::uint64_t start = 123'456;
  StampReader reader(*ring);
  reader.begin(start);
  StampMachine machine(start, *ring);
  std::uint64_t at = start + 1000;
  for (int n = 0; n < test::scaled(500); ++n) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> pulses;
    const auto runts = random() % 4;
    for (std::uint64_t i = 0; i < runts; ++i) {
      const std::uint64_t width = 10 + random() % 230;
      pulses.emplace_back(at, at + width);
      at += width + 40 + random() % 5000;
    }
    const std::uint64_t edge = at;
    const std::uint64_t width = 260 + random() % 2000;
    pulses.emplace_back(edge, edge + width);
    at += width + 20;
    // The result is read up to 20 us after the decision; more runts meanwhile.
    const std::uint64_t read = edge + pio::fire_decision_clock + random() % 2500;
    std::uint64_t late = at + 20;
    while (late + 200 < read) {
      pulses.emplace_back(late, late + 50 + random() % 100);
      late += 400;
    }
    machine.run(pulses, read);
    std::uint64_t found = 0;
    const std::uint64_t now = read - random() % clocks_per_us;
    ASSERT_TRUE(
        reader.find(machine.count(), now + clocks_per_us - pio::fire_decision_clock, now, found));
    ASSERT_GE(found, edge);
    ASSERT_LE(found, edge + 1);
    reader.used(found);
    machine.run(pulses, std::max(late, at) + 1000);
    at = std::max(late, at) + 1000 + random() % 100'000;
  }
}

TEST(StampReader, ContinuesWhenItsCounterWraps) {
  auto ring = std::make_unique<StampRing>();
  StampReader reader(*ring);
  reader.begin(0);
  // Slightly more than 2^33 clocks: the counter has wrapped once.
  const std::uint64_t edge = (std::uint64_t{1} << 33) + 1000 + pio::synchroniser_clocks % 2;
  ring->words[0] = ~static_cast<std::uint32_t>((edge + pio::synchroniser_clocks) / 2);
  std::uint64_t found = 0;
  ASSERT_TRUE(reader.find(1, edge + 50, edge + 300, found));
  EXPECT_EQ(found, edge);
  EXPECT_FALSE(reader.find(1, edge - 50, edge + 300, found));
  reader.used(edge);
  EXPECT_FALSE(reader.find(1, edge + 50, edge + 300, found));
}

}  // namespace
}  // namespace lamplock::rp2040
