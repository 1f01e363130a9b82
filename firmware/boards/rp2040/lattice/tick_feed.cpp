#include "firmware/boards/rp2040/lattice/tick_feed.hpp"

namespace lamplock::rp2040 {

void TickFeed::begin(std::uint64_t tick, std::uint64_t clock, std::uint32_t low_count,
                     std::uint32_t high_clocks) {
  end_tick_ = tick;
  end_clock_ = clock;
  high_clocks_ = high_clocks;
  words_ = span_count_ = 0;
  starved_ = false;
  put(tick_word(1, low_count));
}

void TickFeed::add(const lamp::TickSpan& span) {
  make_tick_words(span, high_clocks_, [this](std::uint32_t word) { put(word); });
  spans_[span_count_++ % remembered] = span;
  end_tick_ = span.first_tick + span.ticks;
  end_clock_ = span.first_clock + span.clocks;
}

std::uint64_t TickFeed::tick_at(std::uint64_t clock) const {
  const std::uint32_t known = span_count_ < remembered ? span_count_ : remembered;
  if (known == 0 || clock >= end_clock_) return end_tick_;
  const lamp::TickSpan* span = &spans_[(span_count_ - 1) % remembered];
  for (std::uint32_t i = 2; i <= known && clock < span->first_clock; ++i)
    span = &spans_[(span_count_ - i) % remembered];
  if (clock <= span->first_clock) return span->first_tick;
  // Stepwise, for there is no division at this level: halves of the span.
  const auto into = static_cast<std::uint32_t>(clock - span->first_clock);
  std::uint32_t low = 0, high = span->ticks;
  while (high - low > 1) {
    const std::uint32_t middle = (low + high) / 2;
    if (middle * span->clocks <= into * span->ticks)
      low = middle;
    else
      high = middle;
  }
  return span->first_tick + low;
}

bool TickFeed::clock_of(std::uint64_t tick, std::uint64_t& clock) const {
  if (tick >= end_tick_) return false;
  const std::uint32_t known = span_count_ < remembered ? span_count_ : remembered;
  for (std::uint32_t i = 1; i <= known; ++i) {
    const lamp::TickSpan& span = spans_[(span_count_ - i) % remembered];
    if (tick < span.first_tick) continue;
    const TickLength length(span);
    const auto n = static_cast<std::uint32_t>(tick - span.first_tick);
    // The odd clocks as if the span had its full length: less than half a microsecond too few.
    clock = span.first_clock + n * length.clocks + n * length.longer / feed_span_ticks;
    return true;
  }
  clock = 0;  // long past
  return true;
}

std::uint64_t TickFeed::ticks_begun(std::uint32_t taken, std::uint32_t open) const {
  // The words make the ticks up to and including end_tick_ begin.
  std::uint64_t begun = end_tick_ + 1 - open;
  for (std::uint32_t i = taken; i != words_; ++i)
    begun -= (ring_.words[i % tick_ring_words] & 0xffff) + 1;
  return begun;
}

}  // namespace lamplock::rp2040
