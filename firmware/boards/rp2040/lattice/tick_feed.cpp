#include "firmware/boards/rp2040/lattice/tick_feed.hpp"

namespace lamplock::rp2040 {

void TickFeed::begin(std::uint64_t tick, std::uint64_t clock, std::uint32_t low_count,
                     std::uint32_t high_clocks) {
  end_tick_ = tick;
  end_clock_ = clock;
  high_clocks_ = high_clocks;
  words_ = span_count_ = played_spans_ = 0;
  starved_ = false;
  ring_.words.fill(0);
  put(ring_, words_, tick_word(1, low_count));
}

void TickFeed::add(const lamp::TickSpan& span) {
  // A register copy: the compiler must assume that a store into the ring changes the member.
  std::uint32_t words = words_;
  TickRing& ring = ring_;
  make_tick_words(span, high_clocks_,
                  [&ring, &words](std::uint32_t word) { put(ring, words, word); });
  // After the words there are always zeros, where TICK ends.
  const std::uint32_t from = (words_ + cleared_words) % tick_ring_words, made = words - words_;
  const std::uint32_t to_end = tick_ring_words - from, n = made < to_end ? made : to_end;
  __builtin_memset(ring.words.data() + from, 0, n * 4);
  if (n != made) __builtin_memset(ring.words.data(), 0, (made - n) * 4);
  words_ = words;
  spans_[span_count_++ % remembered] = span;
  end_tick_ = span.first_tick + span.ticks;
  end_clock_ = span.first_clock + span.clocks;
}

/// The span that contains a clock, or the oldest one; none from end_clock() on.
const lamp::TickSpan* TickFeed::span_at(std::uint64_t clock) const {
  const std::uint32_t known = span_count_ < remembered ? span_count_ : remembered;
  if (known == 0 || clock >= end_clock_) return nullptr;
  // Differences in 32 bits: the spans are the last milliseconds. For older clocks the oldest one.
  const std::uint64_t ago = end_clock_ - clock;
  const auto wanted = ago > remembered * feed_span_ticks * 2u * clocks_per_tick
                          ? ~0u
                          : static_cast<std::uint32_t>(ago);
  const auto end = static_cast<std::uint32_t>(end_clock_);
  std::uint32_t i = 1;
  const lamp::TickSpan* span = &spans_[(span_count_ - 1) % remembered];
  while (i < known && end - static_cast<std::uint32_t>(span->first_clock) < wanted)
    span = &spans_[(span_count_ - ++i) % remembered];
  return span;
}

std::uint32_t TickFeed::tick_before(std::uint32_t clock) {
  if (span_count_ - played_spans_ > remembered) played_spans_ = span_count_ - remembered;
  for (; played_spans_ != span_count_; ++played_spans_) {
    const lamp::TickSpan& span = spans_[played_spans_ % remembered];
    const std::uint32_t into = clock - static_cast<std::uint32_t>(span.first_clock);
    if (static_cast<std::int32_t>(into - span.clocks) < 0)
      return static_cast<std::uint32_t>(span.first_tick);
  }
  return static_cast<std::uint32_t>(end_tick_);
}

std::uint64_t TickFeed::tick_at(std::uint64_t clock) const {
  const lamp::TickSpan* span = span_at(clock);
  if (span == nullptr) return end_tick_;
  if (clock <= span->first_clock) return span->first_tick;
  // By bisection of the span, since this interrupt does not divide.
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
    // The extra clocks as if the span had its full length: less than half a microsecond too few.
    clock = span.first_clock + n * length.clocks + n * length.longer / feed_span_ticks;
    return true;
  }
  clock = 0;  // long past
  return true;
}

std::uint64_t TickFeed::ticks_begun(std::uint32_t taken, std::uint32_t open) const {
  // The words begin the ticks up to and including end_tick_.
  std::uint64_t begun = end_tick_ + 1 - open;
  for (std::uint32_t i = taken; i != words_; ++i)
    begun -= (ring_.words[i % tick_ring_words] & 0xffff) + 1;
  return begun;
}

}  // namespace lamplock::rp2040
