// UART0 and UART1: the PL011 of the RP2040 (RP2040 datasheet, 4.2; ARM PrimeCell UART PL011
// manual).
//
// In:  registers; whole bytes from the line.
// Out: whole bytes to the line, at the end of their frames; the interrupt line.
// Who: the bus; the wheel at the ends of frames. The pins are not driven bit by bit.
//
// A frame takes start bit, data bits, parity and stop bits at the rate that IBRD, FBRD and clk_peri
// give. Bytes from the line arrive one after the other at that same rate.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "sim/chip/irq_lines.hpp"
#include "sim/chip/peripheral.hpp"
#include "sim/chip/system/clocks.hpp"
#include "sim/chip/time_wheel.hpp"

namespace lamplock::sim::chip {

/// The other end of the line.
class ByteLine {
 public:
  virtual ~ByteLine() = default;
  /// The chip has sent a byte; `at` is the end of its last stop bit.
  virtual void byte_sent(std::uint8_t byte, Cycle at) = 0;
};

/// One of the two.
class Uart final : public Peripheral, private Timed {
 public:
  Uart(int number, TimeWheel& wheel, Clocks& clocks, IrqLines& irqs, NotModelled not_modelled);
  Uart(const Uart&) = delete;
  Uart& operator=(const Uart&) = delete;

  void connect(ByteLine& line) { line_ = &line; }
  /// The other end begins to send a byte as soon as the line is free.
  void send_to_chip(std::uint8_t byte);
  /// Time of a frame as configured; 0: the baud rate is not set.
  Picoseconds frame_time() const;

  std::string_view name() const override { return name_; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  void reset() override;

 private:
  static constexpr std::size_t fifo_depth = 32;

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }

  bool on(std::uint32_t control_bit) const { return (control_ & control_bit) != 0; }
  std::size_t depth() const;
  std::size_t trigger(unsigned field) const;
  Picoseconds bit_time() const;
  Picoseconds now() const { return wheel_.time_of(wheel_.now()); }
  void start_frame();
  void end_frame();
  void start_arrival();
  void arrive();
  void push_received(std::uint8_t byte);
  std::uint32_t pop_received();
  void write_data(std::uint32_t value);
  void write_control(std::uint32_t value);
  std::uint32_t flags() const;
  std::uint32_t identification(std::uint32_t offset) const;
  void schedule();
  void update_irq();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Clocks& clocks_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  std::string name_;
  Irq irq_;
  ByteLine* line_ = nullptr;

  std::deque<std::uint8_t> transmit_, receive_, incoming_;
  bool sending_ = false, arriving_ = false, timeout_running_ = false;
  std::uint8_t shift_ = 0;  ///< being sent
  Picoseconds sent_at_ = 0, arrives_at_ = 0, timeout_at_ = 0;
  bool overrun_ = false;            ///< a byte was lost: goes with the next one received
  std::uint32_t error_status_ = 0;  ///< RSR
  std::uint32_t integer_baud_ = 0, fraction_baud_ = 0;
  std::uint32_t divisor_ = 0;  ///< 16.6, taken over when LCR_H is written
  std::uint32_t line_control_ = 0, control_ = 0, trigger_levels_ = 0;
  std::uint32_t mask_ = 0, raised_ = 0, dma_control_ = 0, low_power_ = 0;
};

}  // namespace lamplock::sim::chip
