// UART on its pins (RP2040 datasheet, 4.2 and 2.19.2).
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "sim/chip/serial/uart.hpp"
#include "tests/chip/dma_system_rig.hpp"
#include "tests/chip/listeners.hpp"

namespace lamplock::sim::chip::uart_pins_test {
namespace {

using rigs::alternating;
using rigs::EdgeList;
using rigs::Pads;

constexpr std::uint32_t dr = 0x00, rsr = 0x04, fr = 0x18, ibrd = 0x24, fbrd = 0x28, lcr_h = 0x2c,
                        cr = 0x30, imsc = 0x38, ris = 0x3c, icr = 0x44, dmacr = 0x48;
constexpr std::uint32_t enable = 0x301, rts = 1u << 11, rts_flow = 1u << 14, cts_flow = 1u << 15;
constexpr std::uint32_t rx_empty = 1u << 4;
constexpr std::uint32_t framing = 1u << 8, parity = 1u << 9, a_break = 1u << 10;

struct Sent : ByteLine {
  void byte_sent(std::uint8_t byte, Cycle at) override { list.emplace_back(byte, at); }
  std::vector<std::pair<int, Cycle>> list;
};

class UartPinsTest : public ::testing::Test {
 protected:
  UartPinsTest() {
    for (Uart* uart : {&one_, &two_}) {
      // 125 MHz / (16 * 67.8125): 1085 cycles a bit.
      uart->write(ibrd, 67);
      uart->write(fbrd, 52);
      uart->write(lcr_h, 0x70);
      uart->write(cr, enable);
    }
  }
  void connect(unsigned gpio, unsigned overrides = 0) {
    rig_.connect(gpio, PinFunction::uart, overrides);
    pads_.clear();
  }
  /// From TX of UART0 to RX of UART1.
  void connect_both() {
    connect(0);
    pads_.wire(0, 5, rig_.wheel.now());
    connect(5);
  }
  /// RX of UART0, high.
  void connect_rx() {
    rig_.drive(1, true);
    connect(1);
  }
  /// Times of UART0's edges since `from`, of which the first one is low.
  EdgeList low_at(Cycle from, const std::vector<Cycle>& bits) {
    std::vector<Cycle> cycles;
    for (const Cycle n : bits) cycles.push_back(from + n * bit);
    return alternating(false, cycles);
  }
  /// Drives levels on a pin, each for a number of half bits.
  void play(unsigned gpio, const std::vector<std::pair<bool, unsigned>>& levels) {
    const Cycle start = rig_.wheel.now();
    unsigned halves = 0;
    for (const auto& [level, length] : levels) {
      rig_.drive(gpio, level);
      halves += length;
      rig_.wheel.advance_to(start + halves * bit / 2);
    }
  }
  bool empty(Uart& uart) { return (uart.read(fr) & rx_empty) != 0; }

  static constexpr Cycle bit = 1085;
  rigs::DmaSystemRig rig_;
  Uart& one_ = rig_.system.uart0;
  Uart& two_ = rig_.system.uart1;
  Pads pads_{rig_.gpio};
};

// 4.2.3.1: start bit, data with the lowest bit first, stop bit.
TEST_F(UartPinsTest, TxShowsTheFrame) {
  connect(0);
  EXPECT_TRUE(rig_.pad(0)) << "idle is high";
  Sent sent;
  one_.connect(sent);
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0x53);  // 1100 1010 on the wire
  rig_.pass(20 * bit);
  EXPECT_EQ(pads_.edges[0], low_at(t, {0, 1, 3, 5, 6, 7, 8, 9}));
  ASSERT_EQ(sent.list.size(), 1u);
  EXPECT_EQ(sent.list[0], std::make_pair(0x53, t + 10 * bit)) << "bytes have the same times";
}

TEST_F(UartPinsTest, NothingIsDueWhileTheLineIsIdle) {
  connect(0);
  connect(1);
  rig_.drive(1, true);
  one_.write(dr, 0);
  rig_.pass(10 * bit);
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 1'000'000'000);
}

// Even parity makes the number of ones even; two stop bits precede the next frame.
TEST_F(UartPinsTest, ParityAndStopBitsOnTheWire) {
  connect(28);                                            // UART0 TX again
  one_.write(lcr_h, 0x50 | 1u << 1 | 1u << 2 | 1u << 3);  // 7 bits, even, two stop bits, FIFOs
  EXPECT_EQ(one_.frame_time(), static_cast<Picoseconds>(11 * bit) * 8000);
  Sent sent;
  one_.connect(sent);
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0x01);
  one_.write(dr, 0xff);
  rig_.pass(30 * bit);
  // The parity of one one, in bit 8, is high.
  EXPECT_EQ(pads_.edges[28], low_at(t, {0, 1, 2, 8, 11, 12}));
  ASSERT_EQ(sent.list.size(), 2u);
  EXPECT_EQ(sent.list[1].first, 0x7f) << "seven bits";
}

// With a fractional number of cycles per bit, edges do not drift.
TEST_F(UartPinsTest, FractionalRateDoesNotDrift) {
  connect(0);
  one_.write(ibrd, 1);
  one_.write(fbrd, 5);  // 16 * 1.078125 = 17.25 cycles a bit
  one_.write(lcr_h, 0x70);
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0x55);
  rig_.pass(200);
  ASSERT_EQ(pads_.edges[0].size(), 10u);
  for (Cycle n = 0; n < 10; ++n)
    EXPECT_EQ(pads_.edges[0][n].second, t + (1725 * n + 99) / 100) << n;
}

TEST_F(UartPinsTest, OverrideInvertsThePad) {
  connect(0, 1u << 8);
  EXPECT_FALSE(rig_.pad(0));
}

TEST_F(UartPinsTest, ConnectedInTheMiddleOfAFrame) {
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0x0f);
  rig_.wheel.advance_to(t + 6 * bit);  // in data bit 5
  rig_.connect(0, PinFunction::uart);
  rig_.pass(10 * bit);
  EXPECT_EQ(pads_.edges[0], (EdgeList{{true, t + 9 * bit}}));
}

// PL011: samples at the eighth Baud16 of each bit; the character arrives with its stop bit.
TEST_F(UartPinsTest, TwoUartsTalkOverAWire) {
  connect_both();
  for (const std::uint32_t byte : {0x00u, 0xffu, 0xa5u}) one_.write(dr, byte);
  rig_.pass(30 * bit);
  for (const std::uint32_t byte : {0x00u, 0xffu, 0xa5u}) EXPECT_EQ(two_.read(dr), byte);
  EXPECT_TRUE(empty(two_));
  EXPECT_EQ(two_.read(ris) & 0x780u, 0u);
}

// The byte interface has the same times: one byte by each interface.
TEST_F(UartPinsTest, BytesArriveAtTheTimesOfThePin) {
  connect_rx();
  const Cycle t = rig_.wheel.now();
  two_.send_to_chip(0x5a);
  const auto arrival = [&](Uart& uart) {
    rig_.wheel.advance_to(t + 9 * bit + bit / 2);
    const bool early = !empty(uart);
    rig_.pass(1);
    return !early && !empty(uart);
  };
  rig_.drive(1, false);
  for (const bool level : {false, true, false, true, true, false, true, false, true}) {
    rig_.pass(bit);
    rig_.drive(1, level);
  }
  EXPECT_TRUE(arrival(one_));
  EXPECT_FALSE(empty(two_));
  EXPECT_EQ(one_.read(dr), 0x5au);
  EXPECT_EQ(two_.read(dr), 0x5au);
}

// A low of less than half a bit is not a start bit (PL011: "false start bit is detected").
TEST_F(UartPinsTest, FalseStartBitIsIgnored) {
  connect_rx();
  rig_.drive(1, false);
  rig_.pass(bit / 2 - 1);
  rig_.drive(1, true);
  rig_.pass(20 * bit);
  EXPECT_TRUE(empty(one_));
}

TEST_F(UartPinsTest, FramingParityAndBreakErrors) {
  connect_rx();
  // 0xff with a low stop bit; the line stays low for another bit and is then high.
  play(1, {{false, 2}, {true, 16}, {false, 4}, {true, 4}});
  EXPECT_EQ(one_.read(ris) >> 7 & 0xfu, 1u);
  EXPECT_EQ(one_.read(dr), 0xffu | framing);
  EXPECT_EQ(one_.read(rsr), 1u);
  EXPECT_TRUE(empty(one_)) << "the rest of the low is not a start bit";
  one_.write(icr, 0x7ff);
  one_.write(rsr, 0);
  // Odd parity (PEN, EPS 0) of 0x00 is 1: a 0 is wrong.
  one_.write(lcr_h, 0x72);
  play(1, {{false, 20}, {true, 4}});
  EXPECT_EQ(one_.read(dr), 0x00u | parity);
  EXPECT_EQ(one_.read(ris) >> 7 & 0xfu, 2u);
  one_.write(icr, 0x7ff);
  // Low for longer than a frame: one character, whatever the length.
  one_.write(lcr_h, 0x70);
  play(1, {{false, 100}, {true, 4}});
  EXPECT_EQ(one_.read(dr), a_break | framing);
  EXPECT_TRUE(empty(one_));
  EXPECT_EQ(one_.read(ris) >> 7 & 0xfu, 5u);
}

TEST_F(UartPinsTest, BreakIsSentBetweenFrames) {
  connect_both();
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0xff);
  one_.write(lcr_h, 0x71);
  rig_.wheel.advance_to(t + 30 * bit);
  one_.write(lcr_h, 0x70);
  EXPECT_EQ(pads_.edges[0], low_at(t, {0, 1, 10, 30}));
  EXPECT_EQ(two_.read(dr), 0xffu);
  EXPECT_EQ(two_.read(dr), a_break | framing);
}

// The stop bit is sampled 9.5 bits from the start: half a bit in ten is too much.
TEST_F(UartPinsTest, ToleranceOfTheRate) {
  connect_both();
  for (const auto& [percent, good] :
       {std::make_pair(104u, true), std::make_pair(96u, true), std::make_pair(107u, false)}) {
    const std::uint32_t divisor = 4340 * percent / 100;
    one_.write(ibrd, divisor >> 6);
    one_.write(fbrd, divisor & 63u);
    one_.write(lcr_h, 0x70);
    one_.write(dr, 0x00);  // a slow last data bit is read as the stop bit
    rig_.pass(30 * bit);
    EXPECT_EQ(two_.read(dr) == 0x00u, good) << percent;
    while (!empty(two_)) two_.read(dr);
  }
}

// 4.2.4: nUARTRTS low while the receive FIFO is below its level; nUARTCTS high holds frames back.
TEST_F(UartPinsTest, FlowControl) {
  connect(3);  // UART0 RTS
  EXPECT_TRUE(rig_.pad(3));
  one_.write(cr, enable | rts);
  EXPECT_FALSE(rig_.pad(3));
  one_.write(cr, enable | rts_flow);
  for (int n = 0; n < 16; ++n) one_.send_to_chip(1);
  rig_.pass(15 * 10 * bit);
  EXPECT_FALSE(rig_.pad(3));
  rig_.pass(10 * bit);
  EXPECT_TRUE(rig_.pad(3)) << "sixteen of 32";
  one_.read(dr);
  EXPECT_FALSE(rig_.pad(3));

  rig_.drive(6, true);
  connect(6);  // UART1 CTS
  Sent sent;
  two_.connect(sent);
  two_.write(cr, enable | cts_flow);
  two_.write(dr, 1);
  two_.write(dr, 2);
  rig_.pass(30 * bit);
  EXPECT_TRUE(sent.list.empty());
  EXPECT_EQ(two_.read(fr) & 1u, 0u);
  rig_.drive(6, false);
  const Cycle t = rig_.wheel.now();
  rig_.pass(bit);
  rig_.drive(6, true);
  rig_.pass(30 * bit);
  ASSERT_EQ(sent.list.size(), 1u) << "the frame in progress is finished";
  EXPECT_EQ(sent.list[0], std::make_pair(1, t + 10 * bit));
  EXPECT_NE(two_.read(ris) & 2u, 0u);
}

// 2.5.3: the DMA keeps the transmit FIFO full and transfers received bytes.
TEST_F(UartPinsTest, Dma) {
  connect_both();
  for (std::uint32_t n = 0; n < 100; ++n) rig_.bus.sram()[n] = static_cast<std::uint8_t>(n * 7);
  one_.write(dmacr, 2);
  two_.write(dmacr, 1);
  rig_.start_dma(1, 0x40038000, rig_.ram + 0x1000, 100, 0, false, true, Dreq::uart1_rx);
  rig_.start_dma(0, rig_.ram, 0x40034000, 100, 0, true, false, Dreq::uart0_tx);
  rig_.pass(200);
  EXPECT_NE(one_.read(fr) & 1u << 5, 0u) << "full";
  rig_.pass(100 * 10 * bit);
  EXPECT_FALSE(rig_.dma_busy(0));
  EXPECT_FALSE(rig_.dma_busy(1));
  for (std::uint32_t n = 0; n < 100; ++n)
    EXPECT_EQ(rig_.bus.sram()[0x1000 + n], static_cast<std::uint8_t>(n * 7));
  EXPECT_TRUE(rig_.reports.empty());
}

// A state machine sends 8N1 with 8 of its clocks a bit; they run at clk_sys / 125.
TEST_F(UartPinsTest, ReceivesFromAPioProgram) {
  PioBlock& pio = rig_.fabric.pio0();
  const std::array<std::uint32_t, 6> program{
      0x80a0,  // pull block
      0xe027,  // set x, 7
      0xe700,  // set pins, 0 [7]
      0x6601,  // out pins, 1 [6]
      0x0043,  // jmp x--, 3
      0xe701,  // set pins, 1 [7]
  };
  for (std::uint32_t n = 0; n < program.size(); ++n) pio.write(0x48 + 4 * n, program[n]);
  constexpr std::uint32_t pin = 10;
  pio.write(0xc8, 125u << 16);                            // CLKDIV
  pio.write(0xcc, 5u << 12);                              // EXECCTRL: wrap after 5
  pio.write(0xd0, 1u << 19);                              // SHIFTCTRL: lowest bit first
  pio.write(0xdc, 1u << 26 | 1u << 20 | pin << 5 | pin);  // PINCTRL
  pio.write(0xd8, 0xe001);                                // set pins, 1
  pio.write(0xd8, 0xe081);                                // set pindirs, 1
  rig_.pass(10);
  rig_.connect(pin, PinFunction::pio0);
  pads_.wire(pin, 1, rig_.wheel.now());
  connect(1);
  one_.write(ibrd, 62);  // 62.5: 1000 cycles a bit
  one_.write(fbrd, 32);
  one_.write(lcr_h, 0x70);
  pio.write(0x00, 1);
  for (const std::uint32_t byte : {0x55u, 0x00u, 0xc3u}) pio.write(0x10, byte);
  rig_.pass(40 * 1000);
  for (const std::uint32_t byte : {0x55u, 0x00u, 0xc3u}) EXPECT_EQ(one_.read(dr), byte);
  EXPECT_TRUE(empty(one_));
  EXPECT_EQ(one_.read(ris) & 0x780u, 0u);
  ASSERT_GE(pads_.edges[pin].size(), 2u);
  EXPECT_EQ(pads_.edges[pin][1].second - pads_.edges[pin][0].second, 1000u);
}

// DMAONERR: no requests of the receiver while an error interrupts.
TEST_F(UartPinsTest, DmaStopsOnError) {
  connect_rx();
  one_.write(dmacr, 5);
  one_.write(imsc, 1u << 7);
  rig_.start_dma(0, 0x40034000, rig_.ram, 10, 0, false, true, Dreq::uart0_rx);
  play(1, {{false, 2}, {true, 16}, {false, 4}, {true, 4}});
  EXPECT_FALSE(empty(one_));
  one_.write(icr, 0x7ff);
  rig_.pass(50);
  EXPECT_TRUE(empty(one_));
}

}  // namespace
}  // namespace lamplock::sim::chip::uart_pins_test
