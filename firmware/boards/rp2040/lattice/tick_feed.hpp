// The tick feed: hands out the lengths of ticks, 0.8 ms ahead, and converts between ticks and
// clocks.
//
// In:  spans of the core (Controller::next_span), the present clock.
// Out: words in the ring of TICK; clock of a tick, tick at a clock.
// Who: beat interrupt (priority 1) every 100 us; begin() with it masked. Budget: 20 us a span in
//      the worst case (128 ticks of alternating length), 3 us at the usual one.
//
// The words are credits: only they move the machine. The feed never gives a length to a tick whose
// steps are not in the rings beyond the prefetch of the state machines; if the fill is late, motion
// stops with STEP low, and starved() returns true afterwards. TICK does not continue by itself
// then: begin() must follow.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/lattice/lattice_rings.hpp"
#include "firmware/boards/rp2040/lattice/tick_words.hpp"

namespace lamplock::rp2040 {

/// The beat interrupt may be masked for nearly this long; with the present span less than a
/// millisecond, after which a hung CPU moves nothing.
inline constexpr std::uint32_t feed_lead_clocks = 800 * clocks_per_us;
inline constexpr std::uint32_t feed_span_ticks = max_span_ticks;
/// One word a tick at worst, and never more than this number of ticks ahead.
inline constexpr std::uint32_t tick_ring_words = 2048;
inline constexpr unsigned tick_ring_bits = 13;
static_assert(tick_ring_words * 4 == 1u << tick_ring_bits);
/// Read-ahead of DMA and FIFO at the largest slew: words that are missing by then are read as the
/// end.
inline constexpr std::uint32_t read_ahead_clocks = 7 * max_word_ticks * clocks_per_tick * 5 / 4;
/// Ticks filled beyond those that have a length: the read-ahead of the state machines, and a word
/// more because filled means begun.
inline constexpr std::uint32_t min_fill_lead_ticks = prefetch_ticks + ticks_per_step_word;

struct alignas(1u << tick_ring_bits) TickRing {
  std::array<std::uint32_t, tick_ring_words> words{};
};

class TickFeed {
 public:
  explicit TickFeed(TickRing& ring) : ring_(ring) {}

  /// Starts again: tick `tick` begins at `clock`; the first word makes its rise after `low_count`.
  [[gnu::cold]] void begin(std::uint64_t tick, std::uint64_t clock, std::uint32_t low_count,
                           std::uint32_t high_clocks);

  /// Takes spans until `now` + lead is reached or the rings are not filled further.
  /// `next_span(max_ticks)` is the core's. False if `max_spans` were not enough. Lower halves of a
  /// clock and a tick: both are near those of this feed.
  template <class NextSpan>
  bool feed(std::uint32_t now, std::uint32_t filled_end, NextSpan&& next_span,
            std::uint32_t max_spans = ~0u) {
    if (span_count_ != 0 && lead(now) < static_cast<std::int32_t>(read_ahead_clocks))
      starved_ = true;
    // Words after an end that TICK has read would count as ticks that never begin.
    if (starved_) return true;
    while (lead(now) < static_cast<std::int32_t>(feed_lead_clocks) &&
           static_cast<std::int32_t>(filled_end - static_cast<std::uint32_t>(end_tick_)) >=
               static_cast<std::int32_t>(feed_span_ticks + min_fill_lead_ticks)) {
      if (max_spans-- == 0) return false;
      add(next_span(feed_span_ticks));
    }
    return true;
  }

  std::uint64_t end_tick() const { return end_tick_; }    ///< first tick without a length
  std::uint64_t end_clock() const { return end_clock_; }  ///< when that tick begins
  /// The ticks have run out at least once: time base and lattice no longer agree.
  bool starved() const { return starved_; }
  /// Last tick that has begun at `clock`, within one tick; one of the last 16 spans.
  std::uint64_t tick_at(std::uint64_t clock) const;
  /// At most tick_at(), at most a span earlier, and faster; the clock must not decrease. Lower
  /// halves.
  std::uint32_t tick_before(std::uint32_t clock);
  /// When a tick begins, within 0.5 us; false if it has no length yet.
  bool clock_of(std::uint64_t tick, std::uint64_t& clock) const;
  /// Words made since begin().
  std::uint32_t words() const { return words_; }
  /// Ticks begun, if TICK has read `taken` words and `open` ticks of the last one have not begun.
  std::uint64_t ticks_begun(std::uint32_t taken, std::uint32_t open) const;

 private:
  static constexpr std::uint32_t remembered = 16;
  /// More than the read-ahead of DMA and FIFO; the rest of the ring holds the longest lead, word by
  /// tick.
  static constexpr std::uint32_t cleared_words = 256;
  static constexpr std::uint32_t max_lead_ticks =
      feed_lead_clocks / (clocks_per_tick * 3 / 4) + feed_span_ticks;
  static_assert(cleared_words + max_lead_ticks < tick_ring_words);

  std::int32_t lead(std::uint32_t now) const {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(end_clock_) - now);
  }
  void add(const lamp::TickSpan& span);
  const lamp::TickSpan* span_at(std::uint64_t clock) const;
  static void put(TickRing& ring, std::uint32_t& words, std::uint32_t word) {
    ring.words[words++ % tick_ring_words] = word;
  }

  TickRing& ring_;
  std::array<lamp::TickSpan, remembered> spans_{};
  std::uint32_t span_count_ = 0;
  std::uint32_t played_spans_ = 0;  ///< spans that have ended, as seen by tick_before()
  std::uint32_t words_ = 0;
  std::uint32_t high_clocks_ = 0;
  std::uint64_t end_tick_ = 0, end_clock_ = 0;
  bool starved_ = false;
};

}  // namespace lamplock::rp2040
