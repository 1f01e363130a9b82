#include "firmware/boards/rp2040/lattice/lattice_output.hpp"

#include "firmware/boards/rp2040/base/allocation.hpp"
#include "firmware/boards/rp2040/registers/dma.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"

namespace lamplock::rp2040 {
namespace {

using boards::Role;
using io_ctrl::Function;
using namespace pio;

/// The pin before LASER GATE: that of LAMP TRIGGER, or no pad where there is none; PIO counts pins
/// modulo 32.
constexpr unsigned bits_base = (boards::gpio(Role::laser_gate) + 31) % 32;
constexpr std::uint32_t axis_shift = pio_shiftctrl::autopull | pio_shiftctrl::join_tx;
constexpr std::uint32_t tick_shift = pio_shiftctrl::out_right;
constexpr std::uint32_t stamp_shift = pio_shiftctrl::autopush | pio_shiftctrl::join_rx;

/// Pins of an axis in the maps that have it.
struct AxisGpios {
  std::uint8_t step = 0, dir = 0;
};
constexpr PerAxis<AxisGpios> axis_gpios = [] {
  PerAxis<AxisGpios> gpios{};
  for (int a = 0; a < max_axes; ++a)
    gpios[index(a)] = {boards::find_gpio(boards::this_board, boards::step_role(a)).value_or(0),
                       boards::find_gpio(boards::this_board, boards::dir_role(a)).value_or(0)};
  return gpios;
}();
const AxisGpios& gpios_of(int axis) { return axis_gpios[static_cast<std::size_t>(axis)]; }
const StateMachine& machine_of(int axis) { return axis_machines[static_cast<std::size_t>(axis)]; }

void select(unsigned gpio, Function function) {
  io_bank0().gpio[gpio].ctrl = io_ctrl::function(function);
}
void select_pulse(unsigned gpio, Function function, bool inverted) {
  io_bank0().gpio[gpio].ctrl =
      io_ctrl::function(function) | (inverted ? io_ctrl::output_inverted : 0);
}
/// For outputs that can release energy: held low until they are released.
void select_low(unsigned gpio, Function function) {
  io_bank0().gpio[gpio].ctrl = io_ctrl::function(function) | io_ctrl::output_low;
}

constexpr std::uint32_t max_transfers = ~0u;
/// Channels end at different times, this many words apart.
constexpr std::uint32_t stagger = 1u << 20;

std::uint32_t address(const volatile void* p) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(p));
}

constexpr std::uint32_t stream_mask = (1u << again_channel) - 1;
/// Written by channel 7: starts the streams that have ended. BITS is restarted separately.
constexpr std::uint32_t again_mask = stream_mask & ~(1u << bits_channel);

struct Stream {
  unsigned channel;
  const volatile void* from;
  volatile void* to;
  unsigned ring_bits;
  unsigned request;
  bool to_memory;
};

void start_stream(const Stream& s) {
  DmaChannelRegisters& ch = dma().ch[s.channel];
  ch.read_addr = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(s.from));
  ch.write_addr = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(s.to));
  ch.trans_count = max_transfers - s.channel * stagger;
  ch.ctrl_trig = dma_ctrl::en | dma_ctrl::high_priority | dma_ctrl::size_word |
                 (s.to_memory ? dma_ctrl::incr_write | dma_ctrl::ring_write : dma_ctrl::incr_read) |
                 dma_ctrl::ring_size(s.ring_bits) | dma_ctrl::chain_to(again_channel) |
                 dma_ctrl::treq(s.request) | dma_ctrl::irq_quiet;
}

void feed_machine(unsigned channel, const StateMachine& sm, const void* ring, unsigned ring_bits) {
  start_stream({channel, ring, &sm.registers().txf[sm.number], ring_bits,
                dreq::pio_tx(sm.block, sm.number), false});
}

void stop_channels() {
  // A disabled channel cannot be triggered by the end of another.
  constexpr std::uint32_t all = stream_mask | 1u << power_channel;
  for (unsigned channel = 0; channel < again_channel; ++channel) dma().ch[channel].al1_ctrl = 0;
  dma().ch[power_channel].al1_ctrl = 0;
  dma().chan_abort = all;
  while ((dma().chan_abort & all) != 0) {
  }
}

std::uint32_t push_of_tick(std::uint16_t move_to_isr) {
  tick_machine.execute(move_to_isr);
  tick_machine.execute(encode::push(false, false));
  return tick_machine.read();
}

}  // namespace

std::uint32_t LatticeOutput::axis_pins(int axis) const {
  const AxisGpios& gpios = gpios_of(axis);
  if constexpr (!paired_axes)
    return pio_pinctrl::out(gpios.dir, 1) | pio_pinctrl::set(gpios.step, 1);
  return pio_pinctrl::out(gpios.step, 2) |
         pio_pinctrl::set(gpios.step, fallen_pins(modes_[index(axis)], times_.high_ticks));
}

/// The program of the pulses as set.
const Program& LatticeOutput::program_of_axes() const {
  if constexpr (paired_axes) return axis_program;
  return times_.high_ticks != 0 ? long_apart_axis_program : apart_axis_program;
}

/// Replaces the program of short pulses by that of long ones or back, while there are ticks without
/// steps. Between the two stores both of the first instructions wait for the line to fall, so that
/// within a tick every state machine that waits is at the first one; from there on either program
/// does the same as long as no step is due.
void LatticeOutput::change_program(bool was_long) const {
  const auto put = [](unsigned place, std::uint16_t instruction) {
    pio0().instr_mem[axis_offset + place] = instruction;
    pio1().instr_mem[axis_offset + place] = instruction;
  };
  constexpr std::uint32_t max_tick_us = 2;
  put(was_long ? 0 : 1, apart_axis_program.at(0, axis_offset));
  const std::uint32_t begun_us = timer().timerawl;
  while (timer().timerawl - begun_us <= max_tick_us) {
  }
  put(was_long ? 1 : 0, apart_axis_program.at(1, axis_offset));
  for (int a = 0; a < axes_; ++a) machine_of(a).configure(program_of_axes(), axis_offset, 0);
}

void LatticeOutput::start_axis(int axis, const stepper::AxisPulses& pulses) const {
  const StateMachine& sm = machine_of(axis);
  const AxisGpios& gpios = gpios_of(axis);
  sm.configure(program_of_axes(), axis_offset, 0);
  sm.make_outputs_low(gpios.step, 1);
  sm.make_outputs_low(gpios.dir, 1);
  sm.machine().pinctrl = axis_pins(axis);
  // The inversion is set together with the function: the pad changes from undriven to its idle
  // level.
  const Function function = sm.block == 0 ? Function::pio0 : Function::pio1;
  select_pulse(gpios.step, function, pulses.first_inverted);
  select_pulse(gpios.dir, function, pulses.second_inverted);
}

std::uint8_t LatticeOutput::levels(int axis) {
  const std::uint32_t pads = machine_of(axis).registers().dbg_padout;
  const AxisGpios& gpios = gpios_of(axis);
  return static_cast<std::uint8_t>((pads >> gpios.step & 1) | (pads >> gpios.dir & 1) << 1);
}

void LatticeOutput::start_pins() const {
  bits_machine.configure(bits_program, bits_offset, 0);
  bits_machine.make_outputs_low(bits_base, lattice_pins);
  bits_machine.machine().pinctrl = pio_pinctrl::out(bits_base, lattice_pins);
  tick_machine.configure(tick_program.program, tick_offset, 0);
  tick_machine.make_outputs_low(tick_gpio, 1);
  tick_machine.machine().pinctrl =
      pio_pinctrl::set(bits_base, lattice_pins) | pio_pinctrl::side(tick_gpio, 1);
  stamp_machine.machine().pinctrl = 0;
  if constexpr (boards::is_inverted(Role::lamp_sync))
    io_bank0().gpio[boards::gpio(Role::lamp_sync)].ctrl =
        io_ctrl::function(Function::none) | io_ctrl::input_inverted;
  use_sync(boards::gpio(Role::lamp_sync));
  if constexpr (boards::has(Role::lamp_trigger))
    select(boards::optional_gpio(Role::lamp_trigger), Function::pio1);
  select_low(boards::gpio(Role::laser_gate), Function::pio1);
  select_low(boards::gpio(Role::shot_enable), Function::pio1);
  select(tick_gpio, Function::pio1);
}

void LatticeOutput::start(boards::Pins map, const stepper::PulseOutput& output) {
  static_assert(tick_machine.block == 1 && tick_machine.number == tick_number);
  axes_ = boards::axes(map);
  pio0().ctrl = 0;
  pio1().ctrl = 0;
  times_ = output.pulses;
  load(pio0(), program_of_axes(), axis_offset);
  load(pio1(), program_of_axes(), axis_offset);
  load(pio1(), bits_program, bits_offset);
  load(pio1(), tick_program.program, tick_offset);
  load(pio1(), stamp_program.program, stamp_offset);
  // Symbols for toolchain/gate_image, without a byte in the image.
  asm(".global pio0_instructions, pio1_instructions\n"
      ".set pio0_instructions, %c0\n"
      ".set pio1_instructions, %c1"
      :
      : "i"(pio0_instructions), "i"(pio1_instructions));
  for (int a = 0; a < axes_; ++a) {
    modes_[index(a)] = output.axis[index(a)].mode;
    start_axis(a, output.axis[index(a)]);
  }
  start_pins();
}

void LatticeOutput::set_times(const PulseTimes& times) {
  const bool was_long = times_.high_ticks != 0;
  times_ = times;
  if constexpr (paired_axes) {
    for (int a = 0; a < axes_; ++a) machine_of(a).machine().pinctrl = axis_pins(a);
  } else if (was_long != (times.high_ticks != 0)) {
    change_program(was_long);
  }
}

void LatticeOutput::use_sync(unsigned gpio) const {
  stamp_machine.configure(stamp_program.program, stamp_offset, gpio);
}

/// A narrow write reaches both channels of the slice (datasheet, 2.1.4); the other one has no pin.
void LatticeOutput::start_bits() const {
  DmaChannelRegisters& power = dma().ch[power_channel];
  power.read_addr = address(power_.counts.data());
  power.write_addr = power_address(false);
  power.trans_count = 1;
  power.al1_ctrl = dma_ctrl::en | dma_ctrl::high_priority | dma_ctrl::size_half |
                   dma_ctrl::incr_read | dma_ctrl::ring_size(power_ring_bits) |
                   dma_ctrl::chain_to(bits_channel) | dma_ctrl::treq(dreq::permanent) |
                   dma_ctrl::irq_quiet;
  DmaChannelRegisters& bits = dma().ch[bits_channel];
  bits.read_addr = address(rings_.bits.data());
  bits.write_addr = address(&bits_machine.registers().txf[bits_machine.number]);
  bits.trans_count = bits_words_per_cell;
  bits.ctrl_trig =
      dma_ctrl::en | dma_ctrl::high_priority | dma_ctrl::size_word | dma_ctrl::incr_read |
      dma_ctrl::ring_size(bits_ring_bits) | dma_ctrl::chain_to(power_channel) |
      dma_ctrl::treq(dreq::pio_tx(bits_machine.block, bits_machine.number)) | dma_ctrl::irq_quiet;
}

void LatticeOutput::start_channels() {
  again_mask_ = again_mask;
  DmaChannelRegisters& again = dma().ch[again_channel];
  again.read_addr = address(&again_mask_);
  again.write_addr = address(const_cast<std::uint32_t*>(&dma().multi_chan_trigger));
  again.trans_count = 1;
  // Chained to itself means not chained; waits until a stream triggers it.
  again.al1_ctrl = dma_ctrl::en | dma_ctrl::size_word | dma_ctrl::chain_to(again_channel) |
                   dma_ctrl::treq(dreq::permanent) | dma_ctrl::irq_quiet;
  for (int a = 0; a < axes_; ++a)
    feed_machine(static_cast<unsigned>(a), machine_of(a),
                 rings_.steps[static_cast<std::size_t>(a)].data(), step_ring_bits);
  start_bits();
  feed_machine(tick_channel, tick_machine, ticks_.words.data(), tick_ring_bits);
  start_stream({stamp_channel, &stamp_machine.registers().rxf[stamp_machine.number],
                stamps_.words.data(), stamp_ring_bits,
                dreq::pio_rx(stamp_machine.block, stamp_machine.number), true});
}

void LatticeOutput::prepare() {
  for (const StateMachine& sm : axis_machines) sm.disable();
  bits_machine.disable();
  tick_machine.disable();
  stamp_machine.disable();
  stop_channels();
  for (int a = 0; a < axes_; ++a) {
    machine_of(a).restart(axis_shift, axis_offset + axis_entry);
    machine_of(a).execute(encode::set(SetTo::pins, 0));
  }
  bits_machine.restart(axis_shift, bits_offset + bits_program.wrap_target);
  stamp_machine.restart(stamp_shift, stamp_offset + stamp_program.entry);
  stamp_machine.execute(encode::move(MoveTo::x, MoveFrom::null, Operation::invert));
  tick_machine.restart(tick_shift, tick_offset + tick_program.entry);
  tick_machine.execute(encode::set(SetTo::pins, 0));
  tick_machine.write(tick_high_clocks - tick_high_overhead);
  tick_machine.execute(encode::pull(false, false));
  tick_machine.execute(encode::move(MoveTo::isr, MoveFrom::osr));
  tick_machine.execute(encode::move(MoveTo::x, MoveFrom::null));
  start_channels();
  // AXIS and BITS first: they wait for a tick with their first words loaded.
  for (int a = 0; a < axes_; ++a) machine_of(a).enable();
  bits_machine.enable();
}

std::uint64_t LatticeOutput::ticks_begun(const TickFeed& feed) const {
  const std::uint32_t read = (dma().ch[tick_channel].read_addr - address(ticks_.words.data())) / 4;
  std::uint32_t in_ring = (feed.words() - read) % tick_ring_words;
  // Zeros after the words may have been read ahead: then the difference is negative.
  if (in_ring > tick_ring_words / 2) in_ring -= tick_ring_words;
  const std::uint32_t taken = feed.words() - in_ring - tick_machine.tx_level();
  const unsigned place = tick_machine.place(tick_offset);
  if (place == tick_program.starved) return feed.ticks_begun(feed.words(), 0);
  const std::uint32_t left = push_of_tick(encode::move(MoveTo::isr, MoveFrom::x));
  const std::uint32_t word = push_of_tick(encode::move(MoveTo::isr, MoveFrom::osr));
  if (place <= tick_program.entry) return feed.ticks_begun(taken, 0);    // the word is done
  if (place >= tick_program.high) return feed.ticks_begun(taken, left);  // this tick has begun
  if (word == 0) return feed.ticks_begun(taken, 0);                      // there was no word
  const bool just_pulled = place < tick_program.next;
  return feed.ticks_begun(taken, (just_pulled ? word & 0xffff : left) + 1);
}

}  // namespace lamplock::rp2040
