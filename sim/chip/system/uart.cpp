#include "sim/chip/system/uart.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "sim/chip/wide.hpp"

namespace lamplock::sim::chip {

namespace {

// Offsets (4.2.8).
constexpr std::uint32_t offset_dr = 0x00;
constexpr std::uint32_t offset_rsr = 0x04;
constexpr std::uint32_t offset_fr = 0x18;
constexpr std::uint32_t offset_ilpr = 0x20;
constexpr std::uint32_t offset_ibrd = 0x24;
constexpr std::uint32_t offset_fbrd = 0x28;
constexpr std::uint32_t offset_lcr_h = 0x2c;
constexpr std::uint32_t offset_cr = 0x30;
constexpr std::uint32_t offset_ifls = 0x34;
constexpr std::uint32_t offset_imsc = 0x38;
constexpr std::uint32_t offset_ris = 0x3c;
constexpr std::uint32_t offset_mis = 0x40;
constexpr std::uint32_t offset_icr = 0x44;
constexpr std::uint32_t offset_dmacr = 0x48;
constexpr std::uint32_t offset_identification = 0xfe0;  // PERIPHID0-3, PCELLID0-3

// FR.
constexpr std::uint32_t flag_busy = 1u << 3;
constexpr std::uint32_t flag_rx_empty = 1u << 4;
constexpr std::uint32_t flag_tx_full = 1u << 5;
constexpr std::uint32_t flag_rx_full = 1u << 6;
constexpr std::uint32_t flag_tx_empty = 1u << 7;
// LCR_H: BRK 0, PEN 1, EPS 2, STP2 3, FEN 4, WLEN 6:5, SPS 7.
constexpr std::uint32_t line_break = 1u << 0;
constexpr std::uint32_t line_parity = 1u << 1;
constexpr std::uint32_t line_two_stop = 1u << 3;
constexpr std::uint32_t line_fifos = 1u << 4;
// CR.
constexpr std::uint32_t control_uart = 1u << 0;
constexpr std::uint32_t control_irda = 3u << 1;
constexpr std::uint32_t control_loop = 1u << 7;
constexpr std::uint32_t control_tx = 1u << 8;
constexpr std::uint32_t control_rx = 1u << 9;
constexpr std::uint32_t control_flow = 3u << 14;  // RTSEN, CTSEN
constexpr std::uint32_t control_mask = 0xff87;
constexpr std::uint32_t control_reset = 0x300;
constexpr std::uint32_t trigger_reset = 0x12;  // both at one half
// RIS, MIS, IMSC, ICR.
constexpr std::uint32_t irq_rx = 1u << 4;
constexpr std::uint32_t irq_tx = 1u << 5;
constexpr std::uint32_t irq_timeout = 1u << 6;
constexpr std::uint32_t irq_overrun = 1u << 10;
constexpr std::uint32_t irq_mask = 0x7ff;
// DR and RSR.
constexpr std::uint32_t data_overrun = 1u << 11;
constexpr std::uint32_t rsr_overrun = 1u << 3;

constexpr int timeout_bits = 32;  // 4.2.6: "32-bit period"

}  // namespace

Uart::Uart(int number, TimeWheel& wheel, Clocks& clocks, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      clocks_(clocks),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      name_("UART" + std::to_string(number)),
      irq_(number == 0 ? Irq::uart0 : Irq::uart1) {
  reset();
}

void Uart::reset() {
  transmit_.clear();
  receive_.clear();
  sending_ = timeout_running_ = overrun_ = false;
  error_status_ = integer_baud_ = fraction_baud_ = divisor_ = line_control_ = 0;
  control_ = control_reset;
  trigger_levels_ = trigger_reset;
  mask_ = raised_ = dma_control_ = low_power_ = 0;
  schedule();
  update_irq();
}

std::size_t Uart::depth() const { return (line_control_ & line_fifos) != 0 ? fifo_depth : 1; }

/// Bytes at which a FIFO triggers: TXIFLSEL (field 0) or RXIFLSEL (field 3), in eighths 1 2 4 6 7.
std::size_t Uart::trigger(unsigned field) const {
  constexpr std::array<std::size_t, 8> eighths{1, 2, 4, 6, 7, 7, 7, 7};
  if (depth() == 1) return field == 0 ? 0 : 1;
  return fifo_depth * eighths[trigger_levels_ >> field & 7u] / 8;
}

/// A bit takes sixteen times the divisor (16.6 fixed point) in cycles of clk_peri.
Picoseconds Uart::bit_time() const {
  const std::uint64_t hz = clocks_.hz(Clock::peri);
  if (hz == 0 || divisor_ < 1u << 6) return 0;
  return static_cast<Picoseconds>(static_cast<Wide>(divisor_) * 16 * ps_per_s /
                                  (64 * static_cast<Wide>(hz)));
}

Picoseconds Uart::frame_time() const {
  const std::uint32_t bits = 1 + 5 + (line_control_ >> 5 & 3u) +
                             ((line_control_ & line_parity) != 0 ? 1u : 0u) +
                             ((line_control_ & line_two_stop) != 0 ? 2u : 1u);
  return bit_time() * static_cast<Picoseconds>(bits);
}

void Uart::schedule() {
  Picoseconds first = std::numeric_limits<Picoseconds>::max();
  if (sending_) first = std::min(first, sent_at_);
  if (arriving_) first = std::min(first, arrives_at_);
  if (timeout_running_) first = std::min(first, timeout_at_);
  const bool waits = sending_ || arriving_ || timeout_running_;
  wheel_.set(slot_, waits ? wheel_.cycle_at(first) : never_cycle);
}

void Uart::run(Cycle) {
  const Picoseconds time = now();
  if (sending_ && sent_at_ <= time) end_frame();
  if (arriving_ && arrives_at_ <= time) arrive();
  if (timeout_running_ && timeout_at_ <= time) {
    timeout_running_ = false;
    if (!receive_.empty()) raised_ |= irq_timeout;
  }
  update_irq();
  schedule();
}

// --- transmitter

void Uart::start_frame() {
  if (sending_ || transmit_.empty() || !on(control_uart) || !on(control_tx)) return;
  const Picoseconds frame = frame_time();
  if (frame == 0) return not_modelled_(name_ + ": a byte was sent without a baud rate");
  shift_ = transmit_.front();
  transmit_.pop_front();
  sending_ = true;
  sent_at_ = now() + frame;
  // The interrupt comes with the transition through the level, not with the level (PL011, 2.8).
  if (transmit_.size() == trigger(0)) raised_ |= irq_tx;
}

void Uart::end_frame() {
  sending_ = false;
  const auto bits = static_cast<unsigned>(5 + (line_control_ >> 5 & 3u));
  const auto byte = static_cast<std::uint8_t>(shift_ & ((1u << bits) - 1));
  if (on(control_loop))
    push_received(byte);
  else if (line_ != nullptr)
    line_->byte_sent(byte, wheel_.now());
  start_frame();
}

void Uart::write_data(std::uint32_t value) {
  if (transmit_.size() >= depth())
    return not_modelled_(name_ + " DR: written while the transmit FIFO is full; the byte is lost");
  transmit_.push_back(static_cast<std::uint8_t>(value));
  if (transmit_.size() > trigger(0)) raised_ &= ~irq_tx;
  start_frame();
}

// --- receiver

void Uart::send_to_chip(std::uint8_t byte) {
  incoming_.push_back(byte);
  start_arrival();
  schedule();
}

void Uart::start_arrival() {
  if (arriving_ || incoming_.empty() || !on(control_uart) || !on(control_rx)) return;
  const Picoseconds frame = frame_time();
  if (frame == 0) return;
  arriving_ = true;
  arrives_at_ = now() + frame;
}

void Uart::arrive() {
  arriving_ = false;
  const std::uint8_t byte = incoming_.front();
  incoming_.pop_front();
  if (on(control_uart) && on(control_rx) && !on(control_loop)) push_received(byte);
  start_arrival();
}

void Uart::push_received(std::uint8_t byte) {
  if (receive_.size() >= depth()) {
    overrun_ = true;
    error_status_ |= rsr_overrun;
    raised_ |= irq_overrun;
    return;
  }
  receive_.push_back(byte);
  if (receive_.size() >= trigger(3)) raised_ |= irq_rx;
  timeout_running_ = true;
  timeout_at_ = now() + timeout_bits * bit_time();
}

std::uint32_t Uart::pop_received() {
  if (receive_.empty()) return 0;
  const std::uint32_t value = receive_.front() | (overrun_ ? data_overrun : 0u);
  receive_.pop_front();
  overrun_ = false;
  if (receive_.size() < trigger(3)) raised_ &= ~irq_rx;
  if (receive_.empty()) {
    raised_ &= ~irq_timeout;
    timeout_running_ = false;
  }
  return value;
}

// --- registers

void Uart::update_irq() { irqs_.set(irq_, (raised_ & mask_) != 0); }

std::uint32_t Uart::flags() const {
  return (sending_ || !transmit_.empty() ? flag_busy : 0u) |
         (receive_.empty() ? flag_rx_empty : 0u) |
         (transmit_.size() >= depth() ? flag_tx_full : 0u) |
         (receive_.size() >= depth() ? flag_rx_full : 0u) |
         (transmit_.empty() ? flag_tx_empty : 0u);
}

std::uint32_t Uart::identification(std::uint32_t offset) const {
  constexpr std::array<std::uint32_t, 8> bytes{0x11, 0x10, 0x34, 0x00, 0x0d, 0xf0, 0x05, 0xb1};
  return bytes[(offset - offset_identification) / 4];
}

std::uint32_t Uart::peek(std::uint32_t offset) const {
  if (offset >= offset_identification) return identification(offset);
  switch (offset) {
    case offset_dr:
      return receive_.empty() ? 0 : receive_.front() | (overrun_ ? data_overrun : 0u);
    case offset_rsr:
      return error_status_;
    case offset_fr:
      return flags();
    case offset_ilpr:
      return low_power_;
    case offset_ibrd:
      return integer_baud_;
    case offset_fbrd:
      return fraction_baud_;
    case offset_lcr_h:
      return line_control_;
    case offset_cr:
      return control_;
    case offset_ifls:
      return trigger_levels_;
    case offset_imsc:
      return mask_;
    case offset_ris:
      return raised_;
    case offset_mis:
      return raised_ & mask_;
    case offset_dmacr:
      return dma_control_;
    default:
      return 0;
  }
}

std::uint32_t Uart::read(std::uint32_t offset) {
  if (offset == offset_dr) {
    const std::uint32_t value = pop_received();
    update_irq();
    schedule();
    return value;
  }
  const bool gap = (offset > offset_rsr && offset < offset_fr) ||
                   (offset > offset_fr && offset < offset_ilpr) ||
                   (offset > offset_dmacr && offset < offset_identification);
  if (gap) not_modelled_(name_ + ": no register at this offset");
  return peek(offset);
}

void Uart::write_control(std::uint32_t value) {
  control_ = value & control_mask;
  if ((control_ & (control_irda | control_flow)) != 0)
    not_modelled_(name_ + " CR: IrDA and hardware flow control are without effect");
  start_frame();
  start_arrival();
}

void Uart::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case offset_dr:
      write_data(value);
      break;
    case offset_rsr:
      error_status_ = 0;
      break;
    case offset_ilpr:
      low_power_ = value & 0xffu;
      break;
    case offset_ibrd:
      integer_baud_ = value & 0xffffu;
      break;
    case offset_fbrd:
      fraction_baud_ = value & 0x3fu;
      break;
    case offset_lcr_h:
      line_control_ = value & 0xffu;
      divisor_ = integer_baud_ << 6 | fraction_baud_;
      if ((line_control_ & line_break) != 0) not_modelled_(name_ + " LCR_H BRK: no break is sent");
      start_arrival();
      break;
    case offset_cr:
      write_control(value);
      break;
    case offset_ifls:
      trigger_levels_ = value & 0x3fu;
      break;
    case offset_imsc:
      mask_ = value & irq_mask;
      break;
    case offset_icr:
      raised_ &= ~value;
      break;
    case offset_dmacr:
      dma_control_ = value & 7u;
      if (dma_control_ != 0) not_modelled_(name_ + " DMACR: no requests are made");
      break;
    case offset_fr:
    case offset_ris:
    case offset_mis:
      break;
    default:
      if (offset < offset_identification) not_modelled_(name_ + ": no register at this offset");
  }
  update_irq();
  schedule();
}

}  // namespace lamplock::sim::chip
