// The inner loop of motion: 16 ticks of one axis into one word.
//
// In:  phase, rate and acceleration of an axis, 64-bit fractions of a step, rate not negative.
// Out: words of 16 ticks x (DIR, STEP), the first tick in the two uppermost bits; the state after.
// Who: StepExpander (fill interrupt). Cost on the Cortex-M0+: 6 cycles a tick, 7 a word; about 26
//      cycles a tick for four axes. Of a slow axis most words have no step: those take 40 cycles.
//
//   P += R, the carry is a step; R += A
//
// is exactly AxisRun::position_after(): P(n) = P0 + n R + n(n-1)/2 A, modulo one step.
#pragma once

#include <cstdint>

#include "firmware/stepper/tick_block.hpp"

namespace lamplock::rp2040 {

/// DIR bits of all ticks of a word.
inline constexpr std::uint32_t all_dir_bits = 0xaaaaaaaau;
inline constexpr std::uint32_t all_step_bits = 0x55555555u;
inline constexpr std::uint32_t ticks_per_step_word = 16;

/// One axis in the format of the loop. Backwards the phase is mirrored: a borrow of P - R is the
/// carry of ~P + R, and ~(P - R) = ~P + R.
struct StepPhase {
  std::uint64_t phase = 0;
  std::uint64_t rate = 0;
  std::uint64_t accel = 0;

  StepPhase() = default;
  explicit StepPhase(const stepper::AxisRun& run) {
    const bool back = run.backwards();
    // From Q62 to a fraction of 64 bits; the rate stays below one step a tick.
    const std::uint64_t r = static_cast<std::uint64_t>(run.rate_q62) << 2;
    const std::uint64_t a = static_cast<std::uint64_t>(run.accel_q62) << 2;
    phase = back ? ~run.position_q64.lo() : run.position_q64.lo();
    rate = back ? 0 - r : r;
    accel = back ? 0 - a : a;
  }

  /// Advances by a tick; true if it steps.
  bool tick() {
    const std::uint64_t before = phase;
    phase += rate;
    rate += accel;
    return phase < before;
  }

  std::uint32_t phase_top() const { return static_cast<std::uint32_t>(phase >> 32); }
  std::uint32_t rate_top() const { return static_cast<std::uint32_t>(rate >> 32); }

  /// True if most words of these ticks have no step: the rate is below 1/32, at both ends.
  bool steps_rarely(std::uint32_t ticks) const {
    const std::uint64_t last =
        rate + static_cast<std::uint64_t>(short_product(static_cast<std::int64_t>(accel), ticks));
    return (rate_top() | static_cast<std::uint32_t>(last >> 32)) >> 27 == 0;
  }
};

/// Writes words out..end-1; `dir` is all_dir_bits or 0. Portable version.
inline void expand_words_portable(StepPhase& axis, std::uint32_t* out, const std::uint32_t* end,
                                  std::uint32_t dir) {
  StepPhase s = axis;
  while (out != end) {
    std::uint32_t word = 0;
    for (std::uint32_t i = 0; i < ticks_per_step_word; ++i) word = word << 2 | (s.tick() ? 1u : 0u);
    *out++ = word | dir;
  }
  axis = s;
}

/// Shifts n ticks, 1..16, into a word from below.
inline std::uint32_t expand_some_portable(StepPhase& axis, std::uint32_t word, std::uint32_t n) {
  StepPhase s = axis;
  for (; n != 0; --n) word = word << 2 | (s.tick() ? 1u : 0u);
  axis = s;
  return word;
}

#if defined(__thumb__) && defined(__ARM_ARCH_6M__)
/// An axis in six registers, lower half first.
struct PhaseWords {
  std::uint32_t p0, p1, r0, r1;
  const std::uint32_t a0, a1;

  explicit PhaseWords(const StepPhase& axis)
      : p0(static_cast<std::uint32_t>(axis.phase)),
        p1(static_cast<std::uint32_t>(axis.phase >> 32)),
        r0(static_cast<std::uint32_t>(axis.rate)),
        r1(static_cast<std::uint32_t>(axis.rate >> 32)),
        a0(static_cast<std::uint32_t>(axis.accel)),
        a1(static_cast<std::uint32_t>(axis.accel >> 32)) {}
  void store(StepPhase& axis) const {
    axis.phase = std::uint64_t{p1} << 32 | p0;
    axis.rate = std::uint64_t{r1} << 32 | r0;
  }
};

/// The same in assembler: everything in registers, carries directly into the word.
inline void expand_words(StepPhase& axis, std::uint32_t* out, const std::uint32_t* end,
                         std::uint32_t dir) {
  if (out == end) return;
  PhaseWords s(axis);
  std::uint32_t word = 0;
  // Repeated sixteen times instead of .rept: the compiler estimates distances by counting lines.
#define LAMPLOCK_ONE_TICK       \
  "lsls %[word], %[word], #1\n" \
  "adds %[p0], %[p0], %[r0]\n"  \
  "adcs %[p1], %[r1]\n"         \
  "adcs %[word], %[word]\n"     \
  "adds %[r0], %[r0], %[a0]\n"  \
  "adcs %[r1], %[a1]\n"
#define LAMPLOCK_FOUR_TICKS LAMPLOCK_ONE_TICK LAMPLOCK_ONE_TICK LAMPLOCK_ONE_TICK LAMPLOCK_ONE_TICK
  asm volatile(
      ".syntax unified\n"  // the compiler restores its own
      ".balign 4\n"
      "1:\n"  //
      LAMPLOCK_FOUR_TICKS LAMPLOCK_FOUR_TICKS LAMPLOCK_FOUR_TICKS LAMPLOCK_FOUR_TICKS
      "add %[word], %[dir]\n"  // the DIR bits are still zero
      "stmia %[out]!, {%[word]}\n"
      "cmp %[out], %[end]\n"
      "bne 1b\n"
      : [p0] "+l"(s.p0), [p1] "+l"(s.p1), [r0] "+l"(s.r0), [r1] "+l"(s.r1), [word] "+l"(word),
        [out] "+l"(out)
      : [a0] "l"(s.a0), [a1] "l"(s.a1), [dir] "h"(dir), [end] "h"(end)
      : "cc", "memory");
  s.store(axis);
}
/// Some ticks in assembler: jumps into the sixteen where n of them are left.
inline std::uint32_t expand_some_ticks(StepPhase& axis, std::uint32_t word, std::uint32_t n) {
  PhaseWords s(axis);
  constexpr std::uint32_t tick_bytes = 6 * 2;
  const std::uint32_t skip = (ticks_per_step_word - n) * tick_bytes;
  asm volatile(
      ".syntax unified\n"
      ".balign 4\n"
      "add pc, %[skip]\n"  // relative to four bytes later
      "nop\n"              //
      LAMPLOCK_FOUR_TICKS LAMPLOCK_FOUR_TICKS LAMPLOCK_FOUR_TICKS LAMPLOCK_FOUR_TICKS
      : [p0] "+l"(s.p0), [p1] "+l"(s.p1), [r0] "+l"(s.r0), [r1] "+l"(s.r1), [word] "+l"(word)
      : [a0] "l"(s.a0), [a1] "l"(s.a1), [skip] "h"(skip)
      : "cc");
#undef LAMPLOCK_FOUR_TICKS
#undef LAMPLOCK_ONE_TICK
  s.store(axis);
  return word;
}
#else
inline void expand_words(StepPhase& axis, std::uint32_t* out, const std::uint32_t* end,
                         std::uint32_t dir) {
  expand_words_portable(axis, out, end, dir);
}
inline std::uint32_t expand_some_ticks(StepPhase& axis, std::uint32_t word, std::uint32_t n) {
  return expand_some_portable(axis, word, n);
}
#endif

/// True if 16 ticks at no more than this rate certainly make no step.
inline bool is_stepless(const StepPhase& s, std::uint32_t max_rate_top) {
  return max_rate_top < ~s.phase_top() >> 4;
}

/// n ticks, 1..16, shifted into a word from below.
inline std::uint32_t expand_some(StepPhase& axis, std::uint32_t word, std::uint32_t n,
                                 std::uint32_t dir) {
  const std::uint32_t mine = n == ticks_per_step_word ? ~0u : (1u << 2 * n) - 1;
  return expand_some_ticks(axis, word, n) | (dir & mine);
}

/// As expand_words() where the axis steps_rarely(): whole words without a step at once.
inline void expand_rare_words(StepPhase& axis, std::uint32_t* out, const std::uint32_t* end,
                              std::uint32_t dir) {
  StepPhase& s = axis;
  const std::uint64_t accel16 = s.accel << 4, accel120 = (accel16 << 3) - (s.accel << 3);
  for (; out != end; ++out) {
    const std::uint64_t next = s.rate + accel16;
    const auto next_top = static_cast<std::uint32_t>(next >> 32);
    if (is_stepless(s, s.rate_top() > next_top ? s.rate_top() : next_top)) {
      s.phase += (s.rate << 4) + accel120;  // 16 R + (0 + 1 + ... + 15) A
      s.rate = next;
      *out = dir;
    } else {
      *out = expand_some_ticks(s, 0, ticks_per_step_word) | dir;
    }
  }
}

}  // namespace lamplock::rp2040
