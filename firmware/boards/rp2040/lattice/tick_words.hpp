// Converts spans of ticks to words for TICK.
//
// In:  spans of the beat clock.
// Out: words (ticks - 1 | low time << 16); tick i of a span begins at first_clock +
//      floor(i * clocks / ticks), exactly the clock that the virtual board calculates.
// Who: TickFeed (beat interrupt, priority 1). Cost: some 15 cycles a word, no division; one word
//      for 16 ticks where all are equal, as many as ticks at worst.
//
// TICK spends the low time before the rise that begins a tick: a word contains the length of the
// ticks before its rises. So the words of span [a, b) begin ticks a+1 .. b.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/pio/programs.hpp"
#include "firmware/lamp/beat_clock.hpp"

namespace lamplock::rp2040 {

constexpr std::uint32_t tick_word(std::uint32_t ticks, std::uint32_t low_count) {
  return (ticks - 1) | low_count << 16;
}

/// Quotient and rest of the clocks in a span, by counting from the nominal length of a tick: the
/// lattice is slewed by a quarter at most.
struct TickLength {
  std::uint32_t clocks = clocks_per_tick;
  std::uint32_t longer = 0;  ///< number of ticks of the span that are one clock longer

  explicit constexpr TickLength(const lamp::TickSpan& span) {
    auto rest = static_cast<std::int32_t>(span.clocks - span.ticks * clocks_per_tick);
    const auto n = static_cast<std::int32_t>(span.ticks);
    for (; rest < 0; rest += n) --clocks;
    for (; rest >= n; rest -= n) ++clocks;
    longer = static_cast<std::uint32_t>(rest);
  }
};

/// Longest span that is converted to words.
inline constexpr std::uint32_t max_span_ticks = 128;

/// DMA and the FIFO of TICK read six words ahead, whether or not they are written. The feed is at
/// least 200 us ahead, so words of at most 16 ticks (20 us at the largest slew) always are.
inline constexpr std::uint32_t max_word_ticks = 16;

/// ceil(2^15 / m): n * reciprocal / 2^15, rounded down, is n / m for n up to max_span_ticks.
inline constexpr std::array<std::uint16_t, max_span_ticks / 2 + 1> reciprocals = [] {
  std::array<std::uint16_t, max_span_ticks / 2 + 1> table{};
  for (std::uint32_t m = 1; m < table.size(); ++m)
    table[m] = static_cast<std::uint16_t>(((1u << 15) + m - 1) / m);
  return table;
}();

/// Passes the words of a span to `sink(word)`; `high_clocks` is the high time of the tick line.
/// Tick i is a long one if (i + 1) * longer / ticks, rounded down, is more than i * longer / ticks.
/// So the rarer kind is single between runs of the other: each n / m ticks, rounded up or down.
template <class Sink>
constexpr void make_tick_words(const lamp::TickSpan& span, std::uint32_t high_clocks, Sink&& sink) {
  const TickLength length(span);
  const std::uint32_t fixed = high_clocks + pio::tick_low_overhead;
  // A low time of zero would mean no word; no lamp needs so short a tick.
  const std::uint32_t low = length.clocks > fixed ? length.clocks - fixed : 1;
  const std::uint32_t n = span.ticks;
  const auto put_run = [&sink](std::uint32_t ticks, std::uint32_t low_count) {
    for (; ticks > max_word_ticks; ticks -= max_word_ticks)
      sink(tick_word(max_word_ticks, low_count));
    sink(tick_word(ticks, low_count));
  };
  if (length.longer == 0) {
    put_run(n, low);
    return;
  }
  const bool long_is_rare = 2 * length.longer <= n;
  const std::uint32_t m = long_is_rare ? length.longer : n - length.longer;
  const std::uint32_t run = n * reciprocals[m] >> 15, rest = n - run * m;
  const std::uint32_t rare = tick_word(1, low + (long_is_rare ? 1 : 0));
  const std::uint32_t common_low = low + (long_is_rare ? 0 : 1);
  // A long tick ends its run, a short one begins it: rounded up and down. If there are many runs
  // each is one word, made by a shorter loop.
  std::uint32_t sum = 0;
  if (run <= max_word_ticks) {
    const std::uint32_t shorter = tick_word(run - 1, common_low);
    for (std::uint32_t i = m; long_is_rare && i != 0; --i) {
      std::uint32_t word = shorter;
      if (rest > sum) sum += m, ++word;
      sum -= rest;
      sink(word);
      sink(rare);
    }
    for (std::uint32_t i = m; !long_is_rare && i != 0; --i) {
      std::uint32_t word = shorter;
      sum += rest;
      if (sum >= m) sum -= m, ++word;
      sink(rare);
      sink(word);
    }
    return;
  }
  for (std::uint32_t i = 0; i < m; ++i) {
    const bool one_more = long_is_rare ? rest > sum : sum + rest >= m;
    if (long_is_rare)
      sum += (one_more ? m : 0) - rest;
    else
      sum += rest - (one_more ? m : 0);
    if (!long_is_rare) sink(rare);
    put_run(one_more ? run : run - 1, common_low);
    if (long_is_rare) sink(rare);
  }
}

}  // namespace lamplock::rp2040
