#include "sim/chip/serial/uart.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "sim/chip/fabric/wide.hpp"

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
constexpr std::uint32_t offset_icr = 0x44;
constexpr std::uint32_t offset_dmacr = 0x48;

// FR.
constexpr std::uint32_t flag_clear_to_send = 1u << 0;
constexpr std::uint32_t flag_busy = 1u << 3;
constexpr std::uint32_t flag_rx_empty = 1u << 4;
constexpr std::uint32_t flag_tx_full = 1u << 5;
constexpr std::uint32_t flag_rx_full = 1u << 6;
constexpr std::uint32_t flag_tx_empty = 1u << 7;
// LCR_H: BRK 0, PEN 1, EPS 2, STP2 3, FEN 4, WLEN 6:5, SPS 7 (UartFormat).
constexpr std::uint32_t line_break = 1u << 0;
constexpr std::uint32_t line_fifos = 1u << 4;
// CR.
constexpr std::uint32_t control_uart = 1u << 0;
constexpr std::uint32_t control_irda = 3u << 1;
constexpr std::uint32_t control_loop = 1u << 7;
constexpr std::uint32_t control_tx = 1u << 8;
constexpr std::uint32_t control_rx = 1u << 9;
constexpr std::uint32_t control_rts = 1u << 11;
constexpr std::uint32_t control_rts_flow = 1u << 14;
constexpr std::uint32_t control_cts_flow = 1u << 15;
constexpr std::uint32_t control_mask = 0xff87;
constexpr std::uint32_t control_reset = 0x300;
constexpr std::uint32_t trigger_reset = 0x12;  // both at one half
// RIS, MIS, IMSC, ICR.
constexpr std::uint32_t irq_cts = 1u << 1;
constexpr std::uint32_t irq_rx = 1u << 4;
constexpr std::uint32_t irq_tx = 1u << 5;
constexpr std::uint32_t irq_timeout = 1u << 6;
constexpr std::uint32_t irq_errors = 0xfu << 7;  // framing, parity, break, overrun
constexpr std::uint32_t irq_overrun = 1u << 10;
constexpr std::uint32_t irq_mask = 0x7ff;
// RSR: the errors of DR, eight bits lower; RIS has them one bit lower.
constexpr std::uint32_t rsr_overrun = 1u << 3;
// DMACR.
constexpr std::uint32_t dma_not_on_error = 1u << 2;
constexpr std::uint32_t part_number = 0x11;  // PL011

constexpr int timeout_bits = 32;  // 4.2.6: "32-bit period"

}  // namespace

Uart::Uart(int number, TimeWheel& wheel, Clocks& clocks, FunctionPins& pins, IrqLines& irqs,
           NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      clocks_(clocks),
      pins_(pins),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      name_("UART" + std::to_string(number)),
      irq_(number == 0 ? Irq::uart0 : Irq::uart1),
      cell_(offset_imsc, irq_mask, part_number),
      requests_(number == 0 ? Dreq::uart0_tx : Dreq::uart1_tx,
                number == 0 ? Dreq::uart0_rx : Dreq::uart1_rx),
      first_signal_(number == 0 ? 0 : 4) {
  clocks_.listen(*this);
  pins_.listen(*this);
  pins_.sense(signal(signal_rx));
  pins_.sense(signal(signal_cts));
  reset();
}

void Uart::reset() {
  transmit_.clear();
  receive_.clear();
  sending_ = timeout_running_ = overrun_ = breaking_ = false;
  error_status_ = integer_baud_ = fraction_baud_ = divisor_ = line_control_ = 0;
  control_ = control_reset;
  trigger_levels_ = trigger_reset;
  raised_ = low_power_ = 0;
  cell_.reset();
  requests_.set_control(0);
  set_format();
  receiver_.reset(true);
  drive_tx(wheel_.now());
  take_line(wheel_.now());
  cleared_ = clear_to_send();
  update_lines();
  schedule();
}

std::size_t Uart::depth() const { return (line_control_ & line_fifos) != 0 ? fifo_depth : 1; }

/// Bytes at which a FIFO triggers: TXIFLSEL (field 0) or RXIFLSEL (field 3), in eighths 1 2 4 6 7.
std::size_t Uart::trigger(unsigned field) const {
  constexpr std::array<std::size_t, 8> eighths{1, 2, 4, 6, 7, 7, 7, 7};
  if (depth() == 1) return field == 0 ? 0 : 1;
  return fifo_depth * eighths[trigger_levels_ >> field & 7u] / 8;
}

/// A bit takes sixteen times the divisor (16.6 fixed point) in cycles of clk_peri.
void Uart::set_format() {
  const std::uint64_t hz = clocks_.hz(Clock::peri);
  Picoseconds bit = 0;
  if (hz != 0 && divisor_ >= 1u << 6)
    bit = static_cast<Picoseconds>(static_cast<Wide>(divisor_) * 16 * ps_per_s /
                                   (64 * static_cast<Wide>(hz)));
  format_ = UartFormat::from(line_control_, bit);
}

void Uart::schedule() {
  if (stopped_) return wheel_.set(slot_, never_cycle);
  Picoseconds first = receiver_.due();
  if (sending_) first = std::min(first, tx_is_seen() ? std::min(sent_at_, edge_at_) : sent_at_);
  if (arriving_) first = std::min(first, arrives_at_);
  if (timeout_running_) first = std::min(first, timeout_at_);
  wheel_.set(slot_, wheel_.cycle_at(first));
}

void Uart::set_clock(bool runs) {
  if (runs != stopped_) return;
  stopped_ = !runs;
  if (stopped_) {
    stopped_at_ = wheel_.time();
    return schedule();
  }
  const Picoseconds still = wheel_.time() - stopped_at_;
  for (Picoseconds* at : {&sent_at_, &arrives_at_, &arrival_end_, &timeout_at_}) *at += still;
  frame_.delay(still);
  receiver_.delay(still);
  drive_tx(wheel_.now());
  take_line(wheel_.now());
  take_clear_to_send();
  start_frame();
  start_arrival();
  update_lines();
  schedule();
}

/// Sends what has waited for clk_peri. Frames under way keep their rate.
void Uart::clocks_changed() {
  set_format();
  if (format_.bit == 0) return;
  start_frame();
  start_arrival();
  update_lines();
  schedule();
}

void Uart::run(Cycle) {
  const Picoseconds time = wheel_.time();
  if (sending_ && tx_is_seen() && edge_at_ <= time) drive_tx(wheel_.now());
  if (sending_ && sent_at_ <= time) end_frame();
  if (receiver_.due() <= time) {
    // The source that drives the line may lag: bring it up to the sample.
    pins_.bring_sources_up_to(wheel_.now());
    if (const auto character = receiver_.run(time)) push_received(*character);
    take_line(wheel_.now());
  }
  if (arriving_ && arrives_at_ <= time) arrive();
  if (timeout_running_ && timeout_at_ <= time) {
    timeout_running_ = false;
    if (!receive_.empty()) raised_ |= irq_timeout;
  }
  update_lines();
  schedule();
}

// --- transmitter

void Uart::start_frame() {
  if (stopped_ || sending_ || transmit_.empty() || !on(control_uart) || !on(control_tx) ||
      breaking_)
    return;
  if (on(control_cts_flow) && !clear_to_send()) return;
  if (format_.bit == 0) return not_modelled_(name_ + ": a byte was sent without a baud rate");
  shift_ = static_cast<std::uint8_t>(transmit_.front() & format_.data_mask());
  transmit_.pop_front();
  sending_ = true;
  sent_at_ = wheel_.time() + format_.length();
  frame_ = UartFrame(shift_, format_, wheel_.time());
  drive_tx(wheel_.now());
  // The interrupt comes with the transition through the level, not with the level (PL011, 2.8).
  if (transmit_.size() == trigger(0)) raised_ |= irq_tx;
}

void Uart::end_frame() {
  sending_ = false;
  if (line_ != nullptr && !on(control_loop)) line_->byte_sent(shift_, wheel_.now());
  breaking_ = (line_control_ & line_break) != 0;
  drive_tx(wheel_.now());
  start_frame();
}

/// A break waits for the end of the frame under way, and a frame for the end of the break.
bool Uart::tx_level(Picoseconds at) const { return sending_ ? frame_.level(at) : !breaking_; }

bool Uart::tx_is_seen() const { return on(control_loop) || pins_.connected(signal(signal_tx)); }

/// Puts TX on its pins as it is at `at`; looped back the pins stay high (assumed).
void Uart::drive_tx(Cycle at) {
  const Picoseconds time = line_time(at);
  pins_.put(signal(signal_tx), tx_level(time) || on(control_loop), true, at);
  if (sending_) edge_at_ = frame_.next_change(time);
  if (on(control_loop)) take_line(at);
}

void Uart::write_data(std::uint32_t value) {
  if (transmit_.size() >= depth())
    return not_modelled_(name_ + " DR: written while the transmit FIFO is full; the byte is lost");
  transmit_.push_back(static_cast<std::uint8_t>(value));
  if (transmit_.size() > trigger(0)) raised_ &= ~irq_tx;
  start_frame();
}

// --- pins

void Uart::pins_changed(Cycle at) {
  take_line(at);
  take_clear_to_send();
  update_lines();
  schedule();
}

void Uart::pins_connecting(Cycle at) {
  if (sending_ && !tx_is_seen()) drive_tx(at);
}

/// CTS is active low. Without a pin it is taken as active (assumed).
bool Uart::clear_to_send() const {
  if (on(control_loop)) return ready_to_receive();
  return !pins_.input(signal(signal_cts));
}

void Uart::take_clear_to_send() {
  const bool clear = clear_to_send();
  if (std::exchange(cleared_, clear) == clear) return;
  raised_ |= irq_cts;
  start_frame();
}

/// RTS: what CR says, or whether the receive FIFO is below its level (4.2.4).
bool Uart::ready_to_receive() const {
  return on(control_rts_flow) ? receive_.size() < trigger(3) : on(control_rts);
}

/// RX has the level of its pin. Without a pin it is taken as idle (assumed); so is an undriven pin
/// while a line of whole bytes is plugged in, whose far end would hold it high.
bool Uart::line_level() const {
  const unsigned rx = signal(signal_rx);
  if (!pins_.connected(rx) || (line_ != nullptr && !pins_.driven(rx))) return true;
  return pins_.input(rx);
}

void Uart::take_line(Cycle at) {
  if (stopped_) return;
  const Picoseconds time = wheel_.time_of(at);
  const bool level = on(control_loop) ? tx_level(time) : line_level();
  UartFormat form = format_;
  if (!on(control_uart) || !on(control_rx)) form.bit = 0;
  if (const auto character = receiver_.line(level, time, form)) push_received(*character);
}

// --- receiver

void Uart::send_to_chip(std::uint8_t byte) {
  incoming_.push_back(byte);
  start_arrival();
  schedule();
}

void Uart::start_arrival() {
  if (stopped_ || arriving_ || incoming_.empty() || !on(control_uart) || !on(control_rx)) return;
  if (format_.bit == 0) return;
  arriving_ = true;
  const Picoseconds start = std::max(wheel_.time(), arrival_end_);
  arrives_at_ = start + format_.to_stop_sample();
  arrival_end_ = start + format_.length();
}

void Uart::arrive() {
  arriving_ = false;
  const std::uint8_t byte = incoming_.front();
  incoming_.pop_front();
  if (on(control_uart) && on(control_rx) && !on(control_loop))
    push_received(byte & format_.data_mask());
  start_arrival();
}

void Uart::push_received(std::uint32_t character) {
  raised_ |= character >> 1 & irq_errors;
  if (receive_.size() >= depth()) {
    overrun_ = true;
    error_status_ |= rsr_overrun;
    raised_ |= irq_overrun;
    return;
  }
  receive_.push_back(static_cast<std::uint16_t>(character));
  if (receive_.size() >= trigger(3)) raised_ |= irq_rx;
  timeout_running_ = true;
  timeout_at_ = wheel_.time() + timeout_bits * format_.bit;
}

/// The errors of a character are in RSR from when it is read (description of UARTRSR).
std::uint32_t Uart::pop_received() {
  if (receive_.empty()) return 0;
  const std::uint32_t value = receive_.front() | (overrun_ ? uart_data::overrun_error : 0u);
  receive_.pop_front();
  error_status_ = (error_status_ & rsr_overrun) | (value >> 8 & 0xfu);
  overrun_ = false;
  if (receive_.size() < trigger(3)) raised_ &= ~irq_rx;
  if (receive_.empty()) {
    raised_ &= ~irq_timeout;
    timeout_running_ = false;
  }
  return value;
}

// --- registers

void Uart::update_lines() {
  irqs_.set(irq_, cell_.masked(raised_) != 0);
  pins_.put(signal(signal_rts), !ready_to_receive(), true, wheel_.now());
  if (!requests_.connected()) return;
  requests_.transmit(on(control_uart) ? depth() - transmit_.size() : 0);
  // DMAONERR: an error that interrupts stops the requests of the receiver (4.2.5).
  const bool stopped =
      (requests_.control() & dma_not_on_error) != 0 && (cell_.masked(raised_) & irq_errors) != 0;
  requests_.receive(on(control_uart) && !stopped ? receive_.size() : 0);
}

std::uint32_t Uart::flags() const {
  return (clear_to_send() ? flag_clear_to_send : 0u) |
         (sending_ || !transmit_.empty() ? flag_busy : 0u) |
         (receive_.empty() ? flag_rx_empty : 0u) |
         (transmit_.size() >= depth() ? flag_tx_full : 0u) |
         (receive_.size() >= depth() ? flag_rx_full : 0u) |
         (transmit_.empty() ? flag_tx_empty : 0u);
}

std::uint32_t Uart::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_dr:
      return receive_.empty() ? 0 : receive_.front() | (overrun_ ? uart_data::overrun_error : 0u);
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
    case offset_dmacr:
      return requests_.control();
    default:
      return cell_.read(offset, raised_);
  }
}

std::uint32_t Uart::read(std::uint32_t offset) {
  if (offset == offset_dr) {
    const std::uint32_t value = pop_received();
    update_lines();
    schedule();
    return value;
  }
  const bool gap = (offset > offset_rsr && offset < offset_fr) ||
                   (offset > offset_fr && offset < offset_ilpr) ||
                   (offset > offset_dmacr && offset < PrimeCell::offset_identification);
  if (gap) not_modelled_(name_ + ": no register at this offset");
  return peek(offset);
}

std::uint32_t Uart::write_clear_bits(std::uint32_t offset) const {
  return offset == offset_icr ? irq_mask : 0;
}

void Uart::write_control(std::uint32_t value) {
  control_ = value & control_mask;
  if ((control_ & control_irda) != 0) not_modelled_(name_ + " CR: IrDA is without effect");
  drive_tx(wheel_.now());
  take_line(wheel_.now());
  take_clear_to_send();
  start_frame();
  start_arrival();
}

void Uart::write_line_control(std::uint32_t value) {
  line_control_ = value & 0xffu;
  divisor_ = integer_baud_ << 6 | fraction_baud_;
  set_format();
  if (!sending_) {
    breaking_ = (line_control_ & line_break) != 0;
    drive_tx(wheel_.now());
    start_frame();
  }
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
      write_line_control(value);
      break;
    case offset_cr:
      write_control(value);
      break;
    case offset_ifls:
      trigger_levels_ = value & 0x3fu;
      break;
    case offset_icr:
      raised_ &= ~value;
      break;
    case offset_dmacr:
      requests_.set_control(value & 7u);
      break;
    case offset_fr:
      break;
    default:
      if (!cell_.write(offset, value)) not_modelled_(name_ + ": no register at this offset");
  }
  update_lines();
  schedule();
}

}  // namespace lamplock::sim::chip
