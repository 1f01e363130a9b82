// SPI on its pins (RP2040 datasheet, 4.4.3.9 to 4.4.3.13 and 2.19.2).
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "sim/chip/serial/spi.hpp"
#include "tests/chip/dma_system_rig.hpp"
#include "tests/chip/listeners.hpp"

namespace lamplock::sim::chip::spi_pins_test {
namespace {

constexpr std::uint32_t cr0 = 0x00, cr1 = 0x04, dr = 0x08, sr = 0x0c, cpsr = 0x10;
constexpr std::uint32_t spo = 1u << 6, sph = 1u << 7;
constexpr std::uint32_t enable = 2, slave = 4, output_off = 8, rx_not_empty = 4;

using rigs::alternating;
using rigs::Edge;
using rigs::Pads;

class SpiPinsTest : public ::testing::Test {
 protected:
  SpiPinsTest() { configure(one_, 0, enable); }
  static void configure(Spi& spi, std::uint32_t format, std::uint32_t control, unsigned bits = 8) {
    spi.write(cr1, 0);
    spi.write(cpsr, 10);
    spi.write(cr0, 1u << 8 | format | (bits - 1));  // SCR 1
    spi.write(cr1, control);
  }
  void connect_master() {
    for (const unsigned gpio : {0u, 1u, 2u, 3u}) rig_.connect(gpio, PinFunction::spi);
    pads_.clear();
  }
  /// SPI1 on GPIO 8 (RX), 9 (CSn), 10 (SCK), 11 (TX) as the slave of SPI0.
  void connect_slave() {
    for (const unsigned gpio : {8u, 9u, 10u, 11u}) rig_.connect(gpio, PinFunction::spi);
    for (const auto& [from, to] : {std::pair{1u, 9u}, {2u, 10u}, {3u, 8u}, {11u, 0u}})
      pads_.wire(from, to, rig_.wheel.now());
  }
  /// Each bit of SCK: high, then low, from `first` half bits after `t` on.
  static std::vector<Cycle> clock(Cycle t, Cycle first) {
    std::vector<Cycle> cycles;
    for (Cycle n = 0; n < 16; ++n) cycles.push_back(t + (first + n) * half);
    return cycles;
  }
  /// TX changes in these bits, half a bit after their beginning.
  static std::vector<Cycle> bits(Cycle t, const std::vector<Cycle>& numbers) {
    std::vector<Cycle> cycles;
    for (const Cycle n : numbers) cycles.push_back(t + n * bit + half);
    return cycles;
  }

  static constexpr Cycle bit = 10 * 2, half = bit / 2;  ///< CPSDVSR x (1 + SCR)
  rigs::DmaSystemRig rig_;
  Spi& one_ = rig_.system.spi0;
  Spi& two_ = rig_.system.spi1;
  Pads pads_{rig_.gpio};
};

// 4.4.3.10: TX half a bit after CSn, SCK rises another half later; captured at rising edges; CSn
// rises a bit after the last.
TEST_F(SpiPinsTest, WaveformWithPolarityZeroPhaseZero) {
  connect_master();
  EXPECT_TRUE(rig_.pad(1));
  EXPECT_FALSE(rig_.pad(2));
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0xa6);  // 1010 0110
  rig_.pass(20 * bit);
  EXPECT_EQ(pads_.edges[1], alternating(false, {t, t + 9 * bit}));
  EXPECT_EQ(pads_.edges[2], alternating(true, clock(t, 2)));
  EXPECT_EQ(pads_.edges[3], alternating(true, bits(t, {0, 1, 2, 3, 5, 7})));
}

// 4.4.3.11: SCK rises with the first bit, captured at falling edges; no gap between words, CSn low.
TEST_F(SpiPinsTest, WaveformWithPhaseOne) {
  configure(one_, sph, enable, 4);
  connect_master();
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0x9);
  one_.write(dr, 0x6);
  rig_.pass(20 * bit);
  EXPECT_EQ(pads_.edges[1], alternating(false, {t, t + 9 * bit}));
  EXPECT_EQ(pads_.edges[2], alternating(true, clock(t, 1)));
  EXPECT_EQ(pads_.edges[3], alternating(true, bits(t, {0, 1, 3, 4, 5, 7})));
}

TEST_F(SpiPinsTest, NothingIsDueOnceTheFrameIsOver) {
  connect_master();
  one_.write(dr, 0x55);
  rig_.pass(100 * bit);
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 1'000'000'000);
}

TEST_F(SpiPinsTest, RxIsReadFromThePin) {
  connect_master();
  pads_.wire(3, 0, rig_.wheel.now());  // MOSI to MISO
  one_.write(dr, 0xc5);
  rig_.pass(20 * bit);
  EXPECT_EQ(one_.read(dr), 0xc5u);
}

TEST_F(SpiPinsTest, TwoBlocksTalkInAllModes) {
  for (const std::uint32_t mode : {0u, sph, spo, spo | sph})
    for (const unsigned bits : {4u, 8u, 16u}) {
      configure(one_, mode, enable, bits);
      configure(two_, mode, enable | slave, bits);
      if (mode == 0 && bits == 4) {
        connect_master();
        connect_slave();
      }
      const std::uint32_t mask = (1u << bits) - 1;
      for (const std::uint32_t n : {0u, 1u, 2u}) {
        two_.write(dr, (0x8d31u * (n + 1)) & mask);
        one_.write(dr, (0x5aa6u + 0x1111u * n) & mask);
      }
      rig_.pass(100 * bit);
      for (const std::uint32_t n : {0u, 1u, 2u}) {
        ASSERT_NE(two_.read(sr) & rx_not_empty, 0u) << mode << ' ' << bits;
        EXPECT_EQ(two_.read(dr), (0x5aa6u + 0x1111u * n) & mask) << mode << ' ' << bits;
        EXPECT_EQ(one_.read(dr), (0x8d31u * (n + 1)) & mask) << mode << ' ' << bits;
      }
    }
}

// Beyond its FIFO a slave answers with zeroes; it never sends by itself.
TEST_F(SpiPinsTest, SlaveAnswersFromItsFifo) {
  connect_master();
  configure(two_, 0, enable | slave);
  connect_slave();
  two_.write(dr, 0x21);
  rig_.pass(100 * bit);
  EXPECT_EQ(two_.read(sr) & rx_not_empty, 0u);
  for (const std::uint32_t word : {0xaau, 0x55u}) one_.write(dr, word);
  rig_.pass(50 * bit);
  EXPECT_EQ(one_.read(dr), 0x21u);
  EXPECT_EQ(one_.read(dr), 0u);
  EXPECT_EQ(two_.read(dr), 0xaau);
  EXPECT_EQ(two_.read(dr), 0x55u);
}

// SOD keeps a slave's TX from driving.
TEST_F(SpiPinsTest, SlaveOutputOff) {
  connect_master();
  configure(two_, 0, enable | slave | output_off);
  connect_slave();
  two_.write(dr, 0xff);
  one_.write(dr, 0x12);
  rig_.pass(20 * bit);
  EXPECT_EQ(one_.read(dr), 0x00u) << "pulled down";
  EXPECT_EQ(two_.read(dr), 0x12u);
}

}  // namespace
}  // namespace lamplock::sim::chip::spi_pins_test
