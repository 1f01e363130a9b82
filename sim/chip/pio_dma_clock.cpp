#include "sim/chip/pio_dma_clock.hpp"

#include <algorithm>

namespace lamplock::sim::chip {

namespace {
/// Pins of bank 0; the latches have 32 bits.
constexpr std::uint32_t bank_pins = (1u << gpio_count) - 1u;
}  // namespace

PioDmaClock::PioDmaClock(TimeWheel& wheel, Bus& bus, Gpio& gpio, IrqLines& irqs,
                         const Timing& timing, const NotModelled& not_modelled)
    : wheel_(wheel),
      gpio_(gpio),
      dreqs_(*this),
      pio_{PioBlock{*this, 0, irqs, not_modelled}, PioBlock{*this, 1, irqs, not_modelled}},
      dma_(*this, bus, dreqs_, pio_, irqs, timing, not_modelled),
      slot_(wheel.add(*this)),
      next_(wheel.now()) {
  gpio_.listen(static_cast<InputListener&>(*this));
  for (PioBlock& block : pio_) block.set_inputs(gpio_.inputs(), next_);
}

void PioDmaClock::set_step_every_clock(bool on) {
  bring_up_to_date();
  every_clock_ = on;
  for (PioBlock& block : pio_) block.set_every_clock(on, next_);
  update_wheel();
}

void PioDmaClock::set_pio_clock(std::size_t block, bool runs) {
  bring_up_to_date();
  pio_[block].set_clock(runs, next_);
  if (runs) pio_[block].set_inputs(gpio_.inputs(), next_ - 1);
  update_wheel();
}

void PioDmaClock::set_dma_clock(bool runs) {
  bring_up_to_date();
  dma_.set_clock(runs, next_);
  update_wheel();
}

Cycle PioDmaClock::next_due() const {
  if (every_clock_ || pio_[0].pins_pending() || pio_[1].pins_pending()) return next_;
  return std::max(next_, std::min({pio_[0].due(), pio_[1].due(), dma_.due()}));
}

void PioDmaClock::update_wheel() { wheel_.set(slot_, next_due()); }

// Run by the wheel, clocks are its time: what the DMA writes to a block takes effect then, and may
// make that block due before `to`.
void PioDmaClock::through(Cycle to, bool by_wheel) {
  if (running_) return;
  running_ = true;
  while (next_ <= to) {
    const Cycle clock = next_due();
    if (clock > to) {
      next_ = to + 1;
      break;
    }
    next_ = clock + 1;
    if (by_wheel) wheel_.move_to(clock);
    one_clock(clock);
    if (by_wheel) to = std::min(to, std::max(clock, wheel_.next()));
  }
  running_ = false;
}

inline void PioDmaClock::put_on_pads(Cycle clock) {
  constexpr std::array<PinFunction, 2> functions{PinFunction::pio0, PinFunction::pio1};
  for (std::size_t i = 0; i < pio_.size(); ++i)
    if (pio_[i].pins_pending()) {
      const std::uint32_t levels = pio_[i].take_levels() & bank_pins;
      gpio_.drive(functions[i], levels, pio_[i].take_enables() & bank_pins, clock);
    }
}

void PioDmaClock::one_clock(Cycle clock) {
  if (pio_[0].pins_pending() || pio_[1].pins_pending()) put_on_pads(clock);
  if (pio_[0].due() <= clock) pio_[0].clock(clock);
  if (pio_[1].due() <= clock) pio_[1].clock(clock);
  const bool first_changed = pio_[0].take_fifo_changed();
  const bool fifo_changed = pio_[1].take_fifo_changed() || first_changed;
  if (fifo_changed) dma_.levels_changed(clock);
  if (dma_.due() <= clock || every_clock_) dma_.clock(clock);
}

void PioDmaClock::run(Cycle to) {
  through(to, true);
  update_wheel();
}

Cycle PioDmaClock::bring_up_to_date() {
  through(wheel_.now());
  return next_;
}

void PioDmaClock::changed() {
  if (running_) return;
  const bool first_changed = pio_[0].take_fifo_changed();
  if (pio_[1].take_fifo_changed() || first_changed) dma_.levels_changed(next_);
  update_wheel();
}

void PioDmaClock::catch_up(Cycle at) {
  if (running_) return;
  through(at);
  update_wheel();
}

/// The first flip-flop takes over levels that change in cycle `at` at the end of that cycle,
/// however far the blocks have been run.
void PioDmaClock::inputs_changed(Cycle at) {
  if (!running_) {
    through(at);
    for (PioBlock& block : pio_) block.set_inputs(gpio_.inputs(), at);
    update_wheel();
  } else {
    for (PioBlock& block : pio_) block.set_inputs(gpio_.inputs(), next_ - 1);
  }
}

void PioDmaClock::dreq_pulsed(unsigned dreq) {
  bring_up_to_date();
  dma_.pulse(dreq, next_ - 1);
  changed();
}

void PioDmaClock::dreq_level_changed() {
  bring_up_to_date();
  dma_.levels_changed(next_);
  changed();
}

}  // namespace lamplock::sim::chip
