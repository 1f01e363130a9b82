// SPI on its pins (RP2040 datasheet, 4.4.3.9 to 4.4.3.13 and 2.19.2).
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "sim/chip/serial/spi.hpp"
#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::spi_pins_test {
namespace {

constexpr std::uint32_t cr0 = 0x00, cr1 = 0x04, dr = 0x08, sr = 0x0c, cpsr = 0x10;
constexpr std::uint32_t spo = 1u << 6, sph = 1u << 7;
constexpr std::uint32_t enable = 2, slave = 4, output_off = 8, rx_not_empty = 4;

using Edge = std::pair<bool, Cycle>;
/// Records the pads, and has wires between them.
struct Board : PadListener {
  explicit Board(Gpio& pins) : gpio(pins) { gpio.listen(*this); }
  void pad_changed(unsigned pin, bool level, Cycle at) override {
    by_pin.at(pin).emplace_back(level, at);
    for (const auto& [from, to] : wires)
      if (from == pin) gpio.set_external(to, level ? External::high : External::low, at);
  }
  void wire(unsigned from, unsigned to, Cycle at) {
    wires.emplace_back(from, to);
    gpio.set_external(to, (gpio.pad_levels() >> from & 1u) != 0 ? External::high : External::low,
                      at);
  }
  Gpio& gpio;
  std::array<std::vector<Edge>, gpio_count> by_pin;
  std::vector<std::pair<unsigned, unsigned>> wires;
};

class SpiPinsTest : public ::testing::Test {
 protected:
  SpiPinsTest() { configure(one_, 0, enable); }
  static void configure(Spi& spi, std::uint32_t format, std::uint32_t control, unsigned bits = 8) {
    spi.write(cr1, 0);
    spi.write(cpsr, 10);
    spi.write(cr0, 1u << 8 | format | (bits - 1));  // SCR 1
    spi.write(cr1, control);
  }
  void connect(unsigned gpio) { rig_.gpio.io_bank().write(8 * gpio + 4, 1); }
  void connect_master() {
    for (const unsigned gpio : {0u, 1u, 2u, 3u}) connect(gpio);
    for (auto& edges : board_.by_pin) edges.clear();
  }
  /// SPI1 on GPIO 8 (RX), 9 (CSn), 10 (SCK), 11 (TX) as the slave of SPI0.
  void connect_slave() {
    for (const unsigned gpio : {8u, 9u, 10u, 11u}) connect(gpio);
    board_.wire(1, 9, rig_.wheel.now());
    board_.wire(2, 10, rig_.wheel.now());
    board_.wire(3, 8, rig_.wheel.now());
    board_.wire(11, 0, rig_.wheel.now());
  }
  bool pad(unsigned gpio) const { return (rig_.gpio.pad_levels() >> gpio & 1u) != 0; }

  static constexpr Cycle bit = 10 * 2, half = bit / 2;  ///< CPSDVSR x (1 + SCR)
  rigs::DmaSystemRig rig_;
  Spi& one_ = rig_.system.spi0;
  Spi& two_ = rig_.system.spi1;
  Board board_{rig_.gpio};
};

// 4.4.3.10: TX half a bit after CSn, SCK rises another half later; captured at rising edges; CSn
// rises a bit after the last.
TEST_F(SpiPinsTest, WaveformWithPolarityZeroPhaseZero) {
  connect_master();
  EXPECT_TRUE(pad(1));
  EXPECT_FALSE(pad(2));
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0xa6);  // 1010 0110
  rig_.pass(20 * bit);
  EXPECT_EQ(board_.by_pin[1], (std::vector<Edge>{{false, t}, {true, t + 9 * bit}}));
  std::vector<Edge> clock;
  for (Cycle n = 1; n <= 8; ++n) {
    clock.emplace_back(true, t + n * bit);
    clock.emplace_back(false, t + n * bit + half);
  }
  EXPECT_EQ(board_.by_pin[2], clock);
  const auto at = [&](Cycle n) { return t + n * bit + half; };
  EXPECT_EQ(board_.by_pin[3], (std::vector<Edge>{{true, at(0)},
                                                 {false, at(1)},
                                                 {true, at(2)},
                                                 {false, at(3)},
                                                 {true, at(5)},
                                                 {false, at(7)}}));
}

// 4.4.3.11: SCK rises with the first bit, captured at falling edges; no gap between words, CSn low.
TEST_F(SpiPinsTest, WaveformWithPhaseOne) {
  configure(one_, sph, enable, 4);
  connect_master();
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0x9);
  one_.write(dr, 0x6);
  rig_.pass(20 * bit);
  EXPECT_EQ(board_.by_pin[1], (std::vector<Edge>{{false, t}, {true, t + 9 * bit}}));
  std::vector<Edge> clock;
  for (Cycle n = 0; n < 8; ++n) {
    clock.emplace_back(true, t + n * bit + half);
    clock.emplace_back(false, t + (n + 1) * bit);
  }
  EXPECT_EQ(board_.by_pin[2], clock);
  const auto at = [&](Cycle n) { return t + n * bit + half; };
  EXPECT_EQ(board_.by_pin[3], (std::vector<Edge>{{true, at(0)},
                                                 {false, at(1)},
                                                 {true, at(3)},
                                                 {false, at(4)},
                                                 {true, at(5)},
                                                 {false, at(7)}}));
}

// 4.4.3.12, 4.4.3.13: SPO inverts SCK; with SPH 0 CSn is high between words.
TEST_F(SpiPinsTest, PolarityOneAndChipSelectBetweenWords) {
  configure(one_, spo, enable, 4);
  connect_master();
  EXPECT_TRUE(pad(2));
  const Cycle t = rig_.wheel.now();
  one_.write(dr, 0xf);
  one_.write(dr, 0x0);
  rig_.pass(20 * bit);
  ASSERT_EQ(board_.by_pin[1].size(), 4u);
  EXPECT_EQ(board_.by_pin[1][1], Edge(true, t + 5 * bit));
  EXPECT_EQ(board_.by_pin[1][2], Edge(false, t + 5 * bit + half));
  ASSERT_EQ(board_.by_pin[2].size(), 16u);
  EXPECT_EQ(board_.by_pin[2].front(), Edge(false, t + bit));
  EXPECT_TRUE(pad(2));
}

TEST_F(SpiPinsTest, NothingIsDueOnceTheFrameIsOver) {
  connect_master();
  one_.write(dr, 0x55);
  rig_.pass(100 * bit);
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 1'000'000'000);
}

TEST_F(SpiPinsTest, RxIsReadFromThePin) {
  connect_master();
  board_.wire(3, 0, rig_.wheel.now());  // MOSI to MISO
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
