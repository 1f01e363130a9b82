#include "firmware/boards/rp2040/lattice/step_expander.hpp"

#include <algorithm>
#include <bit>

namespace lamplock::rp2040 {
namespace {

constexpr std::uint32_t place_mask = ring_ticks - 1;
constexpr unsigned bits_per_tick = 32 / ticks_per_step_word;

/// Puts equal ticks into a ring of words; `pattern` is a word full of such ticks, and finish(word)
/// converts a complete word for the ring.
template <std::uint32_t ticks_per_word, std::size_t ring_words, class Finish>
void put_alike(std::array<std::uint32_t, ring_words>& ring, std::uint32_t& partial,
               std::uint32_t pattern, std::uint32_t place, std::uint32_t ticks, Finish&& finish) {
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
    if (n == left) ring[at++ % words] = finish(partial);
  }
  std::uint32_t whole = ticks / ticks_per_word;
  if (whole != 0) {  // the first may have the rest of a pulse
    ring[at++ % words] = finish(pattern);
    --whole;
  }
  const std::uint32_t all_alike = whole != 0 ? finish(pattern) : 0;
  while (whole != 0) {
    at %= words;
    const std::uint32_t n = whole < words - at ? whole : words - at;
    std::fill_n(ring.data() + at, n, all_alike);
    whole -= n;
    at += n;
  }
  if (ticks % ticks_per_word != 0) partial = shifted(partial, ticks % ticks_per_word);
}

}  // namespace

void StepExpander::configure(const stepper::PulseOutput& output) {
  for (int a = 0; a < max_axes; ++a) rows_[index(a)].mode = output.axis[index(a)].mode;
  set_times(output);
}

void StepExpander::set_times(const stepper::PulseOutput& output) {
  pulses_ = output.pulses;
  for (Row& row : rows_) {
    row.high_ticks = row.mode == PulseMode::quadrature ? 0 : pulses_.high_ticks;
    row.plain = row.mode == PulseMode::step_dir && row.high_ticks == 0;
    row.guard.set_times(output.times);
  }
}

void StepExpander::begin(std::uint64_t first, std::uint64_t filled, const StepPosition& steps,
                         const PerAxis<std::uint8_t>& levels) {
  end_ = first;
  bits_ = {};
  power_.counts.fill(0);
  power_place_ = power_ahead_cells * stepper::power_cell_ticks;
  dark_ = true;
  steps_ = steps;
  for (int a = 0; a < max_axes; ++a) {
    Row& row = rows_[index(a)];
    row.fill = {};
    row.levels = levels[index(a)];
    row.guard.begin(row.mode == PulseMode::step_dir ? (row.levels & 2) != 0 : row.guard.back());
    if (row.mode != PulseMode::quadrature) row.levels = 0;  // a pulse that is high ends now
    // Counting back finds no steps.
    rings_.steps[index(a)].fill(row.finish(row.dir()));
  }
  if (filled <= first) return;
  const auto ticks = static_cast<std::uint32_t>(filled - first);
  for (int a = 0; a < max_axes; ++a) put_still(a, ticks);
  put_bits(0, ticks);
  put_power(0, ticks);
  end_runs(ticks);
}

// Not inlined: three loops call it.
[[gnu::noinline]] std::uint32_t StepExpander::Row::finish_other(std::uint32_t word) {
  return pulse_word(mode, high_ticks, word, levels);
}

void StepExpander::put_axis(int axis, const stepper::AxisRun& run, std::uint32_t ticks) {
  Row& row = rows_[index(axis)];
  const bool back = run.backwards();
  if (!row.guard.passes(back) || !row.plain) return put_other(axis, run, ticks);
  StepPhase phase(run);
  put_words<true>(axis, phase, back ? all_dir_bits : 0, ticks);
}

/// For an axis that reverses, long pulses, or pins that are not STEP and DIR.
[[gnu::noinline]] void StepExpander::put_other(int axis, const stepper::AxisRun& run,
                                               std::uint32_t ticks) {
  Row& row = rows_[index(axis)];
  StepPhase phase(run);
  const bool back = run.backwards();
  if (!row.guard.passes(back) && !turn_at_once(axis, phase, back, ticks))
    ticks = put_guarded(axis, phase, back, false, ticks);
  put_words<false>(axis, phase, row.dir(), ticks);
}

/// Steps without a guard; `plain`: Row::plain.
template <bool plain>
void StepExpander::put_words(int axis, StepPhase& phase, std::uint32_t dir, std::uint32_t ticks) {
  auto& ring = rings_.steps[index(axis)];
  Row& row = rows_[index(axis)];
  Fill& fill = row.fill;
  std::uint32_t at = fill.place / ticks_per_step_word;
  if (const std::uint32_t begun = fill.place % ticks_per_step_word; begun != 0) {
    const std::uint32_t left = ticks_per_step_word - begun, n = ticks < left ? ticks : left;
    fill.partial = expand_some(phase, fill.partial, n, dir);
    fill.place += n;
    ticks -= n;
    if (n == left) ring[at++ % step_ring_words] = plain ? fill.partial : row.finish(fill.partial);
  }
  fill.place = (fill.place + ticks) & place_mask;
  const bool rare = phase.steps_rarely(ticks);
  for (std::uint32_t words = ticks / ticks_per_step_word; words != 0;) {
    at %= step_ring_words;
    const std::uint32_t n = words < step_ring_words - at ? words : step_ring_words - at;
    std::uint32_t* const out = ring.data() + at;
    if (rare)
      expand_rare_words(phase, out, out + n, dir);
    else
      expand_words(phase, out, out + n, dir);
    if constexpr (!plain)
      for (std::uint32_t i = 0; i < n; ++i) out[i] = row.finish(out[i]);
    words -= n;
    at += n;
  }
  ticks %= ticks_per_step_word;
  if (ticks != 0) fill.partial = expand_some(phase, fill.partial, ticks, dir);
}

/// Usually an axis reverses far from its steps: then the guard need not run in every tick.
bool StepExpander::turn_at_once(int axis, StepPhase phase, bool back, std::uint32_t ticks) {
  stepper::ReversalGuard& guard = rows_[index(axis)].guard;
  const stepper::DirectionTimes& times = guard.times();
  if (!guard.settled() || phase.rate == 0 || ticks < times.setup_ticks) return false;
  // One tick passes in any case: DIR changes with the next one.
  if (times.hold_ticks > 1 && quiet_ticks(axis) + 1 < times.hold_ticks) return false;
  for (std::uint32_t i = times.setup_ticks; i != 0; --i)
    if (phase.tick()) return false;
  guard.turn(back);
  return true;
}

void StepExpander::put_guarded_tick(int axis, std::int32_t wanted) {
  Row& row = rows_[index(axis)];
  const bool step = row.guard.tick(wanted);
  row.fill.partial = row.fill.partial << 2 | (row.guard.back() ? 2u : 0u) | (step ? 1u : 0u);
  const std::uint32_t at = row.fill.place / ticks_per_step_word;
  row.fill.place = (row.fill.place + 1) & place_mask;
  if (row.fill.place % ticks_per_step_word == 0)
    rings_.steps[index(axis)][at] = row.finish(row.fill.partial);
}

/// Runs the guard tick by tick until it lets steps pass; returns the ticks left.
std::uint32_t StepExpander::put_guarded(int axis, StepPhase& phase, bool back,
                                        bool is_standing_still, std::uint32_t ticks) {
  stepper::ReversalGuard& guard = rows_[index(axis)].guard;
  if (guard.settled()) guard.wake(quiet_ticks(axis) + 1);
  for (; ticks != 0 && !(guard.settled() && (is_standing_still || guard.back() == back)); --ticks) {
    if (phase.rate != 0) guard.head(back);
    put_guarded_tick(axis, !phase.tick() ? 0 : back ? -1 : 1);
  }
  return ticks;
}

void StepExpander::put_still(int axis, std::uint32_t ticks) {
  Row& row = rows_[index(axis)];
  if (!row.guard.settled()) {
    StepPhase still;
    ticks = put_guarded(axis, still, false, true, ticks);
  }
  put_alike<ticks_per_step_word>(rings_.steps[index(axis)], row.fill.partial, row.dir(),
                                 row.fill.place, ticks,
                                 [&row](std::uint32_t word) { return row.finish(word); });
  row.fill.place = (row.fill.place + ticks) & place_mask;
}

void StepExpander::put_bits(std::uint8_t bits, std::uint32_t ticks) {
  put_alike<ticks_per_bits_word>(rings_.bits, bits_.partial, lattice_nibble(bits) * 0x11111111u,
                                 bits_.place, ticks, [](std::uint32_t word) { return word; });
  bits_.place = (bits_.place + ticks) & place_mask;
}

void StepExpander::put_power(std::uint16_t power, std::uint32_t ticks) {
  constexpr std::uint32_t cell = stepper::power_cell_ticks;
  const std::uint16_t counts = laser_duty(power);
  std::uint32_t at = power_place_;
  const std::uint32_t end = at + ticks;
  if (const std::uint32_t begun = at % cell; begun != 0) {
    // Dark ticks do not change the count of a cell. Ticks after its middle do so only if the count
    // is still 0, or if they are weaker and follow a dark tick.
    std::uint16_t& count = power_.counts[at / cell % power_ring_cells];
    const bool counts_too = begun <= cell / 2 || count == 0 || (dark_ && counts < count);
    if (power != 0 && counts_too) count = counts;
    at += cell - begun;
  }
  dark_ = power == 0;
  for (; static_cast<std::int32_t>(end - at) > 0; at += cell)
    power_.counts[at / cell % power_ring_cells] = counts;
  power_place_ = end;
}

/// The word at a place, as bits of DIR and STEP; DIR is valid where there is a step.
std::uint32_t StepExpander::steps_of(int axis, std::uint32_t place) const {
  const Row& row = rows_[index(axis)];
  const std::uint32_t at = place / ticks_per_step_word;
  const std::uint32_t begun = row.fill.place % ticks_per_step_word;
  if (begun != 0 && at == row.fill.place / ticks_per_step_word)
    return row.fill.partial << 2 * (ticks_per_step_word - begun);
  const auto& ring = rings_.steps[index(axis)];
  return step_word(row.mode, row.high_ticks, ring[at],
                   ring[(at + step_ring_words - 1) % step_ring_words] & 3);
}

/// Ticks since the last step, limited to what the guard needs.
std::uint32_t StepExpander::quiet_ticks(int axis) const {
  const Row& row = rows_[index(axis)];
  std::uint32_t quiet = 0;
  while (quiet < row.guard.times().after_step_ticks()) {
    const std::uint32_t place = (row.fill.place - 1 - quiet) & place_mask;
    const std::uint32_t in_word = place % ticks_per_step_word;
    const std::uint32_t after = ticks_per_step_word - 1 - in_word;
    const std::uint32_t steps = steps_of(axis, place) >> 2 * after & all_step_bits;
    if (steps != 0)
      return quiet + static_cast<std::uint32_t>(std::countr_zero(steps)) / bits_per_tick;
    quiet += in_word + 1;
  }
  return quiet;
}

/// Number of whole words without a step from a place on, within these ticks: most words have none,
/// and the caller has little time. Zero is always correct.
std::uint32_t StepExpander::quiet_words(int axis, std::uint32_t place, std::uint32_t ticks) const {
  const PulseMode mode = rows_[index(axis)].mode;
  const auto& ring = rings_.steps[index(axis)];
  const std::uint32_t most = ticks / ticks_per_step_word;
  // DIR alone does not count, nor do levels that are constant.
  const std::uint32_t counts = mode == PulseMode::step_dir ? all_step_bits : ~0u;
  std::uint32_t at = place / ticks_per_step_word, words = 0, quiet = 0;
  if (mode == PulseMode::quadrature)
    quiet = (ring[(at + step_ring_words - 1) % step_ring_words] & 3) * all_step_bits;
  for (; words != most && (ring[at] & counts) == quiet; ++words) at = (at + 1) % step_ring_words;
  return words;
}

std::int32_t StepExpander::step_at(int axis, std::uint64_t tick) const {
  // Backwards from the end: steps still in the rings and owed steps were not put out.
  const Row& row = rows_[index(axis)];
  std::int64_t step = steps_[index(axis)] - row.guard.owed();
  for (auto left = static_cast<std::uint32_t>(end_ > tick ? end_ - tick : 0); left != 0;) {
    const std::uint32_t place = (row.fill.place - left) & place_mask;
    const std::uint32_t skip = place % ticks_per_step_word;
    const std::uint32_t n = left < ticks_per_step_word - skip ? left : ticks_per_step_word - skip;
    // DIR is per tick: a word may contain both directions.
    const std::uint32_t word = steps_of(axis, place) << 2 * skip;
    const std::uint32_t used = ~0u << 2 * (ticks_per_step_word - n);
    const std::uint32_t stepping = word & used & all_step_bits;
    left -= n;
    if (stepping == 0) {
      left -= quiet_words(axis, (place + n) & place_mask, left) * ticks_per_step_word;
      continue;
    }
    const std::uint32_t back = stepping & (word >> 1);
    step -= std::popcount(stepping) - 2 * std::popcount(back);
  }
  return static_cast<std::int32_t>(step);
}

StepPosition StepExpander::steps_at(std::uint64_t tick) const {
  StepPosition steps{};
  for (int a = 0; a < max_axes; ++a) steps[index(a)] = step_at(a, tick);
  return steps;
}

}  // namespace lamplock::rp2040
