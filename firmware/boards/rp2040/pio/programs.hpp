// The programs of the state machines: steps, tick line, lattice bits, fire stage, time stamps.
//
// In:  words that the CPU writes ahead of time (DMA rings), pins.
// Out: STEP, DIR (or CW and CCW, A and B), lattice bits, Q-switch; results of LAMP SYNC edges;
// times of edges.
//
//   PIO0: AXIS x 3 (state machines 0..2), FIRE (3)              26 or 29 of 32 instructions
//   PIO1: AXIS (0), BITS (1), TICK (2), STAMP (3)               29 or 32 of 32
//
// AXIS has 4 instructions where the pins of an axis are neighbours, else 7.
//
// All clock counts are system clocks, the state machines run undivided. A level on a pad at clock 0
// is seen by an instruction that executes at clock 3 (two flip-flops, datasheet 3.5.6.3, and the
// register before the state machine: raspberrypi/pico-feedback, issue 280); what an instruction at
// clock t puts out is on the pad at clock t + 1.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/pio/assembler.hpp"
#include "firmware/machine/controller.hpp"
#include "shared/boards/this_board.hpp"
#include "shared/pulse_times.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040::pio {

inline constexpr unsigned synchroniser_clocks = 3;
inline constexpr unsigned pad_clocks = 1;
inline constexpr unsigned tick_gpio = boards::gpio(boards::Role::tick_line);

/// AXIS of a board whose DIR pins are next to their STEP pins: per tick the levels of the two pins
/// of the axis, the second one (DIR, CCW, B) first, autopull at 32 bits. OUT pins: both; SET pins:
/// those that fall with the tick line, from the first one on, their number depending on the pulses
/// (fallen_pins()). So a short pulse is as long as the tick line is high, a longer one ends with a
/// tick, DIR changes at the beginning of a tick, at least one before the step
/// (stepper/reversal_guard.hpp), and levels in quadrature are constant. Without data or without
/// ticks it waits, with short pulses low.
consteval Program make_paired_axis() {
  Assembler a;
  a.wrap_target();
  a.wait(true, WaitFor::gpio, tick_gpio).delay(1);
  a.out(OutTo::pins, 2);
  a.wait(false, WaitFor::gpio, tick_gpio);
  a.set(SetTo::pins, 0);
  a.wrap();
  return a.finish();
}
/// AXIS of other boards, for the same words, STEP and DIR only. OUT pin: DIR; SET pin: STEP. A
/// short pulse falls with the tick line; a longer one is set again by each of its ticks and falls
/// with the first tick without it. Only the first two instructions and the wrap differ, so that one
/// can replace the other while there are ticks without steps (LatticeOutput::set_times()).
consteval Program make_apart_axis(bool is_long) {
  Assembler a;
  const Label low = a.here();
  if (is_long) {
    a.set(SetTo::pins, 0);
    a.wrap_target();
    a.wait(false, WaitFor::gpio, tick_gpio);
  } else {
    a.wrap_target();
    a.wait(false, WaitFor::gpio, tick_gpio);
    a.set(SetTo::pins, 0);
  }
  a.wait(true, WaitFor::gpio, tick_gpio);
  a.out(OutTo::pins, 1);
  a.out(OutTo::x, 1);
  a.jump(Jump::x_zero, low);
  a.set(SetTo::pins, 1);
  a.wrap();
  return a.finish();
}
inline constexpr bool paired_axes = boards::has_paired_axes(boards::this_board);
inline constexpr Program apart_axis_program = make_apart_axis(false);
inline constexpr Program long_apart_axis_program = make_apart_axis(true);
inline constexpr Program axis_program = paired_axes ? make_paired_axis() : apart_axis_program;
/// Where AXIS waits for its first tick.
inline constexpr unsigned axis_entry = paired_axes ? 0 : 2;
/// Between the wait for a tick and the change of STEP: a delay, or the instructions for DIR.
inline constexpr unsigned clocks_before_step = paired_axes ? 1 : 3;
/// Tick line on its pad to STEP on its pad: synchroniser, wait, those clocks, out or set.
inline constexpr unsigned step_latency_clocks =
    synchroniser_clocks + 1 + clocks_before_step + pad_clocks;
/// SET count of AXIS: of short pulses STEP alone, or CW and CCW; otherwise none.
constexpr unsigned fallen_pins(settings::PulseMode mode, std::uint32_t high_ticks) {
  if (mode == settings::PulseMode::quadrature || high_ticks != 0) return 0;
  return mode == settings::PulseMode::step_dir ? 1 : 2;
}
/// The tick line falls on its pad to STEP falls on its pad: fewer clocks than at the rise.
inline constexpr unsigned fall_latency_clocks = synchroniser_clocks + 1 + pad_clocks;
/// High time of the tick line: that of a short pulse, rounded up, at the pad of STEP.
inline constexpr unsigned tick_high_clocks =
    (clocks_per_us * short_pulse_ns + 999) / 1000 + step_latency_clocks - fall_latency_clocks;

/// BITS: per tick four lattice bits, most significant nibble first, autopull at 32 bits. They
/// change on the same clock as STEP. At the end TICK clears them.
consteval Program make_bits() {
  Assembler a;
  a.wrap_target();
  a.wait(true, WaitFor::gpio, tick_gpio).delay(clocks_before_step);
  a.out(OutTo::pins, 4);
  a.wait(false, WaitFor::gpio, tick_gpio);
  a.wrap();
  return a.finish();
}
inline constexpr Program bits_program = make_bits();
/// The bits of the four that drive pins: trigger, gate, arm (OUT count, SET count of TICK).
inline constexpr unsigned lattice_pins = 3;

/// TICK: drives the tick line (side-set) from words of ticks - 1 (low half) and low time (high
/// half). A tick is: low time, then the rise that begins it, then the high time stored in ISR. All
/// ticks of a word have the same length, whether the next one comes from the same word or not.
/// Without a word all lattice bits go low (SET pins) and the line stays low until the state machine
/// is restarted. So words are credits, and a CPU that hangs ends motion, triggers and continuous
/// power.
struct TickProgram {
  Program program;
  std::uint8_t entry = 0;    ///< where to start
  std::uint8_t next = 0;     ///< the next tick is about to begin, X + 1 are left in the word ...
  std::uint8_t high = 0;     ///< ... from here on it has begun and X are left
  std::uint8_t starved = 0;  ///< the end: there was no word
};
consteval TickProgram make_tick() {
  Assembler a(1);
  const Label starved = a.label();
  const Label fetch = a.here();
  a.pull(false).side(0);  // X is zero here: no word reads as zero
  a.out(OutTo::x, 16).side(0);
  const Label next = a.here();
  a.move(MoveTo::y, MoveFrom::osr).side(0);
  a.jump(Jump::y_zero, starved).side(0);
  const Label low = a.here();
  a.jump(Jump::y_nonzero_decrement, low).side(0);
  a.move(MoveTo::y, MoveFrom::isr).side(1);  // the tick begins
  const Label high = a.here();
  a.jump(Jump::y_nonzero_decrement, high).side(1);
  a.jump(Jump::x_zero, fetch).side(0);
  a.jump(Jump::x_nonzero_decrement, next).side(0).delay(1);  // as long as a fetch
  a.bind(starved);
  a.wrap_target();
  a.set(SetTo::pins, 0).side(0);
  a.wrap();
  return {a.finish(), a.address(fetch), a.address(next), a.address(high), a.address(starved)};
}
inline constexpr TickProgram tick_program = make_tick();
/// High time of the line = value in ISR + 2.
inline constexpr unsigned tick_high_overhead = 2;
/// Low time = value in the word + 6: after the fall X test, fetch or delayed jump (3), Y, test, and
/// one more than the count.
inline constexpr unsigned tick_low_overhead = 6;
/// Start of the state machine to the first rise on the pad, without low time: pull, out, Y, test,
/// the counting loop's last round, the rise itself.
inline constexpr unsigned tick_start_clocks = 5 + pad_clocks;

/// STAMP: times of both edges of its JMP pin. X counts down once in 2 clocks in every path; rise
/// and fall alternate, the first stamp is a rise. `in` pushes by itself (autopush at 32 bits); DMA
/// empties the FIFO, so that it never waits. At a falling edge X is one count too high.
///
///   path       clocks  counts
///   low        2       1
///   rise       4       1 (one late until the fall)
///   high       2       1
///   fall       6       4
struct StampProgram {
  Program program;
  std::uint8_t entry = 0;
};
consteval StampProgram make_stamp() {
  Assembler a;
  const Label high = a.label(), low = a.label(), rise = a.label();
  const Label stay = a.here();
  a.jump(Jump::x_nonzero_decrement, high);  // X = 0: continues as well, because X wraps
  a.bind(high);
  a.jump(Jump::pin, stay);
  a.in(InFrom::x, 32);
  for (int i = 0; i < 4; ++i) {
    const Label on = a.label();
    a.jump(Jump::x_nonzero_decrement, on);
    a.bind(on);
  }
  a.bind(low);
  a.wrap_target();
  a.jump(Jump::pin, rise);
  a.jump(Jump::x_nonzero_decrement, low);
  a.wrap();
  a.bind(rise);
  a.in(InFrom::x, 32);
  const Label on = a.label();
  a.jump(Jump::x_nonzero_decrement, on);
  a.bind(on);
  a.jump(high);
  return {a.finish(), a.address(low)};
}
inline constexpr StampProgram stamp_program = make_stamp();
inline constexpr unsigned clocks_per_stamp = 2;

/// FIRE: the fire stage. IN pin: LAMP SYNC; JMP pin: ARM; SET pin: Q-switch. An edge is accepted if
/// 32 samples, evenly over 2 us but for the first gap, are high; then one decision: a word present
/// (the token: delay count, width count) and ARM high. Results: all ones when a pulse has begun,
/// the delay count if a token was consumed without a shot, 0 if there was none. While it waits to
/// push a result without a shot it misses edges; the result of a shot never waits: there is room,
/// since a token is only loaded after all results were read.
struct FireProgram {
  Program program;
  std::uint8_t delay = 0;  ///< before the pulse: from here ...
  std::uint8_t pulse = 0;  ///< ... to here (the first instruction with the Q-switch on)
  std::uint8_t after = 0;  ///< first instruction with the Q-switch off again
};
inline constexpr unsigned filter_samples = 32;
/// Two clocks pass between the edge and the first gap.
inline constexpr unsigned filter_raster = (2 * clocks_per_us - 2) / (filter_samples - 1);
/// What the raster leaves of 2 us: before the first sample.
inline constexpr unsigned filter_first_gap =
    2 * clocks_per_us - 2 - (filter_samples - 1) * filter_raster;
/// Between the last sample and the decision, so that it is at the time that the core expects.
inline constexpr unsigned decision_padding = 12 - filter_raster;
static_assert(filter_raster <= 12);
/// One count of the delay and of the width: 16 bits must hold the maxima of $902 and $903.
inline constexpr unsigned clocks_per_delay_count = clock_hz > 131'000'000 ? 2 : 1;
inline constexpr unsigned clocks_per_width_count = 2 * clocks_per_delay_count;
consteval FireProgram make_fire() {
  Assembler a;
  a.wrap_target();
  const Label start = a.here();
  a.wait(false, WaitFor::pin, 0);
  a.wait(true, WaitFor::pin, 0);
  a.set(SetTo::y, filter_samples - 1).delay(filter_first_gap);
  const Label sample = a.here();
  a.in(InFrom::pins, 1);
  a.jump(Jump::y_nonzero_decrement, sample).delay(filter_raster - 2);
  a.move(MoveTo::x, MoveFrom::isr, Operation::invert);
  const Label decide = a.label();
  a.jump(Jump::x_zero, decide).delay(decision_padding);
  a.wrap();  // a runt
  a.bind(decide);
  a.pull(false);  // X is zero here: no token reads as zero
  a.out(OutTo::x, 16);
  const Label armed = a.label();
  a.jump(Jump::pin, armed);
  const Label report = a.here();
  a.move(MoveTo::isr, MoveFrom::x);
  a.push(true);
  a.jump(start);
  a.bind(armed);
  a.jump(Jump::x_zero, report);
  a.out(OutTo::y, 16);
  const Label delay = a.here();
  a.jump(Jump::x_nonzero_decrement, delay).delay(clocks_per_delay_count - 1);
  a.set(SetTo::pins, 1);
  const Label pulse = a.here();
  a.move(MoveTo::isr, MoveFrom::null, Operation::invert);
  a.push(false);
  const Label width = a.here();
  a.jump(Jump::y_nonzero_decrement, width).delay(clocks_per_width_count - 1);
  a.set(SetTo::pins, 0);
  const Label after = a.here();
  a.jump(start);
  return {a.finish(), a.address(delay), a.address(pulse), a.address(after)};
}
inline constexpr FireProgram fire_program = make_fire();

/// LAMP SYNC on its pad to the instruction that tests ARM: synchroniser, wait, Y, samples, the
/// test, its padding, pull, out.
inline constexpr unsigned fire_decision_clock = synchroniser_clocks + 2 + filter_first_gap +
                                                filter_samples * filter_raster + 2 +
                                                decision_padding + 2;
static_assert(fire_decision_clock == machine::fire_decision_clocks);
/// Pulses up to this many clocks are runts: the last sample must be high.
inline constexpr unsigned max_runt_clocks =
    2 + filter_first_gap + (filter_samples - 1) * filter_raster;
static_assert(max_runt_clocks == lamp::min_sync_clocks);
/// Edge to Q-switch = this + delay counts, at least one: decision, token test, width, one round
/// more than the count, set, pad.
inline constexpr unsigned fire_fixed_clocks = fire_decision_clock + 4 + clocks_per_delay_count;
/// Width of the pulse = this + width counts: result (2), one round more than the count, fall.
inline constexpr unsigned fire_width_fixed_clocks = 3 + clocks_per_width_count;
inline constexpr unsigned min_delay_clocks = fire_fixed_clocks + clocks_per_delay_count;
inline constexpr unsigned max_delay_clocks = fire_fixed_clocks + 0xffff * clocks_per_delay_count;

inline constexpr std::uint32_t fired_result = 0xffffffffu;

// Offset of each program in its block.
inline constexpr unsigned axis_offset = 0;
inline constexpr unsigned fire_offset = axis_offset + axis_program.size;
inline constexpr unsigned bits_offset = axis_offset + axis_program.size;
inline constexpr unsigned tick_offset = bits_offset + bits_program.size;
inline constexpr unsigned stamp_offset = tick_offset + tick_program.program.size;
/// Instructions in each block.
inline constexpr unsigned pio0_instructions = fire_offset + fire_program.program.size;
inline constexpr unsigned pio1_instructions = stamp_offset + stamp_program.program.size;
static_assert(pio0_instructions <= block_size && pio1_instructions <= block_size);

}  // namespace lamplock::rp2040::pio
