// Lengths of ticks: the words of TICK, run as by the state machine, give the clocks of the virtual
// board's tick line.
#include "firmware/boards/rp2040/lattice/tick_feed.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "sim/virtual_board/tick_line.hpp"
#include "tests/scale.hpp"

namespace lamplock::rp2040 {
namespace {

constexpr std::uint32_t high = 63;

std::uint32_t lower(std::uint64_t x) { return static_cast<std::uint32_t>(x); }

/// Clocks between TICK's rises.
std::vector<std::uint32_t> lengths_of(std::uint32_t word) {
  const std::uint32_t low = (word >> 16) + pio::tick_low_overhead;
  return std::vector<std::uint32_t>((word & 0xffff) + 1, low + high);
}

lamp::TickSpan random_span(std::mt19937_64& random, std::uint64_t tick, std::uint64_t clock) {
  lamp::TickSpan span{tick, clock, 1 + static_cast<std::uint32_t>(random() % feed_span_ticks), 0};
  span.clocks = span.ticks * 94 + static_cast<std::uint32_t>(random() % (span.ticks * 62 + 1));
  if (random() % 4 == 0) span.clocks = span.ticks * clocks_per_tick;
  return span;
}

TEST(TickWords, EveryTickBeginsAtTheClockOfTheVirtualBoard) {
  std::mt19937_64 random(1);
  std::uint64_t tick = 77, clock = 12345;
  for (int n = 0; n < test::scaled(3000); ++n) {
    const lamp::TickSpan span = random_span(random, tick, clock);
    std::vector<std::uint32_t> lengths;
    make_tick_words(span, high, [&lengths](std::uint32_t word) {
      ASSERT_NE(word >> 16, 0u) << "would not count as a word";
      for (const std::uint32_t length : lengths_of(word)) lengths.push_back(length);
    });
    ASSERT_EQ(lengths.size(), span.ticks);
    std::uint64_t at = clock;
    for (std::uint32_t i = 0; i < span.ticks; ++i) {
      ASSERT_EQ(static_cast<sim::Picoseconds>(at) * sim::ps_per_clock,
                sim::TickLine::time_in(span, tick + i));
      at += lengths[i];
    }
    ASSERT_EQ(at, clock + span.clocks);
    tick += span.ticks;
    clock = at;
  }
}

TEST(TickFeed, NeverGivesATickALengthWhoseStepsAreNotFilled) {
  auto ring = std::make_unique<TickRing>();
  TickFeed feed(*ring);
  feed.begin(1000, 0, 100, high);
  std::uint64_t clock = 0, tick = 1000;
  const auto next_span = [&](std::uint32_t n) {
    const lamp::TickSpan span{tick, clock, n, n * clocks_per_tick};
    tick += n, clock += span.clocks;
    return span;
  };
  feed.feed(0, 1000 + 600, next_span);
  EXPECT_EQ(feed.end_tick(), 1384u);
  EXPECT_FALSE(feed.starved());
  feed.feed(0, 100'000, next_span);
  EXPECT_GE(feed.end_clock(), std::uint64_t{feed_lead_clocks});
  // A hung CPU: everything ends within a millisecond.
  EXPECT_LT(feed.end_clock(), 1000u * clocks_per_us);
  EXPECT_LT(feed.words(), tick_ring_words);
  const std::uint64_t end = feed.end_tick();
  const std::uint32_t words = feed.words();
  feed.feed(lower(feed.end_clock() + 1), 100'000, next_span);
  EXPECT_TRUE(feed.starved());
  // TICK has read past them: later words would count as ticks that never begin.
  EXPECT_EQ(feed.words(), words);
  EXPECT_EQ(feed.end_tick(), end);
  EXPECT_EQ(feed.ticks_begun(feed.words(), 0), end + 1);  // its beginning ends the last one
}

TEST(TickFeed, FindsTicksAndClocksAgain) {
  std::mt19937_64 random(3);
  auto ring = std::make_unique<TickRing>();
  TickFeed feed(*ring);
  sim::TickLine line;
  std::uint64_t tick = 5, clock = 900;
  feed.begin(tick, clock, 10, high);
  for (int n = 0; n < test::scaled(400); ++n) {
    feed.feed(lower(clock), lower(feed.end_tick() + 100'000), [&](std::uint32_t) {
      const lamp::TickSpan span = random_span(random, tick, clock);
      line.push(span);
      tick += span.ticks, clock += span.clocks;
      return span;
    });
    line.drop_before(feed.end_tick() > 600 ? feed.end_tick() - 600 : 0);
    for (int k = 0; k < 5; ++k) {
      const std::uint64_t some = feed.end_tick() - 1 - random() % 16;
      const auto start = static_cast<std::uint64_t>(line.time_of(some) / sim::ps_per_clock);
      ASSERT_EQ(feed.tick_at(start + 1), some);
      std::uint64_t found = 0;
      ASSERT_TRUE(feed.clock_of(some, found));
      ASSERT_LE(found, start);
      ASSERT_LE(start - found, 64u);
    }
    std::uint64_t none = 0;
    ASSERT_FALSE(feed.clock_of(feed.end_tick(), none));
  }
}

TEST(TickFeed, FollowsTheTicksThatHaveBegun) {
  // Over the wrap of the lower halves, with a poll now and then.
  std::mt19937_64 random(5);
  auto ring = std::make_unique<TickRing>();
  TickFeed feed(*ring);
  std::uint64_t tick = ~std::uint32_t{0} - 20'000ull, clock = 3 * (1ull << 32) - 1'000'000;
  feed.begin(tick, clock, 10, high);
  const auto next_span = [&](std::uint32_t) {
    const lamp::TickSpan span = random_span(random, tick, clock);
    tick += span.ticks, clock += span.clocks;
    return span;
  };
  feed.feed(lower(clock), lower(tick + 100'000), next_span);
  std::uint64_t now = clock - 200'000;
  EXPECT_EQ(feed.tick_before(lower(now)), ~std::uint32_t{0} - 20'000);
  now = clock - feed_lead_clocks;
  for (int n = 0; n < test::scaled(4000); ++n) {
    feed.feed(lower(now), lower(feed.end_tick() + 100'000), next_span,
              1 + static_cast<std::uint32_t>(n) % 3);
    const std::uint64_t at = feed.tick_at(now);
    const std::uint32_t lag = lower(at) - feed.tick_before(lower(now));
    ASSERT_LT(lag, feed_span_ticks);
    now += random() % 12'000;
    if (now + read_ahead_clocks > feed.end_clock()) now = feed.end_clock() - read_ahead_clocks;
  }
  EXPECT_GT(feed.end_clock(), 3 * (1ull << 32));
  EXPECT_FALSE(feed.starved());
}

TEST(TickFeed, CountsTheTicksBegunFromTheWordsTaken) {
  std::mt19937_64 random(4);
  auto ring = std::make_unique<TickRing>();
  TickFeed feed(*ring);
  std::uint64_t tick = 1, clock = 0;
  feed.begin(tick, clock, 10, high);
  feed.feed(lower(clock), 1u << 30, [&](std::uint32_t) {
    const lamp::TickSpan span = random_span(random, tick, clock);
    tick += span.ticks, clock += span.clocks;
    return span;
  });
  // Ticks 0 .. begun - 1 have begun; the first word begins tick 1.
  std::uint64_t begun = 1;
  for (std::uint32_t taken = 0; taken <= feed.words(); ++taken) {
    ASSERT_EQ(feed.ticks_begun(taken, 0), begun);
    if (taken == feed.words()) break;
    const std::uint32_t ticks = (ring->words[taken] & 0xffff) + 1;
    ASSERT_EQ(feed.ticks_begun(taken + 1, ticks), begun);
    begun += ticks;
  }
  EXPECT_EQ(begun, feed.end_tick() + 1);
}

}  // namespace
}  // namespace lamplock::rp2040
