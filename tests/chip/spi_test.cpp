// SPI by the RP2040 datasheet, 4.4, and the PL022 manual it reproduces: clk_peri is clk_sys.
#include "sim/chip/serial/spi.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::spi_test {
namespace {

constexpr std::uint32_t cr0 = 0x00, cr1 = 0x04, dr = 0x08, sr = 0x0c, cpsr = 0x10, imsc = 0x14,
                        ris = 0x18, mis = 0x1c, icr = 0x20;
constexpr std::uint32_t tx_empty = 1, tx_not_full = 2, rx_not_empty = 4, rx_full = 8, busy = 16;
constexpr std::uint32_t overrun = 1, timeout = 2, rx_half = 4, tx_half = 8;
constexpr std::uint32_t loop_back = 1, enable = 2;
constexpr std::uint32_t phase_1 = 1u << 7;
constexpr std::uint32_t size(std::uint32_t bits) { return bits - 1; }

class SpiTest : public ::testing::Test, public SpiDevice {
 protected:
  SpiTest() {
    spi_.connect(static_cast<SpiDevice&>(*this));
    spi_.write(cpsr, 10);
    spi_.write(cr0, 1u << 8 | phase_1 | size(8));  // SCR 1
    spi_.write(cr1, enable);
  }
  std::uint16_t word_exchanged(std::uint16_t word, unsigned bits, Cycle at) override {
    EXPECT_EQ(at, rig_.wheel.now());
    sent_.emplace_back(word, at);
    bits_ = bits;
    return static_cast<std::uint16_t>(~word);
  }
  bool line() const { return rig_.line(Irq::spi0); }

  static constexpr Cycle bit = 10 * 2;  ///< CPSDVSR x (1 + SCR)
  rigs::DmaSystemRig rig_;
  Spi& spi_ = rig_.system.spi0;
  std::vector<std::pair<unsigned, Cycle>> sent_;
  unsigned bits_ = 0;
};

TEST_F(SpiTest, WordsFollowEachOtherWithPhaseOne) {
  const Cycle from = rig_.wheel.now();
  EXPECT_EQ(spi_.bit_time(), static_cast<Picoseconds>(bit) * 8000);
  EXPECT_EQ(spi_.read(sr), tx_empty | tx_not_full);
  for (std::uint32_t n = 0; n < 3; ++n) spi_.write(dr, 0x150 + n);  // bits above the size are lost
  EXPECT_EQ(spi_.read(sr), tx_not_full | busy);
  rig_.pass(100 * bit);
  ASSERT_EQ(sent_.size(), 3u);
  for (unsigned n = 0; n < 3; ++n)
    EXPECT_EQ(sent_[n], std::make_pair(0x50 + n, from + (n + 1) * 8 * bit));
  EXPECT_EQ(bits_, 8u);
  for (std::uint32_t n = 0; n < 3; ++n) EXPECT_EQ(spi_.read(dr), 0xaf - n);
}

TEST_F(SpiTest, BusyUntilTheChipSelectIsHighAgain) {
  // 4.4.3.11: CSn rises one SCK period after the capture of the last bit.
  spi_.write(dr, 1);
  rig_.pass(9 * bit - 1);
  EXPECT_EQ(spi_.read(sr), tx_empty | tx_not_full | rx_not_empty | busy);
  rig_.pass(1);
  EXPECT_EQ(spi_.read(sr), tx_empty | tx_not_full | rx_not_empty);
}

TEST_F(SpiTest, PhaseZeroLiftsTheChipSelectBetweenWords) {
  spi_.write(cr0, 1u << 8 | size(8));
  const Cycle from = rig_.wheel.now();
  spi_.write(dr, 1);
  spi_.write(dr, 2);
  rig_.pass(100 * bit);
  ASSERT_EQ(sent_.size(), 2u);
  EXPECT_EQ(sent_[0].second, from + 8 * bit);
  EXPECT_EQ(sent_[1].second, from + 16 * bit + bit * Spi::gap_half_bits / 2);
}

TEST_F(SpiTest, SizesRatesAndItsOwnClock) {
  rig_.start_adc_and_rtc_clocks();
  rig_.system.clocks.write(0x48, 1u << 11 | 2u << 5);  // clk_peri: PLL_USB, 48 MHz
  spi_.write(cr0, 4u << 8 | phase_1 | size(16));
  spi_.write(cpsr, 3);  // the lowest bit is not stored
  EXPECT_EQ(spi_.read(cpsr), 2u);
  const Cycle from = rig_.wheel.now();
  for (std::uint32_t n = 0; n < 6; ++n) spi_.write(dr, 0xbeef);
  rig_.pass(100'000);
  ASSERT_EQ(sent_.size(), 6u);
  // 16 bits of 10 cycles of 48 MHz in cycles of 125 MHz, without drift.
  for (unsigned n = 0; n < 6; ++n)
    EXPECT_EQ(sent_[n].second, from + ((n + 1) * 160 * 125 + 47) / 48) << n;
  EXPECT_EQ(sent_[0].first, 0xbeefu);
  EXPECT_EQ(bits_, 16u);
}

TEST_F(SpiTest, TheTransmitFifoHoldsEightAndInterruptsAtHalf) {
  spi_.write(imsc, tx_half);
  EXPECT_TRUE(line());
  for (std::uint32_t n = 0; n < 9; ++n) spi_.write(dr, n);  // one in the shifter
  EXPECT_EQ(spi_.read(sr), busy);
  EXPECT_FALSE(line());
  rig_.reports.clear();
  spi_.write(dr, 9);
  EXPECT_EQ(rig_.reports.size(), 1u);
  rig_.pass(4 * 8 * bit - 1);
  EXPECT_FALSE(line());
  rig_.pass(1);
  EXPECT_TRUE(line()) << "four are left";
  EXPECT_EQ(spi_.read(mis), tx_half);
}

TEST_F(SpiTest, TheReceiverInterruptsAtHalfByTimeoutAndByOverrun) {
  spi_.write(imsc, rx_half | timeout | overrun);
  for (std::uint32_t n = 0; n < 5; ++n) spi_.write(dr, n);
  rig_.pass(4 * 8 * bit - 1);
  EXPECT_FALSE(line());
  rig_.pass(1);
  EXPECT_EQ(spi_.read(mis), rx_half);
  rig_.pass(8 * bit);
  for (std::uint32_t n = 0; n < 4; ++n) spi_.read(dr);
  EXPECT_FALSE(line());
  rig_.pass(32 * bit - 1);  // with an idle line and no read
  EXPECT_FALSE(line());
  rig_.pass(1);
  EXPECT_EQ(spi_.read(mis), timeout);
  spi_.write(icr, timeout);
  EXPECT_FALSE(line());
  for (std::uint32_t n = 0; n < 8; ++n) spi_.write(dr, n);
  rig_.pass(8 * 8 * bit);
  EXPECT_NE(spi_.read(sr) & rx_full, 0u);
  EXPECT_EQ(spi_.read(ris) & overrun, overrun);
  EXPECT_EQ(spi_.read(dr), 0xfbu) << "the word before; the ninth is lost";
  spi_.write(icr, overrun);
  EXPECT_EQ(spi_.read(ris) & overrun, 0u);
}

TEST_F(SpiTest, LoopBackDisablingAndReset) {
  spi_.write(cr1, 0);
  spi_.write(dr, 0x12);
  rig_.pass(100 * bit);
  EXPECT_EQ(spi_.read(sr), tx_not_full | busy);
  spi_.write(cr1, enable | loop_back);
  rig_.pass(8 * bit);
  EXPECT_EQ(spi_.read(dr), 0x12u);
  EXPECT_TRUE(sent_.empty());
  rig_.pass(bit);
  spi_.write(dr, 0x34);
  spi_.write(cr1, loop_back);  // the word in progress is finished
  rig_.pass(8 * bit);
  EXPECT_EQ(spi_.read(dr), 0x34u);
  spi_.reset();
  EXPECT_EQ(spi_.read(sr), 3u);
  EXPECT_EQ(spi_.read(ris), 8u);
  EXPECT_EQ(spi_.read(0xfe0), 0x22u);
}

}  // namespace
}  // namespace lamplock::sim::chip::spi_test
