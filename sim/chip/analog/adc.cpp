#include "sim/chip/analog/adc.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets (4.9.6).
constexpr std::uint32_t offset_cs = 0x00;
constexpr std::uint32_t offset_result = 0x04;
constexpr std::uint32_t offset_fcs = 0x08;
constexpr std::uint32_t offset_fifo = 0x0c;
constexpr std::uint32_t offset_div = 0x10;
constexpr std::uint32_t offset_intr = 0x14;
constexpr std::uint32_t offset_ints = 0x20;

// CS.
constexpr std::uint32_t cs_enable = 1u << 0;
constexpr std::uint32_t cs_sensor = 1u << 1;
constexpr std::uint32_t cs_start_once = 1u << 2;
constexpr std::uint32_t cs_start_many = 1u << 3;
constexpr std::uint32_t cs_ready = 1u << 8;
constexpr std::uint32_t cs_error = 1u << 9;
constexpr std::uint32_t cs_error_sticky = 1u << 10;
constexpr std::uint32_t cs_input_mask = 7u << 12;
constexpr std::uint32_t cs_round_mask = 0x1fu << 16;
constexpr std::uint32_t cs_kept = 0x001f700b;  // RROBIN, AINSEL, START_MANY, TS_EN, EN
// FCS.
constexpr std::uint32_t fcs_enable = 1u << 0;
constexpr std::uint32_t fcs_shift = 1u << 1;
constexpr std::uint32_t fcs_error = 1u << 2;
constexpr std::uint32_t fcs_dreq = 1u << 3;
constexpr std::uint32_t fcs_empty = 1u << 8;
constexpr std::uint32_t fcs_full = 1u << 9;
constexpr std::uint32_t fcs_under = 1u << 10;
constexpr std::uint32_t fcs_over = 1u << 11;
constexpr std::uint32_t fcs_kept = 0x0f00000f;  // THRESH, DREQ_EN, ERR, SHIFT, EN
constexpr std::uint32_t fifo_error = 1u << 15;
constexpr std::uint32_t interrupt_fifo = 1u << 0;
constexpr std::uint32_t divider_mask = 0xffffff;

constexpr double max_code = 4095;
constexpr double codes = 4096;
/// Any round robin of one to five inputs is back at its start after this many conversions.
constexpr std::uint64_t common_round = 60;

}  // namespace

Adc::Adc(TimeWheel& wheel, Clocks& clocks, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      clocks_(clocks),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      interrupts_(offset_intr, interrupt_fifo) {
  clocks_.listen(*this);
  counter_.set_frequency(clock_hz(), wheel_.time());
  set_temperature(27);
  reset();
}

void Adc::reset() {
  control_ = fifo_control_ = divider_ = 0;
  interrupts_.reset();
  converting_ = sample_failed_ = failed_ = ever_failed_ = false;
  result_ = 0;
  fifo_level_ = 0;
  overflowed_ = underflowed_ = false;
  schedule();
  update_lines();
}

void Adc::set_input(unsigned input, double volts) {
  advance();
  volts_.at(input) = volts;
}

void Adc::set_temperature(double celsius) {
  set_input(temperature_input, 0.706 - (celsius - 27) * 0.001721);
}

// --- conversions

/// Period of the triggers of START_MANY, in 256ths of a cycle: 1 + INT + FRAC / 256, and not less
/// than a conversion; 0 in DIV means one after the other (4.9.2.4).
std::uint64_t Adc::period() const {
  constexpr std::uint64_t shortest = conversion_cycles << 8;
  return divider_ == 0 ? shortest : std::max<std::uint64_t>(shortest, divider_ + 256u);
}

std::uint64_t Adc::trigger(std::uint64_t number) const {
  return origin_ + (number * period() >> 8);
}

/// Brings conversions up to date: each end and each start until now, in order.
void Adc::advance() {
  if (!on(cs_enable) || counter_.hz() == 0) return;
  const std::uint64_t cycles = counter_.cycles(wheel_.time());
  skip_unseen(cycles);
  for (;;) {
    if (converting_) {
      if (cycles < started_ + conversion_cycles) return;
      finish();
    } else {
      if (!on(cs_start_many) || cycles < trigger(triggers_)) return;
      start(trigger(triggers_++));
    }
  }
}

// If no result of a conversion is kept, whole rounds of them change nothing.
void Adc::skip_unseen(std::uint64_t cycles) {
  const bool kept = (fifo_control_ & fcs_enable) != 0 && fifo_level_ < fifo_depth;
  if (!converting_ || !on(cs_start_many) || kept || fail_next_ || sample_failed_) return;
  if (cycles < started_) return;
  const std::uint64_t rounds = ((cycles - started_) << 8) / period() / common_round;
  if (rounds < 2) return;
  const std::uint64_t skipped = (rounds - 1) * common_round;
  finish();  // AINSEL is one of RROBIN from here on
  triggers_ += skipped;
  start(trigger(triggers_++));
}

void Adc::start(std::uint64_t cycle) {
  converting_ = true;
  started_ = cycle;
  sample_ = convert(selected_input());
  sample_failed_ = std::exchange(fail_next_, false);
}

std::uint32_t Adc::convert(std::uint32_t input) {
  if (input > temperature_input) {
    not_modelled_("ADC CS AINSEL: an input that does not exist was converted");
    return 0;
  }
  if (input == temperature_input && !on(cs_sensor)) {
    not_modelled_("ADC: the temperature sensor was converted without power (CS TS_EN)");
    return 0;
  }
  const double code = std::floor(volts_[input] / reference_volts * codes);
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, max_code));
}

void Adc::finish() {
  converting_ = false;
  result_ = sample_;
  failed_ = sample_failed_;
  ever_failed_ = ever_failed_ || failed_;
  if ((fifo_control_ & fcs_enable) != 0) push(result_);
  select_next_input();
}

void Adc::select_next_input() {
  const std::uint32_t round = control_ >> 16 & 0x1fu;
  if (round == 0) return;
  std::uint32_t input = selected_input();
  do input = input >= temperature_input ? 0 : input + 1;
  while ((round >> input & 1u) == 0);
  control_ = (control_ & ~cs_input_mask) | input << 12;
}

// --- FIFO

void Adc::push(std::uint32_t result) {
  if (fifo_level_ == fifo_depth) {
    overflowed_ = true;
    return;
  }
  if ((fifo_control_ & fcs_shift) != 0) result >>= 4;
  if ((fifo_control_ & fcs_error) != 0 && failed_) result |= fifo_error;
  fifo_[fifo_level_++] = result;
}

std::uint32_t Adc::pop() {
  if (fifo_level_ == 0) {
    underflowed_ = true;
    return 0;
  }
  const std::uint32_t result = fifo_[0];
  std::rotate(fifo_.begin(), fifo_.begin() + 1, fifo_.end());
  --fifo_level_;
  return result;
}

bool Adc::fifo_triggers() const { return fifo_level_ >= (fifo_control_ >> 24 & 0xfu); }

std::uint32_t Adc::raised() const { return fifo_triggers() ? interrupt_fifo : 0; }

// --- time

void Adc::run(Cycle) {
  advance();
  update_lines();
  schedule();
}

void Adc::set_clock(bool runs) {
  stopped_ = !runs;
  clocks_changed();
}

void Adc::clocks_changed() {
  if (counter_.hz() == clock_hz()) return;
  advance();
  counter_.set_frequency(clock_hz(), wheel_.time());
  update_lines();
  schedule();
}

void Adc::schedule() {
  const bool fifo_awaited = (fifo_control_ & fcs_enable) != 0 &&
                            (interrupts_.enabled() != 0 || (fifo_control_ & fcs_dreq) != 0);
  // An alias writes AINSEL back as peek() returned it, so round robins are kept up to date.
  const bool awaited = fifo_awaited || (control_ & cs_round_mask) != 0;
  Picoseconds end = never;
  if (awaited && on(cs_enable) && converting_)
    end = counter_.time_of(started_ + conversion_cycles);
  else if (awaited && on(cs_enable) && on(cs_start_many))
    end = counter_.time_of(trigger(triggers_));
  wheel_.set(slot_, wheel_.cycle_at(end));
}

void Adc::update_lines() {
  irqs_.set(Irq::adc_fifo, interrupts_.status(raised()) != 0);
  const bool requests = (fifo_control_ & fcs_dreq) != 0 && fifo_triggers();
  if (dreqs_ != nullptr) dreqs_->set_level(Dreq::adc, requests ? fifo_level_ : 0);
}

// --- registers

std::uint32_t Adc::status() const {
  return control_ | (on(cs_enable) && !converting_ ? cs_ready : 0u) | (failed_ ? cs_error : 0u) |
         (ever_failed_ ? cs_error_sticky : 0u);
}

std::uint32_t Adc::fifo_status() const {
  return fifo_control_ | fifo_level_ << 16 | (fifo_level_ == 0 ? fcs_empty : 0u) |
         (fifo_level_ == fifo_depth ? fcs_full : 0u) | (underflowed_ ? fcs_under : 0u) |
         (overflowed_ ? fcs_over : 0u);
}

std::uint32_t Adc::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_cs:
      return status();
    case offset_result:
      return result_;
    case offset_fcs:
      return fifo_status();
    case offset_fifo:
      return fifo_level_ == 0 ? 0 : fifo_[0];
    case offset_div:
      return divider_;
    default:
      return interrupts_.read(offset, raised());
  }
}

std::uint32_t Adc::read(std::uint32_t offset) {
  if (offset > offset_ints) not_modelled_("ADC: no register at this offset");
  advance();
  const std::uint32_t value = offset == offset_fifo ? pop() : peek(offset);
  update_lines();
  schedule();
  return value;
}

std::uint32_t Adc::write_clear_bits(std::uint32_t offset) const {
  if (offset == offset_cs) return cs_error_sticky;
  return offset == offset_fcs ? fcs_over | fcs_under : 0;
}

void Adc::write_control(std::uint32_t value) {
  if ((value & cs_error_sticky) != 0) ever_failed_ = false;
  const bool was_many = on(cs_start_many) && on(cs_enable);
  control_ = value & cs_kept;
  if (!on(cs_enable)) {
    converting_ = false;
    return;
  }
  const std::uint64_t edge = counter_.next_edge(wheel_.time());
  if (on(cs_start_many)) {
    if (was_many) return;
    origin_ = converting_ ? started_ + conversion_cycles : edge;
    triggers_ = 0;
  } else if ((value & cs_start_once) != 0 && !converting_) {
    start(edge);
  }
}

// Writing resets the divider: the next trigger is a whole period later.
void Adc::write_divider(std::uint32_t value) {
  divider_ = value & divider_mask;
  if (!on(cs_enable) || !on(cs_start_many)) return;
  const std::uint64_t edge = counter_.next_edge(wheel_.time());
  origin_ = divider_ == 0 && converting_ ? started_ + conversion_cycles : edge;
  triggers_ = divider_ == 0 ? 0 : 1;
}

void Adc::write(std::uint32_t offset, std::uint32_t value) {
  advance();
  switch (offset) {
    case offset_cs:
      write_control(value);
      break;
    case offset_fcs:
      if ((value & fcs_under) != 0) underflowed_ = false;
      if ((value & fcs_over) != 0) overflowed_ = false;
      fifo_control_ = value & fcs_kept;
      if ((fifo_control_ & fcs_dreq) != 0 && (fifo_control_ >> 24 & 0xfu) == 0)
        not_modelled_("ADC FCS: DREQ_EN with THRESH 0 requests only words in the FIFO");
      break;
    case offset_div:
      write_divider(value);
      break;
    case offset_result:
    case offset_fifo:
      break;
    default:
      if (!interrupts_.write(offset, value)) not_modelled_("ADC: no register at this offset");
  }
  advance();
  update_lines();
  schedule();
}

}  // namespace lamplock::sim::chip
