// The second link: a serial port on a UART.
//
// In:  the UART's interrupt (priority 2); `read` and `write` from the main loop. Out: bytes.
// Budget, counted by instruction, without waits of the bus: 110 cycles an interrupt, 76 a byte
//      received, 42 a byte sent; at 1 Mbaud, 8N1, eight bytes every 80 us in each direction, 10 %
//      of a core if both are busy. The FIFO of 32 bytes is full 240 us after the interrupt was
//      raised.
//
// Same interface as UsbSerial, but the other end cannot be made to wait: a full ring or FIFO drops
// bytes, counts them and marks the gap, so that no line is joined from two (base/byte_rings.hpp);
// broken bytes (framing, parity) count as missing. Real-time bytes are never dropped for lack of
// room. There is no host to detect or lose: always configured, never suspended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/boards/rp2040/base/byte_rings.hpp"
#include "firmware/boards/rp2040/registers/uart.hpp"
#include "shared/boards/pico_uart.hpp"

namespace lamplock::rp2040 {

/// Clocks of clk_peri to a bit, in 1/64 of sixteenths (RP2040 datasheet, 4.2.3.2.1).
struct BaudDivisor {
  std::uint32_t whole = 1;
  std::uint32_t fraction = 0;  ///< 1/64

  static constexpr BaudDivisor of(std::uint32_t clock_hz, std::uint32_t baud) {
    // clock / (16 baud) in 1/64, rounded to nearest.
    const std::uint32_t in_64ths = (8 * (clock_hz / baud) + 8 * (clock_hz % baud) / baud + 1) / 2;
    return {in_64ths >> 6, in_64ths & 63};
  }
};
static_assert(BaudDivisor::of(125'000'000, 1'000'000).whole == 7);
static_assert(BaudDivisor::of(125'000'000, 1'000'000).fraction == 52);

/// Events on the line.
struct UartCounters {
  std::uint32_t overruns = 0;      ///< FIFO full: bytes lost
  std::uint32_t broken_bytes = 0;  ///< framing, parity
  std::uint32_t breaks = 0;
  std::uint32_t bytes_dropped = 0;  ///< ring full
  std::uint32_t gaps = 0;           ///< places where bytes are missing
};

/// The port. `Hardware` is UartHardware (uart_hardware.hpp) or a test's.
template <class Hardware>
class BasicUartSerial {
 public:
  static constexpr std::uint32_t receive_capacity = 2048;
  static constexpr std::uint32_t send_capacity = 1024;

  explicit BasicUartSerial(Hardware& hardware) : hardware_(hardware) {}
  BasicUartSerial(const BasicUartSerial&) = delete;
  BasicUartSerial& operator=(const BasicUartSerial&) = delete;

  /// 8N1. Main loop; divides.
  void start(std::uint32_t clock_hz, std::uint32_t baud = boards::uart_baud) {
    hardware_.start(BaudDivisor::of(clock_hz, baud));
    hardware_.enable_interrupts(receive_interrupts);
  }

  /// UART0_IRQ or UART1_IRQ.
  void interrupt() {
    hardware_.clear_interrupts(receive_interrupts | uart_field::int_send);
    // At most one FIFO per interrupt, so that a fast line cannot block here.
    for (std::uint32_t i = 0; i < fifo_size; ++i) {
      if ((hardware_.flags() & uart_field::flag_receive_empty) != 0) break;
      take(hardware_.read_data());
    }
    for (std::uint32_t i = 0; i < fifo_size; ++i) {
      if (to_send_.size() == 0) break;
      if ((hardware_.flags() & uart_field::flag_send_full) != 0) break;
      hardware_.write_data(to_send_.pop_byte());
    }
    // The send interrupt occurs when the FIFO falls to 4 bytes.
    hardware_.enable_interrupts(receive_interrupts |
                                (to_send_.size() != 0 ? uart_field::int_send : 0u));
  }

  /// Main loop, at least every millisecond.
  void poll() {
    if (to_send_.size() != 0) hardware_.pend();
  }

  bool read_realtime(std::uint8_t& byte) { return received_.pop_realtime(byte); }
  bool realtime_waits() const { return received_.realtime_waits(); }
  std::size_t read(std::span<std::uint8_t> out) { return received_.pop(out); }
  bool before_jog_cancel() const { return received_.before_jog_cancel(); }
  std::size_t available() const { return received_.size(); }

  /// Queues bytes to send; returns how many were accepted, all if `room()` allows.
  std::size_t write(std::span<const std::uint8_t> in) {
    const std::uint32_t count = to_send_.place(in);
    to_send_.publish(count);
    if (count != 0) hardware_.pend();
    return count;
  }
  std::size_t room() const { return to_send_.room(); }
  /// All bytes have left the wire: a half-duplex driver may be turned off.
  bool idle() const {
    return to_send_.size() == 0 && (hardware_.flags() & uart_field::flag_busy) == 0;
  }

  static constexpr bool configured() { return true; }
  static constexpr bool suspended() { return false; }
  static constexpr std::uint32_t generation() { return 0; }

  /// True once after bytes were lost, unless there was a reset since.
  bool take_loss() { return received_.take_loss(); }
  UartCounters counters() const {
    UartCounters result = counters_;
    result.bytes_dropped = received_.losses().bytes;
    result.gaps = received_.losses().gaps;
    return result;
  }

 private:
  static constexpr std::uint32_t fifo_size = 32;
  static constexpr std::uint32_t receive_interrupts =
      uart_field::int_receive | uart_field::int_receive_timeout | uart_field::int_overrun;

  void take(std::uint32_t data) {
    if ((data & uart_field::data_overrun) != 0) {
      ++counters_.overruns;
      received_.mark_gap();
    }
    if ((data & uart_field::data_break_error) != 0) {
      ++counters_.breaks;
      return received_.mark_gap();
    }
    if ((data & (uart_field::data_framing_error | uart_field::data_parity_error)) != 0) {
      ++counters_.broken_bytes;
      return received_.mark_gap();
    }
    received_.push_byte(static_cast<std::uint8_t>(data));
  }

  Hardware& hardware_;
  ReceiveRing<receive_capacity> received_;
  SendRing<send_capacity> to_send_;
  UartCounters counters_;
};

}  // namespace lamplock::rp2040
