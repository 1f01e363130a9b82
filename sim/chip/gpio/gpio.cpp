#include "sim/chip/gpio/gpio.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <string>
#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t all_pins = (1u << gpio_count) - 1;

// Offsets in IO_BANK0 (2.19.6.1).
constexpr std::uint32_t offset_intr = 0x0f0;
constexpr std::uint32_t offset_destinations = 0x100;  // PROC0, PROC1, DORMANT_WAKE
constexpr std::uint32_t destination_bytes = 0x30;     // INTE0-3, INTF0-3, INTS0-3
constexpr std::uint32_t io_end = offset_destinations + 3 * destination_bytes;
// Fields of GPIOn_CTRL: FUNCSEL 4:0, OUTOVER 9:8, OEOVER 13:12, INOVER 17:16, IRQOVER 29:28.
constexpr std::uint32_t control_mask = 0x3003331f;
constexpr std::uint32_t control_reset = 0x1f;
constexpr std::uint32_t function_mask = 0x1f;

// Offsets in PADS_BANK0 (2.19.6.3).
constexpr std::uint32_t offset_gpio0_pad = 0x04;
constexpr std::uint32_t offset_swclk_pad = 0x7c;
constexpr std::uint32_t offset_swd_pad = 0x80;
// Bits of a pad: SLEWFAST 0, SCHMITT 1, PDE 2, PUE 3, DRIVE 5:4, IE 6, OD 7.
constexpr std::uint32_t pad_mask = 0xff;
constexpr std::uint32_t pad_pull_down = 1u << 2;
constexpr std::uint32_t pad_pull_up = 1u << 3;
constexpr std::uint32_t pad_input_enable = 1u << 6;
constexpr std::uint32_t pad_output_disable = 1u << 7;
constexpr std::uint32_t pad_reset = 0x56;
constexpr std::uint32_t swclk_pad_reset = 0xda;
constexpr std::uint32_t swd_pad_reset = 0x5a;

constexpr unsigned pins_per_word = 8;  // in INTR, INTE, INTF, INTS

void assign_bit(std::uint32_t& word, unsigned bit, bool level) {
  word = level ? word | 1u << bit : word & ~(1u << bit);
}

/// One of the four registers with four bits for each of eight pins.
std::uint32_t pack(const std::array<std::uint32_t, 4>& events, unsigned word) {
  std::uint32_t packed = 0;
  for (unsigned pin = 0; pin < pins_per_word; ++pin)
    for (unsigned event = 0; event < 4; ++event)
      packed |= (events[event] >> (word * pins_per_word + pin) & 1u) << (4 * pin + event);
  return packed;
}

void unpack(std::array<std::uint32_t, 4>& events, unsigned word, std::uint32_t packed) {
  for (unsigned pin = 0; pin < pins_per_word; ++pin) {
    const unsigned gpio = word * pins_per_word + pin;
    if (gpio >= gpio_count) return;
    for (unsigned event = 0; event < 4; ++event)
      assign_bit(events[event], gpio, (packed >> (4 * pin + event) & 1u) != 0);
  }
}

}  // namespace

void Gpio::Override::set(unsigned gpio, std::uint32_t field) {
  assign_bit(invert, gpio, (field & 3u) == 1);
  assign_bit(low, gpio, (field & 3u) == 2);
  assign_bit(high, gpio, (field & 3u) == 3);
}

Gpio::Gpio(TimeWheel& wheel, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel), slot_(wheel.add(*this)), irqs_(irqs), not_modelled_(std::move(not_modelled)) {
  io_bank_.reset();
  pads_bank_.reset();
}

void Gpio::set_external(unsigned gpio, External level, Cycle at) {
  const std::uint32_t bit = 1u << gpio;
  const std::uint32_t driven = level == External::low || level == External::high ? bit : 0;
  const std::uint32_t high = level == External::high ? bit : 0;
  const std::uint32_t up = level == External::pulled_up ? bit : 0;
  if ((external_driven_ & bit) == driven && (external_high_ & bit) == high &&
      (external_pull_up_ & bit) == up)
    return;
  catch_up(at);
  external_driven_ = (external_driven_ & ~bit) | driven;
  external_high_ = (external_high_ & ~bit) | high;
  external_pull_up_ = (external_pull_up_ & ~bit) | up;
  update(at);
}

// Levels from the peripherals through overrides and pads to the inputs. A pad that is driven from
// both sides shows what the chip drives.
void Gpio::update(Cycle at) {
  const std::uint32_t out = out_override_.apply(out_from_peripheral_);
  const std::uint32_t driven = enable_override_.apply(enable_from_peripheral_) & ~output_disable_;
  driven_ = driven;
  // Neither pull: the charge of the pin; both: the bus keeper (2.19.4).
  const std::uint32_t keeps = ~(pull_up_ ^ pull_down_);
  const std::uint32_t pulled = (pull_up_ & ~pull_down_) | (keeps & pads_) | external_pull_up_;
  const std::uint32_t outside = external_high_ | (~external_driven_ & pulled);
  const std::uint32_t before = pads_;
  pads_ = ((driven & out) | (~driven & outside)) & all_pins;
  if (!wires_.empty()) level_wires(out, before);
  report_contention(driven & external_driven_ & (out ^ external_high_));

  const std::uint32_t from_pad = pads_ & input_enable_;
  inputs_ = input_override_.apply(from_pad) & all_pins;
  record(at, interrupt_override_.apply(from_pad) & all_pins);
  report(at);
}

void Gpio::join(unsigned one, unsigned other, Cycle at) {
  std::uint32_t wire = 1u << one | 1u << other;
  std::erase_if(wires_, [&wire](std::uint32_t each) {
    const bool meets = (each & wire) != 0;
    if (meets) wire |= each;
    return meets;
  });
  wires_.push_back(wire);
  catch_up(at);
  update(at);
}

// Joined pins have the level that one of them is driven to (of two, the low one: open drain), else
// that of their pulls; where these disagree or there are none, they keep their level.
void Gpio::level_wires(std::uint32_t out, std::uint32_t before) {
  driven_over_wires_ = 0;
  for (const std::uint32_t wire : wires_) {
    const std::uint32_t inside = driven_ & wire, outside = external_driven_ & wire;
    const bool low = ((inside & ~out) | (outside & ~external_high_)) != 0;
    const bool high = ((inside & out) | (outside & external_high_)) != 0;
    const bool up = (wire & pull_up_ & ~pull_down_) != 0,
               down = (wire & pull_down_ & ~pull_up_) != 0;
    bool level = (before & wire) == wire;
    if (low || high) {
      level = !low;
      driven_over_wires_ |= wire;
    } else if (up != down) {
      level = up;
    }
    if (low && high) report_contention(wire & (inside | outside));
    pads_ = level ? pads_ | wire : pads_ & ~wire;
  }
}

void Gpio::report_contention(std::uint32_t pins) {
  pins &= ~contention_reported_;
  contention_reported_ |= pins;
  for (; pins != 0; pins &= pins - 1)
    not_modelled_("GPIO" + std::to_string(std::countr_zero(pins)) +
                  ": the chip and the outside drive it to different levels");
}

void Gpio::report(Cycle at) {
  // A listener may change pins in turn: each change is recorded as reported before the call.
  while (const std::uint32_t changed = pads_ ^ pads_reported_) {
    const auto gpio = static_cast<unsigned>(std::countr_zero(changed));
    pads_reported_ ^= 1u << gpio;
    const bool level = (pads_reported_ >> gpio & 1u) != 0;
    for (PadListener* listener : pad_listeners_) listener->pad_changed(gpio, level, at);
  }
  if (inputs_told_ == inputs_) return;
  const std::uint32_t changed = std::exchange(inputs_told_, inputs_) ^ inputs_;
  for (InputListener* listener : input_listeners_) listener->inputs_changed(at);
  for (const OfFunction& each : function_listeners_)
    if ((changed & selected(each.function)) != 0) each.listener->inputs_changed(at);
}

void Gpio::report_connections(Cycle at) {
  for (InputListener* listener : input_listeners_) listener->connections_changed(at);
  for (const OfFunction& each : function_listeners_) each.listener->connections_changed(at);
}

// Records a change for the synchronisers. A source that is updated in batches may be earlier than
// the newest change of another one; its change then counts as of that one.
void Gpio::record(Cycle at, std::uint32_t interrupt_inputs) {
  const Change last = history_[history_last_];
  if (last.inputs == inputs_ && last.interrupt_inputs == interrupt_inputs) return;
  at = std::max(at, last.at);
  if (at != last.at) {
    synchronise(at);
    history_last_ = (history_last_ + 1) % history_size;
    ++unsynchronised_;
  } else if (unsynchronised_ == 0) {
    unsynchronised_ = 1;  // a second change in a cycle that has been dealt with
  }
  history_[history_last_] = {at, inputs_, interrupt_inputs};
  schedule();
}

std::uint32_t Gpio::inputs_at(Cycle at) const {
  std::size_t index = history_last_;
  for (std::size_t n = 1; n < history_size && history_[index].at > at; ++n)
    index = (index + history_size - 1) % history_size;
  return history_[index].inputs;
}

// Moves changes that are old enough through the synchroniser into the edge detectors.
void Gpio::synchronise(Cycle to) {
  while (unsynchronised_ != 0) {
    const Change& change =
        history_[(history_last_ + history_size + 1 - unsynchronised_) % history_size];
    if (change.at + pin_synchroniser > to) return;
    const std::uint32_t changed = synchronised_ ^ change.interrupt_inputs;
    synchronised_ = change.interrupt_inputs;
    edges_high_ |= changed & synchronised_;
    edges_low_ |= changed & ~synchronised_;
    --unsynchronised_;
  }
}

// Only a pin with an interrupt enabled needs an event; the others are synchronised when read.
void Gpio::schedule() {
  if (unsynchronised_ == 0 || due_ != never_cycle) return;
  const Change& oldest =
      history_[(history_last_ + history_size + 1 - unsynchronised_) % history_size];
  const Change& newest = history_[history_last_];
  const std::uint32_t changes =
      (synchronised_ ^ oldest.interrupt_inputs) | (synchronised_ ^ newest.interrupt_inputs);
  if ((changes & watched_) == 0 && unsynchronised_ < 3) return;
  due_ = oldest.at + pin_synchroniser;
  wheel_.set(slot_, due_);
}

void Gpio::run(Cycle) {
  due_ = never_cycle;
  synchronise(wheel_.now());
  update_irq_lines();
  schedule();
}

Gpio::Events Gpio::raw_events() const {
  return {~synchronised_ & all_pins, synchronised_, edges_low_, edges_high_};
}

Gpio::Events Gpio::masked_events(const Destination& destination) const {
  Events events = raw_events();
  for (std::size_t event = 0; event < events.size(); ++event)
    events[event] = (events[event] & destination.enable[event]) | destination.force[event];
  return events;
}

void Gpio::update_irq_lines() {
  for (int core = 0; core < 2; ++core) {
    const Events events = masked_events(destinations_[static_cast<std::size_t>(core)]);
    irqs_.set_for_core(core, Irq::io_bank0, (events[0] | events[1] | events[2] | events[3]) != 0);
  }
}

std::uint32_t Gpio::status(unsigned gpio) const {
  const auto bit = [gpio](std::uint32_t word) { return word >> gpio & 1u; };
  const std::uint32_t from_pad = pads_ & input_enable_;
  return bit(out_from_peripheral_) << 8 | bit(out_override_.apply(out_from_peripheral_)) << 9 |
         bit(enable_from_peripheral_) << 12 |
         bit(enable_override_.apply(enable_from_peripheral_)) << 13 | bit(from_pad) << 17 |
         bit(inputs_) << 19 | bit(from_pad) << 24 | bit(interrupt_override_.apply(from_pad)) << 26;
}

std::uint32_t Gpio::io_register(std::uint32_t offset) const {
  if (offset < 8 * gpio_count) {
    const unsigned gpio = offset / 8;
    return (offset & 4u) != 0 ? control_[gpio] : status(gpio);
  }
  if (offset >= io_end || offset < offset_intr) return 0;
  const unsigned word = offset / 4 % 4;
  if (offset < offset_destinations) return pack(raw_events(), word);
  const Destination& destination =
      destinations_[(offset - offset_destinations) / destination_bytes];
  switch ((offset - offset_destinations) % destination_bytes / 16) {
    case 0:
      return pack(destination.enable, word);
    case 1:
      return pack(destination.force, word);
    default:
      return pack(masked_events(destination), word);
  }
}

std::uint32_t Gpio::IoBank::read(std::uint32_t offset) {
  if (offset >= io_end) gpio_.not_modelled_("IO_BANK0: no register at this offset");
  return peek(offset);
}

std::uint32_t Gpio::IoBank::peek(std::uint32_t offset) const {
  const Cycle now = gpio_.wheel_.now();
  gpio_.catch_up(now);
  gpio_.synchronise(now);
  return gpio_.io_register(offset);
}

void Gpio::IoBank::write(std::uint32_t offset, std::uint32_t value) {
  const Cycle now = gpio_.wheel_.now();
  gpio_.catch_up(now);
  gpio_.synchronise(now);
  if (offset < 8 * gpio_count) {
    if ((offset & 4u) == 0) return;  // STATUS
    const bool reconnects = ((gpio_.control_[offset / 8] ^ value) & function_mask) != 0;
    if (reconnects)
      for (const OfFunction& each : gpio_.function_listeners_)
        each.listener->connections_changing(now);
    gpio_.write_control(offset / 8, value & control_mask);
    gpio_.update(now);
    if (reconnects) gpio_.report_connections(now);
    return;
  }
  if (offset >= io_end) {
    gpio_.not_modelled_("IO_BANK0: no register at this offset");
    return;
  }
  const unsigned word = offset / 4 % 4;
  if (offset < offset_destinations) {  // INTR: edges are cleared by ones
    Events clear{};
    unpack(clear, word, value);
    gpio_.edges_low_ &= ~clear[edge_low];
    gpio_.edges_high_ &= ~clear[edge_high];
  } else {
    Destination& destination =
        gpio_.destinations_[(offset - offset_destinations) / destination_bytes];
    const std::uint32_t bank = (offset - offset_destinations) % destination_bytes / 16;
    if (bank == 0) unpack(destination.enable, word, value);
    if (bank == 1) unpack(destination.force, word, value);
    gpio_.watched_ = 0;
    for (const Destination& any : gpio_.destinations_)
      for (const std::uint32_t pins : any.enable) gpio_.watched_ |= pins;
    gpio_.schedule();
  }
  gpio_.update_irq_lines();
}

// The edges in INTR0-3.
std::uint32_t Gpio::IoBank::write_clear_bits(std::uint32_t offset) const {
  return offset >= offset_intr && offset < offset_destinations ? 0xcccc'ccccu : 0;
}

void Gpio::IoBank::reset() {
  for (unsigned gpio = 0; gpio < gpio_count; ++gpio) gpio_.write_control(gpio, control_reset);
  gpio_.destinations_ = {};
  gpio_.watched_ = 0;
  const Cycle now = gpio_.wheel_.now();
  gpio_.update(now);
  gpio_.report_connections(now);
  gpio_.synchronise(now);
  gpio_.edges_low_ = 0;
  gpio_.edges_high_ = 0;
  gpio_.update_irq_lines();
}

void Gpio::write_control(unsigned gpio, std::uint32_t value) {
  const std::uint32_t bit = 1u << gpio;
  sources_[control_[gpio] & function_mask].selected &= ~bit;
  control_[gpio] = value;
  Source& source = sources_[value & function_mask];
  source.selected |= bit;
  take_outputs(source, bit);
  out_override_.set(gpio, value >> 8);
  enable_override_.set(gpio, value >> 12);
  input_override_.set(gpio, value >> 16);
  interrupt_override_.set(gpio, value >> 28);
}

std::uint32_t Gpio::PadsBank::peek(std::uint32_t offset) const {
  if (offset == 0) return gpio_.voltage_select_;
  if (offset < offset_swclk_pad) return gpio_.pad_control_[(offset - offset_gpio0_pad) / 4];
  if (offset == offset_swclk_pad) return gpio_.swclk_pad_;
  if (offset == offset_swd_pad) return gpio_.swd_pad_;
  return 0;
}

std::uint32_t Gpio::PadsBank::read(std::uint32_t offset) {
  if (offset > offset_swd_pad) gpio_.not_modelled_("PADS_BANK0: no register at this offset");
  return peek(offset);
}

// Drive strength, slew rate, Schmitt trigger, the voltage and the debug pins have no effect on
// levels: they are kept.
void Gpio::PadsBank::write(std::uint32_t offset, std::uint32_t value) {
  const Cycle now = gpio_.wheel_.now();
  if (offset == 0) {
    gpio_.voltage_select_ = value & 1u;
  } else if (offset < offset_swclk_pad) {
    gpio_.catch_up(now);
    gpio_.write_pad((offset - offset_gpio0_pad) / 4, value & pad_mask);
    gpio_.update(now);
  } else if (offset == offset_swclk_pad) {
    gpio_.swclk_pad_ = value & pad_mask;
  } else if (offset == offset_swd_pad) {
    gpio_.swd_pad_ = value & pad_mask;
  } else {
    gpio_.not_modelled_("PADS_BANK0: no register at this offset");
  }
}

void Gpio::PadsBank::reset() {
  gpio_.voltage_select_ = 0;
  gpio_.swclk_pad_ = swclk_pad_reset;
  gpio_.swd_pad_ = swd_pad_reset;
  for (unsigned gpio = 0; gpio < gpio_count; ++gpio) gpio_.write_pad(gpio, pad_reset);
  gpio_.update(gpio_.wheel_.now());
}

void Gpio::write_pad(unsigned gpio, std::uint32_t value) {
  pad_control_[gpio] = value;
  assign_bit(pull_down_, gpio, (value & pad_pull_down) != 0);
  assign_bit(pull_up_, gpio, (value & pad_pull_up) != 0);
  assign_bit(input_enable_, gpio, (value & pad_input_enable) != 0);
  assign_bit(output_disable_, gpio, (value & pad_output_disable) != 0);
}

}  // namespace lamplock::sim::chip
