#include "firmware/boards/rp2040/lattice/step_expander.hpp"

#include <algorithm>
#include <bit>

namespace lamplock::rp2040 {
namespace {

constexpr std::uint32_t place_mask = ring_ticks - 1;

/// Puts `ticks` ticks that are all alike at `place` into a ring of words: its last, unfinished word
/// is `partial`, `pattern` a word full of such ticks.
template <std::uint32_t ticks_per_word, std::size_t ring_words>
void put_alike(std::array<std::uint32_t, ring_words>& ring, std::uint32_t& partial,
               std::uint32_t pattern, std::uint32_t place, std::uint32_t ticks) {
  constexpr std::uint32_t bits = 32 / ticks_per_word, words = ring_words;
  const auto shifted = [pattern](std::uint32_t word, std::uint32_t n) {  // n below a word
    return word << bits * n | (pattern & ((1u << bits * n) - 1));
  };
  std::uint32_t at = place / ticks_per_word;
  if (const std::uint32_t begun = place % ticks_per_word; begun != 0) {
    const std::uint32_t left = ticks_per_word - begun;
    const std::uint32_t n = ticks < left ? ticks : left;
    partial = shifted(partial, n);
    ticks -= n;
    if (n == left) ring[at++ % words] = partial;
  }
  for (std::uint32_t whole = ticks / ticks_per_word; whole != 0;) {
    at %= words;
    const std::uint32_t n = whole < words - at ? whole : words - at;
    std::fill_n(ring.data() + at, n, pattern);
    whole -= n;
    at += n;
  }
  if (ticks % ticks_per_word != 0) partial = shifted(partial, ticks % ticks_per_word);
}

}  // namespace

void StepExpander::begin(std::uint64_t first, std::uint64_t first_block,
                         const StepPosition& steps) {
  base_ = end_ = first;
  place_ = 0;
  partial_ = {};
  partial_bits_ = 0;
  dir_ = {};
  last_ = stepper::TickBlock{};
  last_.first_tick = first;
  for (int a = 0; a < max_axes; ++a)
    last_.axis[index(a)].position_q64 = stepper::middle_of_step(steps[index(a)]);
  if (first_block <= first) return;
  stepper::TickBlock still = last_;
  still.ticks = static_cast<std::uint32_t>(first_block - first);
  put(still);
}

void StepExpander::put(const stepper::TickBlock& block) {
  stepper::BitRuns runs;
  runs.run[0] = {block.ticks, block.bits};
  runs.count = 1;
  put(block, runs);
}

void StepExpander::put(const stepper::TickBlock& block, const stepper::BitRuns& runs) {
  const std::uint64_t block_end = block.first_tick + block.ticks;
  if (block_end <= end_) return;
  const auto ticks = static_cast<std::uint32_t>(block_end - end_);
  for (int a = 0; a < max_axes; ++a) {
    const stepper::AxisRun& run = block.axis[index(a)];
    if (run.rate_q62 == 0 && run.accel_q62 == 0)
      put_still(a, ticks);
    else
      put_axis(a, run, ticks);
  }
  put_bits(runs, block.ticks - ticks);
  place_ = (place_ + ticks) & place_mask;
  end_ = block_end;
  last_ = block;
}

void StepExpander::put_axis(int axis, const stepper::AxisRun& run, std::uint32_t ticks) {
  auto& ring = rings_.steps[index(axis)];
  std::uint32_t& partial = partial_[index(axis)];
  StepPhase phase(run);
  const std::uint32_t dir = StepPhase::backwards(run) ? all_dir_bits : 0;
  dir_[index(axis)] = dir;
  const auto one_tick = [&phase, &partial, dir] {
    partial = partial << 2 | (dir & 2) | (phase.tick() ? 1u : 0u);
  };
  std::uint32_t place = place_;
  for (; place % ticks_per_step_word != 0 && ticks != 0; ++place, --ticks) {
    one_tick();
    if ((place + 1) % ticks_per_step_word == 0) ring[place / ticks_per_step_word] = partial;
  }
  std::uint32_t words = ticks / ticks_per_step_word;
  ticks %= ticks_per_step_word;
  std::uint32_t at = (place & place_mask) / ticks_per_step_word;
  while (words != 0) {
    const std::uint32_t run_length = words < step_ring_words - at ? words : step_ring_words - at;
    expand_words(phase, ring.data() + at, ring.data() + at + run_length, dir);
    words -= run_length;
    at = (at + run_length) % step_ring_words;
  }
  for (; ticks != 0; --ticks) one_tick();
}

void StepExpander::put_still(int axis, std::uint32_t ticks) {
  put_alike<ticks_per_step_word>(rings_.steps[index(axis)], partial_[index(axis)],
                                 dir_[index(axis)], place_, ticks);
}

/// `skip`: ticks at the beginning that have been put already.
void StepExpander::put_bits(const stepper::BitRuns& runs, std::uint32_t skip) {
  std::uint32_t place = place_;
  for (std::uint32_t i = 0; i < runs.count; ++i) {
    std::uint32_t ticks = runs.run[i].ticks;
    const std::uint32_t skipped = skip < ticks ? skip : ticks;
    skip -= skipped;
    ticks -= skipped;
    put_alike<ticks_per_bits_word>(rings_.bits, partial_bits_,
                                   lattice_nibble(runs.run[i].bits) * 0x11111111u, place, ticks);
    place += ticks;
  }
}

std::uint32_t StepExpander::word_of(int axis, std::uint32_t place) const {
  const std::uint32_t begun = place_ % ticks_per_step_word;
  if (begun != 0 && place / ticks_per_step_word == place_ / ticks_per_step_word)
    return partial_[index(axis)] << 2 * (ticks_per_step_word - begun);
  return rings_.steps[index(axis)][place / ticks_per_step_word];
}

StepPosition StepExpander::steps_at(std::uint64_t tick) const {
  // From the end of the last block back: what is still in the rings was not put out.
  StepPosition steps{};
  const auto after_last = static_cast<std::uint32_t>(end_ - last_.first_tick);
  const auto open = static_cast<std::uint32_t>(end_ > tick ? end_ - tick : 0);
  for (int a = 0; a < max_axes; ++a) {
    std::int64_t step = last_.axis[index(a)].position_after(after_last).hi();
    for (std::uint32_t left = open; left != 0;) {
      const std::uint32_t place = (place_ - left) & place_mask;
      const std::uint32_t skip = place % ticks_per_step_word;
      const std::uint32_t n = left < ticks_per_step_word - skip ? left : ticks_per_step_word - skip;
      // DIR belongs to the tick: a word may hold both directions.
      const std::uint32_t word = word_of(a, place) << 2 * skip;
      const std::uint32_t used = n == ticks_per_step_word ? ~0u : ~(~0u >> 2 * n);
      const std::uint32_t stepping = word & used & all_step_bits;
      const std::uint32_t back = stepping & (word >> 1);
      step -= std::popcount(stepping) - 2 * std::popcount(back);
      left -= n;
    }
    steps[index(a)] = static_cast<std::int32_t>(step);
  }
  return steps;
}

}  // namespace lamplock::rp2040
