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

void StepExpander::begin(std::uint64_t first, std::uint64_t filled, const StepPosition& steps) {
  end_ = first;
  rows_ = {};
  bits_ = {};
  power_.counts.fill(0);
  power_place_ = power_ahead_cells * stepper::power_cell_ticks;
  steps_ = steps;
  if (filled <= first) return;
  const auto ticks = static_cast<std::uint32_t>(filled - first);
  for (int a = 0; a < max_axes; ++a) put_still(a, ticks);
  put_bits(0, ticks);
  put_power(0, ticks);
  end_runs(ticks);
}

void StepExpander::put_axis(int axis, const stepper::AxisRun& run, std::uint32_t ticks) {
  auto& ring = rings_.steps[index(axis)];
  Row& row = rows_[index(axis)];
  StepPhase phase(run);
  const std::uint32_t dir = row.dir = StepPhase::backwards(run) ? all_dir_bits : 0;
  std::uint32_t at = row.place / ticks_per_step_word;
  if (const std::uint32_t begun = row.place % ticks_per_step_word; begun != 0) {
    const std::uint32_t left = ticks_per_step_word - begun, n = ticks < left ? ticks : left;
    row.partial = expand_some(phase, row.partial, n, dir);
    row.place += n;
    ticks -= n;
    if (n == left) ring[at++ % step_ring_words] = row.partial;
  }
  row.place = (row.place + ticks) & place_mask;
  const bool rare = phase.steps_rarely(ticks);
  for (std::uint32_t words = ticks / ticks_per_step_word; words != 0;) {
    at %= step_ring_words;
    const std::uint32_t n = words < step_ring_words - at ? words : step_ring_words - at;
    if (rare)
      expand_rare_words(phase, ring.data() + at, ring.data() + at + n, dir);
    else
      expand_words(phase, ring.data() + at, ring.data() + at + n, dir);
    words -= n;
    at += n;
  }
  ticks %= ticks_per_step_word;
  if (ticks != 0) row.partial = expand_some(phase, row.partial, ticks, dir);
}

void StepExpander::put_still(int axis, std::uint32_t ticks) {
  Row& row = rows_[index(axis)];
  put_alike<ticks_per_step_word>(rings_.steps[index(axis)], row.partial, row.dir, row.place, ticks);
  row.place = (row.place + ticks) & place_mask;
}

void StepExpander::put_bits(std::uint8_t bits, std::uint32_t ticks) {
  put_alike<ticks_per_bits_word>(rings_.bits, bits_.partial, lattice_nibble(bits) * 0x11111111u,
                                 bits_.place, ticks);
  bits_.place = (bits_.place + ticks) & place_mask;
}

void StepExpander::put_power(std::uint16_t power, std::uint32_t ticks) {
  constexpr std::uint32_t cell = stepper::power_cell_ticks;
  const std::uint16_t counts = laser_duty(power);
  std::uint32_t at = power_place_;
  const std::uint32_t end = at + ticks;
  if (const std::uint32_t begun = at % cell; begun != 0) {
    // Darkness leaves a cell what shines in it before, and so does what comes behind the middle.
    std::uint16_t& count = power_.counts[at / cell % power_ring_cells];
    if (power != 0 && (begun <= cell / 2 || count == 0)) count = counts;
    at += cell - begun;
  }
  for (; static_cast<std::int32_t>(end - at) > 0; at += cell)
    power_.counts[at / cell % power_ring_cells] = counts;
  power_place_ = end;
}

std::uint32_t StepExpander::word_of(int axis, std::uint32_t place) const {
  const Row& row = rows_[index(axis)];
  const std::uint32_t begun = row.place % ticks_per_step_word;
  if (begun != 0 && place / ticks_per_step_word == row.place / ticks_per_step_word)
    return row.partial << 2 * (ticks_per_step_word - begun);
  return rings_.steps[index(axis)][place / ticks_per_step_word];
}

StepPosition StepExpander::steps_at(std::uint64_t tick) const {
  // From the end back: what is still in the rings was not put out.
  StepPosition steps{};
  const auto open = static_cast<std::uint32_t>(end_ > tick ? end_ - tick : 0);
  for (int a = 0; a < max_axes; ++a) {
    std::int64_t step = steps_[index(a)];
    for (std::uint32_t left = open; left != 0;) {
      const std::uint32_t place = (rows_[index(a)].place - left) & place_mask;
      const std::uint32_t skip = place % ticks_per_step_word;
      const std::uint32_t n = left < ticks_per_step_word - skip ? left : ticks_per_step_word - skip;
      // DIR belongs to the tick: a word may hold both directions.
      const std::uint32_t word = word_of(a, place) << 2 * skip;
      const std::uint32_t used = ~0u << 2 * (ticks_per_step_word - n);
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
