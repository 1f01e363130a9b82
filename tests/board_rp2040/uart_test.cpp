// Serial port on a UART: bytes once and in order, errors counted and marked.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <deque>
#include <random>
#include <vector>

#include "firmware/boards/rp2040/uart/uart_serial.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

namespace field = rp2040::uart_field;

/// A PL011 in memory: two FIFOs of 32.
struct FakeUart {
  void start(rp2040::BaudDivisor value) { divisor = value; }
  std::uint32_t flags() const {
    return (received.empty() ? field::flag_receive_empty : 0u) |
           (sending.size() >= 32 ? field::flag_send_full : 0u) |
           (sending.empty() ? 0u : field::flag_busy);
  }
  std::uint32_t read_data() {
    const std::uint32_t data = received.front();
    received.pop_front();
    return data;
  }
  void write_data(std::uint8_t byte) { sending.push_back(byte); }
  void enable_interrupts(std::uint32_t bits) { enabled = bits; }
  void clear_interrupts(std::uint32_t) {}
  void pend() { pended = true; }

  /// A byte arrives on the line.
  void receive(std::uint32_t data) {
    if (received.size() < 32) {
      received.push_back(data | (overrun ? field::data_overrun : 0u));
      overrun = false;
    } else {
      overrun = true;
    }
  }

  rp2040::BaudDivisor divisor;
  std::deque<std::uint32_t> received;
  std::deque<std::uint8_t> sending;
  std::uint32_t enabled = 0;
  bool pended = false;
  bool overrun = false;
};

TEST(Uart, DivisorIsTheNearest) {
  for (const std::uint32_t clock : {125'000'000u, 12'000'000u, 133'000'000u}) {
    for (const std::uint32_t baud : {9'600u, 115'200u, 250'000u, 500'000u, 1'000'000u}) {
      if (clock < 16 * baud) continue;
      const auto divisor = rp2040::BaudDivisor::of(clock, baud);
      const double exact = 4.0 * clock / baud;
      EXPECT_NEAR(divisor.whole * 64 + divisor.fraction, exact, 0.5001) << clock << " " << baud;
    }
  }
  FakeUart uart;
  rp2040::BasicUartSerial<FakeUart> serial(uart);
  serial.start(125'000'000);
  EXPECT_EQ(uart.divisor.whole, 7u);
  EXPECT_EQ(uart.divisor.fraction, 52u);
}

TEST(Uart, BytesArriveOnceAndInOrder) {
  std::mt19937_64 random(5);
  FakeUart uart;
  rp2040::BasicUartSerial<FakeUart> serial(uart);
  serial.start(125'000'000);
  std::vector<std::uint8_t> in, at_device, out, at_host;
  for (int round = 0; round < scaled(20000); ++round) {
    for (std::uint64_t i = random() % 12; i > 0 && uart.received.size() < 32; --i) {
      // One-byte commands have a separate path.
      auto byte = static_cast<std::uint8_t>(random());
      while (wire::is_realtime(byte)) byte = static_cast<std::uint8_t>(random());
      in.push_back(byte);
      uart.receive(in.back());
    }
    std::array<std::uint8_t, 40> bytes{};
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const std::size_t taken = serial.write(std::span(bytes).first(random() % 20));
    out.insert(out.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    if (uart.pended || random() % 2 == 0) serial.interrupt();
    uart.pended = false;
    const bool more = out.size() - at_host.size() > uart.sending.size();
    EXPECT_EQ((uart.enabled & field::int_send) != 0, more && uart.sending.size() <= 32);
    for (std::uint64_t i = random() % 20; i > 0 && !uart.sending.empty(); --i) {
      at_host.push_back(uart.sending.front());
      uart.sending.pop_front();
    }
    const std::size_t count = serial.read(bytes);
    at_device.insert(at_device.end(), bytes.begin(),
                     bytes.begin() + static_cast<std::ptrdiff_t>(count));
  }
  while (!serial.idle() || !uart.received.empty()) {
    serial.interrupt();
    at_host.insert(at_host.end(), uart.sending.begin(), uart.sending.end());
    uart.sending.clear();
  }
  std::array<std::uint8_t, 40> bytes{};
  while (const std::size_t count = serial.read(bytes))
    at_device.insert(at_device.end(), bytes.begin(),
                     bytes.begin() + static_cast<std::ptrdiff_t>(count));
  EXPECT_EQ(at_device, in);
  EXPECT_EQ(at_host, out);
  EXPECT_EQ(serial.counters().gaps, 0u);
}

TEST(Uart, ErrorsAreCountedAndLeaveAMark) {
  FakeUart uart;
  rp2040::BasicUartSerial<FakeUart> serial(uart);
  serial.start(125'000'000);
  for (std::uint32_t i = 0; i < 40; ++i) uart.receive('a');  // 8 too many
  serial.interrupt();
  uart.receive('b');
  uart.receive('c' | field::data_framing_error);
  uart.receive('d');
  uart.receive(field::data_break_error);
  uart.receive('e' | field::data_parity_error);
  uart.receive('f');
  serial.interrupt();
  std::array<std::uint8_t, 64> bytes{};
  const std::size_t count = serial.read(bytes);
  const std::string got(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  EXPECT_EQ(got, std::string(32, 'a') +
                     "\x7f"
                     "b\x7f"
                     "d\x7f"
                     "f");
  const rp2040::UartCounters counters = serial.counters();
  EXPECT_EQ(counters.overruns, 1u);
  EXPECT_EQ(counters.broken_bytes, 2u);
  EXPECT_EQ(counters.breaks, 1u);
  EXPECT_EQ(counters.gaps, 3u);
}

}  // namespace
}  // namespace lamplock::test
