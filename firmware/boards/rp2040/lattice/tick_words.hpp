// From spans of ticks to words for TICK.
//
// In:  TickSpans of the beat clock.
// Out: words (ticks - 1 | low time << 16); tick i of a span begins at first_clock +
//      floor(i * clocks / ticks), the very clock that the virtual board works out.
// Who: TickFeed (beat interrupt, priority 1). Cost: some 8 cycles a tick, no division.
//
// TICK spends the low time before the rise that begins a tick: a word tells how long the ticks
// before its rises were. So the words of span [a, b) begin ticks a+1 .. b.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/pio/programs.hpp"
#include "firmware/lamp/beat_clock.hpp"

namespace lamplock::rp2040 {

/// Longest low time that fits a word.
inline constexpr std::uint32_t most_low_count = 0xffff;

constexpr std::uint32_t tick_word(std::uint32_t ticks, std::uint32_t low_count) {
  return (ticks - 1) | low_count << 16;
}

/// Quotient and rest of the clocks in a span, by stepping from the nominal length of a tick: the
/// lattice is slewed by a quarter at most.
struct TickLength {
  std::uint32_t clocks = clocks_per_tick;
  std::uint32_t longer = 0;  ///< of the span's ticks are one clock longer

  explicit constexpr TickLength(const lamp::TickSpan& span) {
    auto rest = static_cast<std::int32_t>(span.clocks - span.ticks * clocks_per_tick);
    const auto n = static_cast<std::int32_t>(span.ticks);
    for (; rest < 0; rest += n) --clocks;
    for (; rest >= n; rest -= n) ++clocks;
    longer = static_cast<std::uint32_t>(rest);
  }
};

/// Gives the words of a span to `sink(word)`; `high_clocks` is the high time of the tick line.
template <class Sink>
constexpr void make_tick_words(const lamp::TickSpan& span, std::uint32_t high_clocks, Sink&& sink) {
  const TickLength length(span);
  const std::uint32_t fixed = high_clocks + pio::tick_low_overhead;
  // A low time of zero would read as no word: such a tick is one that no lamp asks for.
  const std::uint32_t low = length.clocks > fixed ? length.clocks - fixed : 1;
  std::uint32_t sum = 0, run = 0;
  bool run_long = false;
  for (std::uint32_t i = 0; i < span.ticks; ++i) {
    sum += length.longer;
    const bool is_long = sum >= span.ticks;
    if (is_long) sum -= span.ticks;
    if (is_long != run_long && run != 0) {
      sink(tick_word(run, low + (run_long ? 1 : 0)));
      run = 0;
    }
    run_long = is_long;
    ++run;
  }
  if (run != 0) sink(tick_word(run, low + (run_long ? 1 : 0)));
}

}  // namespace lamplock::rp2040
