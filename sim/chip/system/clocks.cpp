#include "sim/chip/system/clocks.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "sim/chip/fabric/wide.hpp"

namespace lamplock::sim::chip {

namespace {

// Offsets (2.15.7): ten generators of CTRL, DIV, SELECTED, then the rest.
constexpr std::uint32_t generator_bytes = 0x0c;
constexpr std::uint32_t offset_resus_control = 0x78;
constexpr std::uint32_t offset_resus_status = 0x7c;
constexpr std::uint32_t offset_fc0 = 0x80;  // REF_KHZ, MIN_KHZ, MAX_KHZ, DELAY, INTERVAL, SRC
constexpr std::uint32_t offset_fc0_source = 0x94;
constexpr std::uint32_t offset_fc0_status = 0x98;
constexpr std::uint32_t offset_fc0_result = 0x9c;
constexpr std::uint32_t offset_wake = 0xa0;
constexpr std::uint32_t offset_sleep = 0xa8;
constexpr std::uint32_t offset_enabled = 0xb0;
constexpr std::uint32_t offset_intr = 0xb8;
constexpr std::uint32_t offset_ints = 0xc4;

// Writable bits of CTRL and DIV of each generator; clk_peri has no divider.
constexpr std::array<std::uint32_t, clock_count> control_masks{
    0x00131de0, 0x00131de0, 0x00131de0, 0x00131de0, 0x00000063,
    0x000000e1, 0x00000ce0, 0x00130ce0, 0x00130ce0, 0x00130ce0};
constexpr std::array<std::uint32_t, clock_count> divider_masks{
    0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0x00000300,
    0xffffffff, 0x00000000, 0x00000300, 0x00000300, 0xffffffff};
constexpr std::uint32_t divider_one = 0x100;  // 24.8 fixed point
constexpr std::uint32_t control_enable = 1u << 11;
constexpr std::uint32_t control_kill = 1u << 10;

constexpr std::uint32_t resus_reset = 0xff;
constexpr std::uint32_t resus_mask = 0x000111ff;
constexpr std::uint32_t resus_timeout = 0xff;
constexpr std::uint32_t resus_enable = 1u << 8;
constexpr std::uint32_t resus_force = 1u << 12;
constexpr std::uint32_t resus_clear = 1u << 16;
constexpr std::array<std::uint32_t, 6> fc0_masks{0xfffff, 0x1ffffff, 0x1ffffff, 7, 15, 0xff};
constexpr std::array<std::uint32_t, 6> fc0_resets{0, 0, 0x1ffffff, 1, 8, 0};
constexpr Picoseconds fc0_base_hz = 1'024'000;
constexpr std::uint32_t fc0_edge = 1024 * 32;  ///< of RESULT for an edge in the shortest interval
constexpr std::array<std::uint32_t, 2> enable_masks{0xffffffff, 0x7fff};

constexpr std::size_t index_of(Clock clock) { return static_cast<std::size_t>(clock); }
constexpr bool has_mux(Clock clock) { return clock == Clock::ref || clock == Clock::sys; }

}  // namespace

enum class Clocks::Source : std::uint8_t {
  nothing,
  sys_pll,
  usb_pll,
  ring,
  crystal,
  pin0,
  pin1,
  ref,
  sys,
  peri,
  usb,
  adc,
  rtc
};

Clocks::Clocks(TimeWheel& wheel, Xosc& xosc, Rosc& rosc, Pll& pll_sys, Pll& pll_usb,
               FunctionPins& pins, IrqLines& irqs, Held held, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      xosc_(xosc),
      rosc_(rosc),
      pll_sys_(pll_sys),
      pll_usb_(pll_usb),
      irqs_(irqs),
      pins_(pins),
      held_(std::move(held)),
      not_modelled_(std::move(not_modelled)),
      outputs_(wheel, pins, not_modelled_),
      interrupts_(offset_intr, interrupt_resus) {
  pins_.listen(*this);
  xosc_.on_change([this] {
    pll_sys_.reference_changed();
    pll_usb_.reference_changed();
    refresh();
  });
  rosc_.on_change([this] { refresh(); });
  pll_sys_.on_change([this] { refresh(); });
  pll_usb_.on_change([this] { refresh(); });
  reset();
}

void Clocks::reset() {
  for (Generator& generator : generators_) generator = {0, divider_one, 0};
  generators_[index_of(Clock::peri)].divider = 0;
  resus_control_ = resus_reset;
  stopped_ = resussed_ = false;
  counter_ = fc0_resets;
  counted_hz_ = 0;
  wake_enable_ = sleep_enable_ = enable_masks;
  interrupts_.reset();
  apply_enables();
  wheel_.set(slot_, never_cycle);
  refresh();
  update_irq();
}

void Clocks::update_irq() { irqs_.set(Irq::clocks, interrupts_.status(raised()) != 0); }

// --- frequencies

template <std::size_t size>
Clocks::Source Clocks::pick(const std::array<Source, size>& table, std::uint32_t index) {
  return index < size ? table[index] : Source::nothing;
}

std::uint64_t Clocks::hz_of(Source source) const {
  switch (source) {
    case Source::sys_pll:
      return pll_sys_.hz();
    case Source::usb_pll:
      return pll_usb_.hz();
    case Source::ring:
      return rosc_.hz();
    case Source::crystal:
      return xosc_.hz();
    case Source::pin0:
      return input_hz(0);
    case Source::pin1:
      return input_hz(1);
    case Source::ref:
      return hz(Clock::ref);
    case Source::sys:
      return hz(Clock::sys);
    case Source::peri:
      return hz(Clock::peri);
    case Source::usb:
      return hz(Clock::usb);
    case Source::adc:
      return hz(Clock::adc);
    case Source::rtc:
      return hz(Clock::rtc);
    case Source::nothing:
      break;
  }
  return 0;
}

std::uint64_t Clocks::auxiliary_hz(Clock clock) const {
  // In the order of AUXSRC (2.15.7).
  using enum Source;
  static constexpr std::array<Source, 11> for_gpout{sys_pll, pin0, pin1, usb_pll, ring, crystal,
                                                    sys,     usb,  adc,  rtc,     ref};
  static constexpr std::array<Source, 3> for_ref{usb_pll, pin0, pin1};
  static constexpr std::array<Source, 6> for_sys{sys_pll, usb_pll, ring, crystal, pin0, pin1};
  static constexpr std::array<Source, 7> for_peri{sys, sys_pll, usb_pll, ring, crystal, pin0, pin1};
  static constexpr std::array<Source, 6> for_others{usb_pll, sys_pll, ring, crystal, pin0, pin1};

  const std::uint32_t field = generators_[index_of(clock)].control >> 5;
  switch (clock) {
    case Clock::ref:
      return hz_of(pick(for_ref, field & 3u));
    case Clock::sys:
      return hz_of(pick(for_sys, field & 7u));
    case Clock::peri:
      return hz_of(pick(for_peri, field & 7u));
    case Clock::usb:
    case Clock::adc:
    case Clock::rtc:
      return hz_of(pick(for_others, field & 7u));
    default:
      return hz_of(pick(for_gpout, field & 15u));
  }
}

std::uint64_t Clocks::source_hz(Clock clock) const {
  const std::uint32_t selected = generators_[index_of(clock)].selected;
  if (clock == Clock::ref) {
    if (selected == 0) return rosc_.hz();
    return selected == 2 ? xosc_.hz() : auxiliary_hz(clock);
  }
  if (clock == Clock::sys && selected == 0) return hz(Clock::ref);
  return auxiliary_hz(clock);
}

/// 24.8 fixed point. An integer part of zero divides by the maximum plus one (2^16, 2^2 for two
/// bits).
std::uint64_t Clocks::divisor(Clock clock) const {
  if (clock == Clock::peri) return divider_one;
  const Generator& generator = generators_[index_of(clock)];
  const std::uint64_t whole = generator.divider >> 8;
  const bool two_bits = divider_masks[index_of(clock)] == 0x300;
  return (whole != 0 ? whole : (two_bits ? 4u : 0x10000u)) << 8 | (generator.divider & 0xffu);
}

std::uint64_t Clocks::generated(Clock clock) const {
  const Generator& generator = generators_[index_of(clock)];
  const bool is_on = has_mux(clock) || ((generator.control & control_enable) != 0 &&
                                        (generator.control & control_kill) == 0);
  if (!is_on) return 0;
  if (clock == Clock::sys && resussed_) return hz(Clock::ref);
  return (source_hz(clock) << 8) / divisor(clock);
}

// Computes each frequency again, after those it depends on.
void Clocks::refresh() {
  if (refreshing_) return;
  refreshing_ = true;
  constexpr std::array<Clock, clock_count> order{
      Clock::ref, Clock::sys,    Clock::peri,   Clock::usb,    Clock::adc,
      Clock::rtc, Clock::gpout0, Clock::gpout1, Clock::gpout2, Clock::gpout3};
  const std::array<std::uint64_t, clock_count> before = hz_;
  for (const Clock clock : order) hz_[index_of(clock)] = generated(clock);
  set_system_clock();
  refreshing_ = false;
  for (std::size_t n = 0; n < ClockOutputs::output_count; ++n) {
    const auto output = static_cast<Clock>(n);
    outputs_.set(n, hz(output) == 0 ? 0 : source_hz(output), divisor(output));
  }
  if (before == hz_) return;
  for (ClockListener* listener : listeners_) listener->clocks_changed();
}

/// clk_sys moves the wheel. When it stops, cycles stop: the resuscitation lets one of them last as
/// many cycles of clk_ref as its TIMEOUT and forces clk_sys to clk_ref (2.15.5).
void Clocks::set_system_clock() {
  if (hz(Clock::sys) != 0) {
    stopped_ = false;
    return wheel_.set_frequency(hz(Clock::sys));
  }
  const bool helped = (resus_control_ & resus_enable) != 0 && hz(Clock::ref) != 0;
  if (!helped) return not_modelled_("CLOCKS: clk_sys has stopped; it keeps its last frequency");
  if (std::exchange(stopped_, true)) return;
  const std::uint64_t timeout = std::max(1u, resus_control_ & resus_timeout);
  wheel_.set_frequency(std::max<std::uint64_t>(1, hz(Clock::ref) / timeout));
  wheel_.set(slot_, wheel_.now() + 1);
}

void Clocks::write_resus(std::uint32_t value) {
  resus_control_ = value & resus_mask;
  if ((resus_control_ & resus_force) != 0)
    resussed_ = true;
  else if ((resus_control_ & resus_clear) != 0)
    resussed_ = false;
  refresh();
  update_irq();
}

// --- pins

void Clocks::set_input_hz(unsigned input, std::uint64_t hz) {
  input_hz_[input] = hz;
  refresh();
}

std::uint64_t Clocks::input_hz(unsigned input) const {
  const bool connected = pins_.connected(static_cast<unsigned>(ClockOutputs::output_count) + input);
  return connected ? input_hz_[input] : 0;
}

void Clocks::pins_changed(Cycle /*at*/) {
  if (input_hz_[0] != 0 || input_hz_[1] != 0) refresh();
}

// The glitchless multiplexers follow SRC, but keep their source when the new one has stopped.
void Clocks::change_over() {
  for (const Clock clock : {Clock::ref, Clock::sys}) {
    Generator& generator = generators_[index_of(clock)];
    const std::uint32_t wanted = generator.control & (clock == Clock::ref ? 3u : 1u);
    if (wanted == generator.selected) continue;
    const std::uint32_t old = std::exchange(generator.selected, wanted);
    if (source_hz(clock) == 0) {
      generator.selected = old;
      not_modelled_("CLOCKS: a glitchless multiplexer was set to a source that has stopped");
    }
  }
  refresh();
}

void Clocks::run(Cycle) {
  if (std::exchange(stopped_, false)) {
    resussed_ = true;
    update_irq();
  }
  change_over();
}

// --- registers

void Clocks::write_generator(std::size_t index, std::uint32_t reg, std::uint32_t value) {
  Generator& generator = generators_[index];
  if (reg == 0) {
    generator.control = value & control_masks[index];
    const std::uint32_t source = index == index_of(Clock::ref) ? 3u : 1u;
    if (has_mux(static_cast<Clock>(index)) && (generator.control & source) != generator.selected)
      wheel_.set(slot_, wheel_.now() + mux_cycles);
  } else if (reg == 4) {
    generator.divider = value & divider_masks[index];
  }
  refresh();
}

std::uint32_t Clocks::peek(std::uint32_t offset) const {
  if (offset < offset_resus_control) {
    const Generator& generator = generators_[offset / generator_bytes];
    switch (offset % generator_bytes) {
      case 0:
        return generator.control;
      case 4:
        return generator.divider;
      default:
        return 1u << generator.selected;
    }
  }
  if (offset >= offset_fc0 && offset <= offset_fc0_source)
    return counter_[(offset - offset_fc0) / 4];
  switch (offset) {
    case offset_resus_control:
      return resus_control_;
    case offset_resus_status:
      return resussed_ ? 1u : 0u;
    case offset_fc0_status:
      return counter_status();
    case offset_fc0_result:
      return counter_result();
    case offset_wake:
    case offset_wake + 4:
      return wake_enable_[(offset - offset_wake) / 4];
    case offset_sleep:
    case offset_sleep + 4:
      return sleep_enable_[(offset - offset_sleep) / 4];
    case offset_enabled:
    case offset_enabled + 4:
      return enabled_[(offset - offset_enabled) / 4];
    default:
      return interrupts_.read(offset, raised());
  }
}

std::uint32_t Clocks::read(std::uint32_t offset) {
  if (offset > offset_ints) not_modelled_("CLOCKS: no register at this offset");
  return peek(offset);
}

// --- gates (2.15.3.5)

void Clocks::on_gate(ClockGate gate, std::function<void(bool runs)> changed) {
  gates_[static_cast<std::size_t>(gate)] = std::move(changed);
}

void Clocks::write_enables(std::uint32_t offset, std::uint32_t value) {
  const std::size_t word = offset / 4 % 2;
  (offset < offset_sleep ? wake_enable_ : sleep_enable_)[word] = value & enable_masks[word];
  apply_enables();
}

void Clocks::set_asleep(bool asleep) {
  asleep_ = asleep;
  apply_enables();
}

void Clocks::apply_enables() {
  const auto& wanted = asleep_ ? sleep_enable_ : wake_enable_;
  for (std::size_t bit = 0; bit < clock_enables.size(); ++bit) {
    const std::size_t word = bit / 32;
    const std::uint32_t mask = 1u << bit % 32;
    const bool runs = (wanted[word] & mask) != 0;
    const bool ran = (enabled_[word] & mask) != 0;
    enabled_[word] = runs ? enabled_[word] | mask : enabled_[word] & ~mask;
    if (!gates_[bit] && !runs) report_gate(bit);
    if (gates_[bit] && runs != ran) gates_[bit](runs);
  }
}

void Clocks::report_gate(std::size_t bit) const {
  const ClockEnable& clock = clock_enables[bit];
  const auto& missed = clocks_missed_asleep;
  const bool unseen = asleep_ && std::find(missed.begin(), missed.end(), bit) == missed.end();
  if (unseen || (clock.has_reset && held_(clock.reset))) return;
  not_modelled_("CLOCKS: " + std::string(clock.clock) +
                " is stopped while its block is in use; the block keeps running");
}

void Clocks::write(std::uint32_t offset, std::uint32_t value) {
  if (offset < offset_resus_control) {
    write_generator(offset / generator_bytes, offset % generator_bytes, value);
  } else if (offset == offset_resus_control) {
    write_resus(value);
  } else if (offset >= offset_fc0 && offset <= offset_fc0_source) {
    const std::size_t index = (offset - offset_fc0) / 4;
    counter_[index] = value & fc0_masks[index];
    if (offset == offset_fc0_source) start_counter(counter_[index]);
  } else if (offset >= offset_wake && offset < offset_enabled) {
    write_enables(offset, value);
  } else if (interrupts_.write(offset, value)) {
    update_irq();
  } else if (offset > offset_ints) {
    not_modelled_("CLOCKS: no register at this offset");
  }
}

// --- frequency counter (2.15.6)

std::uint64_t Clocks::counted_hz() const {
  // In the order of FC0_SRC (2.15.7); the two outputs of the ring oscillator are one.
  using enum Source;
  static constexpr std::array<Source, 14> counted{
      nothing, sys_pll, usb_pll, ring, ring, crystal, pin0, pin1, ref, sys, peri, usb, adc, rtc};
  return hz_of(pick(counted, counter_[5]));
}

// The interval is 0.98 us (1 / 1.024 MHz, so that edges are counted in 1024 kHz over the same power
// of two) times a power of two; DELAY are cycles of clk_ref before it.
void Clocks::start_counter(std::uint32_t source) {
  counted_hz_ = source == 0 ? 0 : counted_hz();
  const Picoseconds interval = (ps_per_s << counter_[4]) / fc0_base_hz;
  const std::uint64_t reference = hz(Clock::ref);
  const Picoseconds delay = reference == 0 ? 0
                                           : static_cast<Picoseconds>(counter_[3]) * ps_per_s /
                                                 static_cast<Picoseconds>(reference);
  counter_end_ = wheel_.time() + delay + interval;
}

bool Clocks::counter_done() const { return counter_[5] != 0 && wheel_.time() >= counter_end_; }

/// Kilohertz with five fractional bits, measured relative to the clk_ref that REF_KHZ gives: whole
/// edges in the interval, each of which counts as 1024 kHz over a power of two.
std::uint32_t Clocks::counter_result() const {
  const std::uint64_t reference = hz(Clock::ref);
  if (!counter_done() || reference == 0) return 0;
  const Wide scaled =
      static_cast<Wide>(counted_hz_) * counter_[0] * 32 / static_cast<Wide>(reference);
  const std::uint32_t edge = fc0_edge >> counter_[4];
  return (static_cast<std::uint32_t>(scaled) & 0x3fffffffu) / edge * edge;
}

/// PASS 0, DONE 4, RUNNING 8, WAITING 12, FAIL 16, SLOW 20, FAST 24, DIED 28.
std::uint32_t Clocks::counter_status() const {
  if (counter_[5] == 0) return 0;
  if (!counter_done()) return 1u << 8;
  const std::uint32_t khz = counter_result() >> 5;
  const bool slow = khz < counter_[1];
  const bool fast = khz > counter_[2];
  return 1u << 4 | (slow || fast ? 1u << 16 : 1u) | (slow ? 1u << 20 : 0u) |
         (fast ? 1u << 24 : 0u) | (counted_hz_ == 0 ? 1u << 28 : 0u);
}

}  // namespace lamplock::sim::chip
