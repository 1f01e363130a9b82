// UART0 and UART1: the PL011 of the RP2040 (RP2040 datasheet, 4.2; ARM PrimeCell UART PL011
// manual).
//
// In:  registers; clk_peri; the levels of RX and CTS; whole bytes from the line.
// Out: the levels of TX and RTS, bit by bit; whole bytes to the line, at the end of their frames;
//      the interrupt line; the DREQs.
// Who: the bus; the wheel at the ends of frames, and at each edge of TX that a pin shows and each
//      sample of RX while a frame is on it.
//
// A frame takes start bit, data bits, parity and stop bits at the rate that IBRD, FBRD and clk_peri
// give; it begins when its byte is there and the line is free (the phase of the free-running baud
// rate generator is not modelled). Whole bytes from the line arrive one after the other at the same
// rate; each is received in the middle of its stop bit, like one from the pin.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/function_pins.hpp"
#include "sim/chip/serial/primecell.hpp"
#include "sim/chip/serial/serial_requests.hpp"
#include "sim/chip/serial/uart_frame.hpp"
#include "sim/chip/system/clocks.hpp"

namespace lamplock::sim::chip {

/// The other end of the line.
class ByteLine {
 public:
  virtual ~ByteLine() = default;
  /// The chip has sent a byte; `at` is the end of its last stop bit.
  virtual void byte_sent(std::uint8_t byte, Cycle at) = 0;
};

/// UART0 or UART1.
class Uart final : public Peripheral,
                   private Timed,
                   private ClockListener,
                   private FunctionPins::User {
 public:
  Uart(int number, TimeWheel& wheel, Clocks& clocks, FunctionPins& pins, IrqLines& irqs,
       NotModelled not_modelled);
  Uart(const Uart&) = delete;
  Uart& operator=(const Uart&) = delete;

  void connect(DreqLines& lines) { requests_.connect(lines); }
  void connect(ByteLine& line) { line_ = &line; }
  /// The other end begins to send a byte as soon as the line is free.
  void send_to_chip(std::uint8_t byte);
  /// Time of a frame as configured; 0: the baud rate is not set, or there is no clock.
  Picoseconds frame_time() const { return format_.length(); }

  std::string_view name() const override { return name_; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;
  /// clk_peri stops or starts behind its gate: a stopped frame holds its bit on the line, and the
  /// receiver is off. The other end of a line of whole bytes waits (assumed).
  void set_clock(bool runs);

 private:
  static constexpr std::size_t fifo_depth = 32;

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void clocks_changed() override;
  void pins_changed(Cycle at) override;
  void pins_connecting(Cycle at) override;

  /// Signals of each UART (uart_signal).
  enum Signal : unsigned { signal_tx, signal_rx, signal_cts, signal_rts };
  unsigned signal(Signal of) const { return first_signal_ + of; }
  bool on(std::uint32_t control_bit) const { return (control_ & control_bit) != 0; }
  std::size_t depth() const;
  std::size_t trigger(unsigned field) const;
  void set_format();
  /// The time that TX shows: constant without a clock.
  Picoseconds line_time(Cycle at) const { return stopped_ ? stopped_at_ : wheel_.time_of(at); }
  void start_frame();
  void end_frame();
  bool tx_level(Picoseconds at) const;
  bool tx_is_seen() const;
  void drive_tx(Cycle at);
  bool clear_to_send() const;
  bool ready_to_receive() const;
  bool line_level() const;
  void take_line(Cycle at);
  void take_clear_to_send();
  void start_arrival();
  void arrive();
  void push_received(std::uint32_t character);
  std::uint32_t pop_received();
  void write_data(std::uint32_t value);
  void write_control(std::uint32_t value);
  void write_line_control(std::uint32_t value);
  std::uint32_t flags() const;
  void schedule();
  void update_lines();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Clocks& clocks_;
  FunctionPins& pins_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  std::string name_;
  Irq irq_;
  PrimeCell cell_;
  SerialRequests requests_;
  unsigned first_signal_;
  ByteLine* line_ = nullptr;

  std::deque<std::uint8_t> transmit_, incoming_;
  std::deque<std::uint16_t> receive_;  ///< with their errors (uart_data)
  bool sending_ = false, arriving_ = false, timeout_running_ = false;
  bool stopped_ = false;        ///< no clock
  Picoseconds stopped_at_ = 0;  ///< time of the stop
  bool breaking_ = false;       ///< BRK, after the frame that was under way
  std::uint8_t shift_ = 0;      ///< being sent
  UartFrame frame_;             ///< the same on the line
  Picoseconds edge_at_ = 0;     ///< the next of TX, if it is seen
  UartReceiver receiver_;
  Picoseconds sent_at_ = 0, arrives_at_ = 0, timeout_at_ = 0;
  Picoseconds arrival_end_ = 0;     ///< the other end may begin its next byte
  bool cleared_ = true;             ///< CTS when it was last looked at
  bool overrun_ = false;            ///< a byte was lost: reported with the next one received
  std::uint32_t error_status_ = 0;  ///< RSR
  std::uint32_t integer_baud_ = 0, fraction_baud_ = 0;
  std::uint32_t divisor_ = 0;  ///< 16.6, taken over when LCR_H is written
  UartFormat format_;          ///< of frames that begin now
  std::uint32_t line_control_ = 0, control_ = 0, trigger_levels_ = 0;
  std::uint32_t raised_ = 0, low_power_ = 0;
};

}  // namespace lamplock::sim::chip
