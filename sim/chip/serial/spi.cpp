#include "sim/chip/serial/spi.hpp"

#include <algorithm>
#include <utility>

#include "sim/chip/fabric/wide.hpp"

namespace lamplock::sim::chip {

namespace {

// Offsets (4.4.4).
constexpr std::uint32_t offset_cr0 = 0x00;
constexpr std::uint32_t offset_cr1 = 0x04;
constexpr std::uint32_t offset_dr = 0x08;
constexpr std::uint32_t offset_sr = 0x0c;
constexpr std::uint32_t offset_cpsr = 0x10;
constexpr std::uint32_t offset_imsc = 0x14;
constexpr std::uint32_t offset_icr = 0x20;
constexpr std::uint32_t offset_dmacr = 0x24;

// CR0: DSS 3:0, FRF 5:4, SPO 6, SPH 7, SCR 15:8.
constexpr std::uint32_t cr0_format = 3u << 4;
constexpr std::uint32_t cr0_polarity = 1u << 6;
constexpr std::uint32_t cr0_phase = 1u << 7;
constexpr std::uint32_t min_data_size = 3;  // four bits
// CR1: SSE 1, MS 2.
constexpr std::uint32_t cr1_loop_back = 1u << 0;
constexpr std::uint32_t cr1_slave_output_off = 1u << 3;
// SR.
constexpr std::uint32_t flag_tx_empty = 1u << 0;
constexpr std::uint32_t flag_tx_not_full = 1u << 1;
constexpr std::uint32_t flag_rx_not_empty = 1u << 2;
constexpr std::uint32_t flag_rx_full = 1u << 3;
constexpr std::uint32_t flag_busy = 1u << 4;
// RIS, MIS, IMSC, ICR.
constexpr std::uint32_t irq_overrun = 1u << 0;
constexpr std::uint32_t irq_timeout = 1u << 1;
constexpr std::uint32_t irq_rx = 1u << 2;
constexpr std::uint32_t irq_tx = 1u << 3;
constexpr std::uint32_t irq_mask = 0xf;
constexpr std::uint32_t irq_clearable = irq_overrun | irq_timeout;
constexpr std::uint32_t part_number = 0x22;  // PL022

constexpr std::size_t half_fifo = 4;             // both interrupts (4.4.3.4)
constexpr std::uint64_t timeout_half_bits = 64;  // "fixed 32-bit period" (4.4.3.4)
constexpr std::uint64_t deselect_half_bits = 2;  // chip select high after the last capture

}  // namespace

Spi::Spi(int number, TimeWheel& wheel, Clocks& clocks, FunctionPins& pins, IrqLines& irqs,
         NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      clocks_(clocks),
      pins_(pins),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      name_("SPI" + std::to_string(number)),
      irq_(number == 0 ? Irq::spi0 : Irq::spi1),
      first_signal_(number == 0 ? 0 : 4),
      cell_(offset_imsc, irq_mask, part_number),
      requests_(number == 0 ? Dreq::spi0_tx : Dreq::spi1_tx,
                number == 0 ? Dreq::spi0_rx : Dreq::spi1_rx) {
  clocks_.listen(*this);
  pins_.listen(*this);
  for (const Signal of : {signal_select, signal_clock}) pins_.sense(signal(of));
  reset();
}

void Spi::reset() {
  transmit_.clear();
  receive_.clear();
  shifting_ = frame_open_ = timeout_running_ = false;
  free_at_ = 0;
  control_0_ = control_1_ = prescale_ = 0;
  raised_ = 0;
  cell_.reset();
  requests_.set_control(0);
  tx_ = false;
  follower_.deselect();
  put_wires(wheel_.now());
  schedule();
  update_lines();
}

// --- time

Picoseconds Spi::half_bits(std::uint64_t count) const {
  const std::uint64_t hz = clocks_.hz(Clock::peri);
  if (hz == 0) return 0;
  const std::uint64_t cycles = count * (prescale_ / 2) * (1 + (control_0_ >> 8));
  return static_cast<Picoseconds>(static_cast<Wide>(cycles) * ps_per_s / static_cast<Wide>(hz));
}

Picoseconds Spi::bit_time() const { return half_bits(2); }

void Spi::schedule() {
  if (stopped_) return wheel_.set(slot_, never_cycle);
  Picoseconds first = never;
  if (shifting_) first = std::min(first, captured_at_);
  if (on_wires() && wires_are_seen()) first = std::min(first, word_start_ + half_bits(half_ + 1));
  if (frame_open_ && !shifting_) first = std::min(first, frame_end_at_);
  if (!shifting_ && wants_to_send() && bit_time() != 0) first = std::min(first, free_at_);
  if (timeout_running_) first = std::min(first, timeout_at_);
  wheel_.set(slot_, wheel_.cycle_at(first));
}

void Spi::set_clock(bool runs) {
  if (runs != stopped_) return;
  if (!runs) shift_wires(wheel_.now());
  stopped_ = !runs;
  if (stopped_) {
    stopped_at_ = wheel_.time();
    return schedule();
  }
  const Picoseconds still = wheel_.time() - stopped_at_;
  for (Picoseconds* at : {&word_start_, &captured_at_, &frame_end_at_, &timeout_at_, &free_at_})
    *at += still;
  if (slave()) follow_master();
  begin();
  put_wires(wheel_.now());
  update_lines();
  schedule();
}

void Spi::run(Cycle) {
  const Picoseconds time = wheel_.time();
  shift_wires(wheel_.now());
  if (shifting_ && captured_at_ <= time) exchange();
  if (frame_open_ && !shifting_ && frame_end_at_ <= time) {
    frame_open_ = false;
    put_wires(wheel_.now());
  }
  if (!shifting_ && wants_to_send() && free_at_ <= time) start_word(free_at_);
  if (timeout_running_ && timeout_at_ <= time) {
    timeout_running_ = false;
    raised_ |= irq_timeout;
  }
  update_lines();
  schedule();
}

void Spi::clocks_changed() {
  begin();
  schedule();
}

// --- master

bool Spi::wants_to_send() const { return enabled() && !slave() && !transmit_.empty(); }

/// A word may have become ready to send.
void Spi::begin() {
  if (stopped_ || shifting_ || !wants_to_send() || free_at_ > wheel_.time()) return;
  start_word(wheel_.time());
}

void Spi::start_word(Picoseconds at) {
  if (bit_time() == 0) return not_modelled_(name_ + ": a word was to be sent without a clock");
  shift_ = transmit_.front();
  transmit_.pop_front();
  shifting_ = frame_open_ = true;
  timeout_running_ = false;
  captured_at_ = at + half_bits(2 * word_bits());
  shape_ = {word_bits(), (control_0_ & cr0_polarity) != 0, (control_0_ & cr0_phase) != 0};
  half_ = 0;
  word_start_ = at;
  sampled_ = 0;
  sampling_ = pins_.connected(signal(signal_rx));
  put_wires(wheel_.now());
}

// --- pins

/// True if the wires are on pins, or RX is sampled bit by bit.
bool Spi::wires_are_seen() const {
  return sampling_ || pins_.connected(signal(signal_clock)) || pins_.connected(signal(signal_tx));
}

/// Shifts half bits that have passed by `at`. RX is sampled before SCK moves.
void Spi::shift_wires(Cycle at) {
  if (stopped_ || !on_wires()) return;
  const Picoseconds time = wheel_.time_of(at);
  const unsigned before = half_;
  while (half_ < shape_.last_half() && word_start_ + half_bits(half_ + 1) <= time) {
    ++half_;
    if (!shape_.captures(half_) || !sampling_) continue;
    pins_.bring_sources_up_to(at);
    sampled_ =
        static_cast<std::uint16_t>(sampled_ * 2u + (pins_.input(signal(signal_rx)) ? 1u : 0u));
  }
  if (half_ != before) put_wires(at);
}

/// When idle, TX is low and of high impedance, and CSn high; a slave drives TX only (4.4.3.10).
void Spi::put_wires(Cycle at) {
  const bool idle_clock = (control_0_ & cr0_polarity) != 0;
  const bool master = !slave();
  if (!frame_open_)
    tx_ = false;
  else if (half_ != 0)
    tx_ = shape_.tx(shift_, half_);
  pins_.put(signal(signal_select), !frame_open_, master, at);
  pins_.put(signal(signal_clock), frame_open_ ? shape_.sck(half_) : idle_clock, master, at);
  const bool answers =
      enabled() && follower_.selected() && (control_1_ & cr1_slave_output_off) == 0;
  pins_.put(signal(signal_tx), master ? tx_ : answers && follower_.tx(),
            master ? frame_open_ : answers, at);
}

void Spi::pins_changed(Cycle at) {
  if (slave() && !stopped_) {
    follow_master();
    put_wires(at);
    update_lines();
  }
  schedule();
}

void Spi::pins_connecting(Cycle at) {
  if (!wires_are_seen()) shift_wires(at);
}

/// As a slave: edges of CSn and SCK. Without a pin, CSn is taken as high (assumed).
void Spi::follow_master() {
  const unsigned select = signal(signal_select);
  const bool selected = enabled() && pins_.connected(select) && !pins_.input(select);
  if (!selected) return follower_.deselect();
  if (!follower_.selected()) {
    follower_.select(
        {word_bits(), (control_0_ & cr0_polarity) != 0, (control_0_ & cr0_phase) != 0});
    if ((control_0_ & cr0_phase) == 0) take_word_to_answer();
  }
  const bool first_bit = follower_.wants_word();
  const auto word =
      follower_.clock(pins_.input(signal(signal_clock)), pins_.input(signal(signal_rx)));
  if (word) push_received(*word);
  // With SPH 1 the first edge of a word loads the word to be sent.
  if (first_bit && !follower_.wants_word() && (control_0_ & cr0_phase) != 0) take_word_to_answer();
}

/// With an empty FIFO zeroes are sent (assumed).
void Spi::take_word_to_answer() {
  follower_.send(transmit_.empty() ? std::uint16_t{0} : transmit_.front());
  if (!transmit_.empty()) transmit_.pop_front();
}

/// The last bit has been captured at both ends.
void Spi::exchange() {
  shifting_ = false;
  const auto sent = static_cast<std::uint16_t>(shift_ & word_mask());
  std::uint16_t received = 0;
  if ((control_1_ & cr1_loop_back) != 0)
    received = sent;
  else if (device_ != nullptr)
    received = device_->word_exchanged(sent, word_bits(), wheel_.now());
  else if (sampling_)
    received = sampled_;
  push_received(static_cast<std::uint16_t>(received & word_mask()));
  frame_end_at_ = captured_at_ + half_bits(deselect_half_bits);
  if ((control_0_ & cr0_phase) == 0)
    free_at_ = captured_at_ + half_bits(gap_half_bits);
  else
    free_at_ = wants_to_send() ? captured_at_ : frame_end_at_;
}

// --- receiver

void Spi::push_received(std::uint16_t word) {
  if (receive_.size() >= fifo_depth)
    raised_ |= irq_overrun;
  else
    receive_.push_back(word);
  restart_timeout();
}

std::uint32_t Spi::pop_received() {
  if (receive_.empty()) {
    not_modelled_(name_ + " DR: read while the receive FIFO is empty");
    return 0;
  }
  const std::uint32_t word = receive_.front();
  receive_.pop_front();
  restart_timeout();
  if (receive_.empty()) raised_ &= ~irq_timeout;
  return word;
}

/// Counts from the last word or reading, while words wait and the line is idle.
void Spi::restart_timeout() {
  timeout_running_ = !receive_.empty() && !shifting_ && bit_time() != 0;
  if (timeout_running_) timeout_at_ = wheel_.time() + half_bits(timeout_half_bits);
}

// --- registers

std::uint32_t Spi::raw_interrupts() const {
  return raised_ | (transmit_.size() <= half_fifo ? irq_tx : 0u) |
         (receive_.size() >= half_fifo ? irq_rx : 0u);
}

void Spi::update_lines() {
  irqs_.set(irq_, cell_.masked(raw_interrupts()) != 0);
  if (!requests_.connected()) return;
  requests_.transmit(fifo_depth - transmit_.size());
  requests_.receive(receive_.size());
}

std::uint32_t Spi::flags() const {
  return (transmit_.empty() ? flag_tx_empty : 0u) |
         (transmit_.size() < fifo_depth ? flag_tx_not_full : 0u) |
         (receive_.empty() ? 0u : flag_rx_not_empty) |
         (receive_.size() >= fifo_depth ? flag_rx_full : 0u) |
         (frame_open_ || !transmit_.empty() ? flag_busy : 0u);
}

std::uint32_t Spi::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_cr0:
      return control_0_;
    case offset_cr1:
      return control_1_;
    case offset_dr:
      return receive_.empty() ? 0 : receive_.front();
    case offset_sr:
      return flags();
    case offset_cpsr:
      return prescale_;
    case offset_dmacr:
      return requests_.control();
    default:
      return cell_.read(offset, raw_interrupts());
  }
}

std::uint32_t Spi::read(std::uint32_t offset) {
  if (offset == offset_dr) {
    const std::uint32_t word = pop_received();
    update_lines();
    schedule();
    return word;
  }
  if (offset > offset_dmacr && offset < PrimeCell::offset_identification)
    not_modelled_(name_ + ": no register at this offset");
  return peek(offset);
}

std::uint32_t Spi::write_clear_bits(std::uint32_t offset) const {
  return offset == offset_icr ? irq_clearable : 0;
}

void Spi::write_data(std::uint32_t value) {
  if (transmit_.size() >= fifo_depth)
    return not_modelled_(name_ + " DR: written while the transmit FIFO is full; the word is lost");
  transmit_.push_back(static_cast<std::uint16_t>(value));
}

void Spi::write_control_0(std::uint32_t value) {
  control_0_ = value & 0xffffu;
  if ((control_0_ & cr0_format) != 0)
    not_modelled_(name_ + " SSPCR0 FRF: words are timed as in Motorola format");
  if ((control_0_ & 0xfu) < min_data_size)
    not_modelled_(name_ + " SSPCR0 DSS: a size of less than four bits");
}

void Spi::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case offset_cr0:
      write_control_0(value);
      break;
    case offset_cr1:
      control_1_ = value & 0xfu;
      break;
    case offset_dr:
      write_data(value);
      break;
    case offset_cpsr:
      prescale_ = value & 0xfeu;
      break;
    case offset_icr:
      raised_ &= ~(value & irq_clearable);
      break;
    case offset_dmacr:
      requests_.set_control(value & 3u);
      break;
    case offset_sr:
      break;
    default:
      if (!cell_.write(offset, value)) not_modelled_(name_ + ": no register at this offset");
  }
  begin();
  if (offset <= offset_cr1) put_wires(wheel_.now());
  update_lines();
  schedule();
}

}  // namespace lamplock::sim::chip
