#include "sim/chip/serial/uart.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/chip/listeners.hpp"
#include "tests/chip/system_rig.hpp"

namespace lamplock::sim::chip::uart_test {
namespace {

constexpr std::uint32_t irq_rx = 1u << 4, irq_tx = 1u << 5, irq_timeout = 1u << 6;

class UartTest : public ::testing::Test, public ByteLine {
 protected:
  UartTest() {
    rig_.start_clocks();
    uart_.connect(*this);
    // 125 MHz / (16 * 67.8125) = 115 207 baud: 1085 cycles a bit.
    uart_.write(0x24, 67);
    uart_.write(0x28, 52);
    uart_.write(0x2c, 0x70);  // 8 bits, FIFOs
    uart_.write(0x30, 0x301);
  }
  void byte_sent(std::uint8_t byte, Cycle at) override { sent_.emplace_back(byte, at); }

  /// FR without CTS.
  std::uint32_t flags() { return uart_.read(0x18) & ~1u; }

  static constexpr Cycle bit = 1085, frame = 10 * bit;
  rigs::SystemRig rig_;
  Uart& uart_ = rig_.system.uart0;
  std::vector<std::pair<int, Cycle>> sent_;
};

TEST_F(UartTest, AFrameTakesTenBits) {
  EXPECT_EQ(uart_.frame_time(), static_cast<Picoseconds>(frame) * 8000);
  const Cycle start = rig_.wheel.now();
  EXPECT_EQ(flags(), 0x90u);
  uart_.write(0, 0x55);
  uart_.write(0, 0xaa);
  EXPECT_EQ(flags(), 0x18u);
  rig_.wheel.advance_to(start + 3 * frame);
  ASSERT_EQ(sent_.size(), 2u);
  EXPECT_EQ(sent_[0], std::make_pair(0x55, start + frame));
  EXPECT_EQ(sent_[1], std::make_pair(0xaa, start + 2 * frame));
  EXPECT_EQ(flags(), 0x90u);
}

TEST_F(UartTest, BytesWaitForClkPeri) {
  constexpr std::uint32_t clk_peri_ctrl = 0x48, enable = 1u << 11;
  rig_.system.clocks.write(clk_peri_ctrl, 0);
  EXPECT_EQ(uart_.frame_time(), 0);
  uart_.write(0, 0x55);
  uart_.send_to_chip(0xaa);
  rig_.pass(20 * frame);
  EXPECT_TRUE(sent_.empty());
  EXPECT_NE(flags() & 1u << 4, 0u) << "nothing received";
  rig_.system.clocks.write(clk_peri_ctrl, enable);
  const Cycle start = rig_.wheel.now();
  rig_.wheel.advance_to(start + frame);
  ASSERT_EQ(sent_.size(), 1u);
  EXPECT_EQ(sent_[0], std::make_pair(0x55, start + frame));
  EXPECT_EQ(uart_.read(0), 0xaau);
}

TEST_F(UartTest, ABitFollowsClkPeri) {
  constexpr std::uint32_t clk_peri_ctrl = 0x48, enable = 1u << 11, from_crystal = 4u << 5;
  rig_.system.clocks.write(clk_peri_ctrl, enable | from_crystal);
  // 16 * 67.8125 cycles of 12 MHz, rounded down to picoseconds.
  EXPECT_EQ(uart_.frame_time(), 10 * (ps_per_s * 1085 / 12'000'000));
}

TEST_F(UartTest, BaudRateTakesEffectWithLcrH) {
  uart_.write(0x24, 1000);
  EXPECT_EQ(uart_.frame_time(), static_cast<Picoseconds>(frame) * 8000);
  uart_.write(0x2c, 0x70);
  EXPECT_GT(uart_.frame_time(), static_cast<Picoseconds>(frame) * 8000);
}

TEST_F(UartTest, TransmitFifoHoldsThirtyTwoAndInterruptsAtHalf) {
  uart_.write(0x38, irq_tx);
  for (int n = 0; n < 33; ++n) uart_.write(0, static_cast<std::uint32_t>(n));  // one in the shifter
  EXPECT_NE(uart_.read(0x18) & 1u << 5, 0u);
  EXPECT_TRUE(rig_.reports.empty());
  uart_.write(0, 99);
  EXPECT_EQ(rig_.reports.size(), 1u);
  EXPECT_FALSE(rig_.line(Irq::uart0));
  rig_.pass(16 * frame);  // sixteen more have gone into the shifter
  EXPECT_TRUE(rig_.line(Irq::uart0));
  uart_.write(0x44, irq_tx);
  EXPECT_FALSE(rig_.line(Irq::uart0));
  rig_.pass(40 * frame);
  EXPECT_EQ(sent_.size(), 33u);
  EXPECT_FALSE(rig_.line(Irq::uart0)) << "the transition, not the level";
}

TEST_F(UartTest, ReceiveInterruptsAtItsLevelAndByTimeout) {
  uart_.write(0x38, irq_rx | irq_timeout);
  for (int n = 0; n < 18; ++n) uart_.send_to_chip(static_cast<std::uint8_t>(n));
  // The sixteenth arrives in the middle of its stop bit, 9.5 bits from its start.
  const Cycle start = rig_.wheel.now();
  rig_.wheel.advance_to(start + 15 * frame + 9 * bit + bit / 2);
  EXPECT_FALSE(rig_.line(Irq::uart0));
  rig_.pass(1);
  EXPECT_TRUE(rig_.line(Irq::uart0));
  EXPECT_EQ(uart_.read(0x40), irq_rx);
  for (std::uint32_t n = 0; n < 16; ++n) EXPECT_EQ(uart_.read(0), n);
  EXPECT_FALSE(rig_.line(Irq::uart0));
  rig_.wheel.advance_to(start + 17 * frame + (9 + 32) * bit + bit / 2);
  EXPECT_FALSE(rig_.line(Irq::uart0));
  rig_.pass(1);
  EXPECT_EQ(uart_.read(0x40), irq_timeout);
  EXPECT_EQ(uart_.read(0), 16u);
  EXPECT_TRUE(rig_.line(Irq::uart0));
  EXPECT_EQ(uart_.read(0), 17u);
  EXPECT_FALSE(rig_.line(Irq::uart0)) << "cleared when the FIFO is empty";
  EXPECT_NE(uart_.read(0x18) & 1u << 4, 0u);
}

TEST_F(UartTest, OverrunLosesBytesAndIsReported) {
  for (int n = 0; n < 34; ++n) uart_.send_to_chip(static_cast<std::uint8_t>(n));
  rig_.pass(40 * frame);
  EXPECT_NE(uart_.read(0x3c) & 1u << 10, 0u);
  EXPECT_EQ(uart_.read(4), 1u << 3);
  EXPECT_NE(uart_.read(0x18) & 1u << 6, 0u);
  EXPECT_NE(uart_.read(0) & 1u << 11, 0u);
  EXPECT_EQ(uart_.read(0), 1u);
}

TEST_F(UartTest, WithoutFifosThereIsOneByte) {
  uart_.write(0x2c, 0x60);
  uart_.write(0, 1);
  uart_.write(0, 2);
  EXPECT_NE(uart_.read(0x18) & 1u << 5, 0u);
  rig_.pass(frame);
  EXPECT_NE(uart_.read(0x3c) & irq_tx, 0u);
}

TEST_F(UartTest, LoopBackKeepsThePinHighAndReset) {
  rig_.connect(0, PinFunction::uart);
  rigs::Pads pads(rig_.gpio);
  uart_.write(0x30, 0x381);
  uart_.write(0, 0x42);
  rig_.pass(frame);
  EXPECT_TRUE(sent_.empty());
  EXPECT_TRUE(pads.edges[0].empty());
  EXPECT_EQ(uart_.read(0), 0x42u);
  uart_.reset();
  EXPECT_EQ(uart_.read(0x30), 0x300u);
  EXPECT_EQ(uart_.read(0x34), 0x12u);
  EXPECT_EQ(flags(), 0x90u);
  EXPECT_EQ(uart_.read(0xfe0), 0x11u);
}

}  // namespace
}  // namespace lamplock::sim::chip::uart_test
