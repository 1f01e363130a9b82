// The tick feed: hands out the lengths of ticks, 0.4 ms ahead, and knows which tick is when.
//
// In:  spans of the core (Controller::next_span), the present clock.
// Out: words in the ring of TICK; clock of a tick, tick at a clock.
// Who: beat interrupt (priority 1) every 100 us; begin() with it masked. Budget: 40 us a call in
//      the worst case (128 ticks of alternating length), 10 us at the usual one.
//
// The words are credits: nothing else moves the machine. The feed never gives a tick a length
// whose steps are not in the rings behind the prefetch of the state machines; if the fill is late,
// motion stands still with STEP low, and starved() says so afterwards.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/lattice/lattice_rings.hpp"
#include "firmware/boards/rp2040/lattice/tick_words.hpp"

namespace lamplock::rp2040 {

inline constexpr std::uint32_t feed_lead_clocks = 400 * clocks_per_us;
inline constexpr std::uint32_t feed_span_ticks = 128;
/// One word a tick at worst, and never more than this many ticks ahead.
inline constexpr std::uint32_t tick_ring_words = 1024;
inline constexpr unsigned tick_ring_bits = 12;
static_assert(tick_ring_words * 4 == 1u << tick_ring_bits);
/// Ticks filled beyond those that have a length: what the state machines read ahead, and a word
/// more because filled means begun.
inline constexpr std::uint32_t least_fill_lead_ticks = prefetch_ticks + ticks_per_step_word;

struct alignas(1u << tick_ring_bits) TickRing {
  std::array<std::uint32_t, tick_ring_words> words{};
};

/// Feeds TICK.
class TickFeed {
 public:
  explicit TickFeed(TickRing& ring) : ring_(ring) {}

  /// Starts anew: tick `tick` begins at `clock`; the first word makes its rise after `low_count`.
  void begin(std::uint64_t tick, std::uint64_t clock, std::uint32_t low_count,
             std::uint32_t high_clocks);

  /// Takes spans until `now` + lead is reached or the rings are not filled further.
  /// `next_span(max_ticks)` is the core's.
  template <class NextSpan>
  void feed(std::uint64_t now, std::uint64_t filled_end, NextSpan&& next_span) {
    if (now > end_clock_) starved_ = true;
    while (end_clock_ < now + feed_lead_clocks &&
           end_tick_ + feed_span_ticks + least_fill_lead_ticks <= filled_end)
      add(next_span(feed_span_ticks));
  }

  std::uint64_t end_tick() const { return end_tick_; }    ///< first tick without a length
  std::uint64_t end_clock() const { return end_clock_; }  ///< when it begins
  /// The ticks have run out at least once: time base and lattice do not agree any more.
  bool starved() const { return starved_; }
  /// Last tick that has begun at `clock`, within one tick; one of the last 16 spans.
  std::uint64_t tick_at(std::uint64_t clock) const;
  /// When a tick begins, within 0.5 us; false if it has no length yet.
  bool clock_of(std::uint64_t tick, std::uint64_t& clock) const;
  /// Words made since begin().
  std::uint32_t words() const { return words_; }
  /// Ticks begun, when TICK has taken `taken` words and `open` ticks of the last one have not
  /// begun.
  std::uint64_t ticks_begun(std::uint32_t taken, std::uint32_t open) const;

 private:
  static constexpr std::uint32_t remembered = 16;

  void add(const lamp::TickSpan& span);
  void put(std::uint32_t word) { ring_.words[words_++ % tick_ring_words] = word; }

  TickRing& ring_;
  std::array<lamp::TickSpan, remembered> spans_{};
  std::uint32_t span_count_ = 0;
  std::uint32_t words_ = 0;
  std::uint32_t high_clocks_ = 0;
  std::uint64_t end_tick_ = 0, end_clock_ = 0;
  bool starved_ = false;
};

}  // namespace lamplock::rp2040
