#include "sim/chip/system/clocks.hpp"

#include <gtest/gtest.h>

#include "tests/chip/system_rig.hpp"

namespace lamplock::sim::chip::clocks_test {
namespace {

class ClocksTest : public ::testing::Test {
 protected:
  System& system() { return rig_.system; }
  rigs::SystemRig rig_;
};

TEST_F(ClocksTest, TheChipStartsOnTheRingOscillator) {
  EXPECT_EQ(rig_.wheel.frequency(), 6'500'000u);
  EXPECT_EQ(system().clocks.hz(Clock::ref), 6'500'000u);
  EXPECT_EQ(system().clocks.hz(Clock::peri), 0u);
  EXPECT_EQ(system().clocks.read(0x38), 1u);
  EXPECT_EQ(system().rosc.read(0x18), 0x80011000u);
  system().rosc.write(0x10, 0xaa0 + 8);
  EXPECT_EQ(rig_.wheel.frequency(), 13'000'000u);
  system().rosc.write(0x10, 8);  // no password: 31
  EXPECT_EQ(rig_.wheel.frequency(), 104'000'000u / 31);
  EXPECT_NE(system().rosc.read(0x18) & 1u << 24, 0u);
}

TEST_F(ClocksTest, CrystalIsStableAfterItsStartupDelay) {
  EXPECT_EQ(system().xosc.read(0xc), 0xc4u);
  system().xosc.write(0xc, 47);  // 47 * 256 / 12 MHz = 1.00267 ms
  system().xosc.write(0x0, 0xfabaa0);
  EXPECT_EQ(system().xosc.read(0x4), 1u << 12);
  rig_.pass_time(1'002'600'000);
  EXPECT_EQ(system().xosc.read(0x4), 1u << 12);
  rig_.pass_time(200'000);
  EXPECT_EQ(system().xosc.read(0x4), 1u << 31 | 1u << 12);
  system().xosc.write(0x1c, 12);  // COUNT: 1 us
  rig_.pass_time(500'000);
  EXPECT_GT(system().xosc.read(0x1c), 0u);
  rig_.pass_time(600'000);
  EXPECT_EQ(system().xosc.read(0x1c), 0u);
}

TEST_F(ClocksTest, MultiplexerSwitchesWithoutGlitchAfterADelay) {
  rig_.start_clocks();
  system().clocks.write(0x3c, 0);
  EXPECT_EQ(system().clocks.read(0x44), 2u);
  EXPECT_EQ(rig_.wheel.frequency(), 125'000'000u);
  rig_.pass(Clocks::mux_cycles);
  EXPECT_EQ(system().clocks.read(0x44), 1u);
  EXPECT_EQ(rig_.wheel.frequency(), 12'000'000u);
}

TEST_F(ClocksTest, MultiplexerKeepsItsSourceIfTheNewOneIsStopped) {
  system().clocks.write(0x3c, 1);  // PLL_SYS is off
  rig_.pass(100);
  EXPECT_EQ(system().clocks.read(0x44), 1u);
  EXPECT_EQ(rig_.wheel.frequency(), 6'500'000u);
  EXPECT_EQ(rig_.reports.size(), 1u);
}

TEST_F(ClocksTest, DividersDivide) {
  rig_.start_clocks();
  system().clocks.write(0x40, 0x280);  // clk_sys / 2.5
  EXPECT_EQ(rig_.wheel.frequency(), 50'000'000u);
  system().clocks.write(0x40, 0x100);
  system().clocks.write(0x34, 0x300);  // clk_ref / 3
  EXPECT_EQ(system().clocks.hz(Clock::ref), 4'000'000u);
}

TEST_F(ClocksTest, PllLocksOnlyWhenPoweredAndFedBack) {
  system().xosc.write(0xc, 1);
  system().xosc.write(0x0, 0xfabaa0);
  rig_.pass_time(ps_per_ms);
  Pll& pll = system().pll_usb;
  EXPECT_EQ(pll.read(4), 0x2du);
  EXPECT_EQ(pll.read(0xc), 0x77000u);
  pll.write(0x8, 100);
  rig_.pass_time(ps_per_ms);
  EXPECT_EQ(pll.read(0), 1u);
  pll.write(0x4, 1u << 3);  // post dividers still off
  EXPECT_EQ(pll.read(0), 1u);
  rig_.pass_time(ps_per_ms);
  EXPECT_EQ(pll.read(0), 1u << 31 | 1u);
  EXPECT_EQ(pll.hz(), 0u);
  pll.write(0xc, 5u << 16 | 5u << 12);
  pll.write(0x4, 0);
  EXPECT_EQ(pll.hz(), 48'000'000u);
  EXPECT_TRUE(rig_.reports.empty());
  pll.write(0x8, 16);  // 192 MHz
  EXPECT_EQ(rig_.reports.size(), 1u);
}

TEST_F(ClocksTest, FrequencyCounterMeasures) {
  rig_.start_clocks();
  system().clocks.write(0x80, 12000);
  system().clocks.write(0x90, 10);  // about 1 ms
  system().clocks.write(0x94, 9);   // clk_sys
  EXPECT_EQ(system().clocks.read(0x98), 1u << 8);
  rig_.pass_time(ps_per_ms * 11 / 10);
  EXPECT_EQ(system().clocks.read(0x98), 1u << 4 | 1u);
  EXPECT_EQ(system().clocks.read(0x9c), 125'000u << 5);
  system().clocks.write(0x88, 100'000);
  EXPECT_EQ(system().clocks.read(0x98), 1u << 4 | 1u << 16 | 1u << 24);
}

TEST_F(ClocksTest, BlocksInResetDoNotAnswer) {
  int resets = 0;
  struct Block : Peripheral {
    explicit Block(int& count) : resets(count) {}
    std::string_view name() const override { return "BLOCK"; }
    std::uint32_t read(std::uint32_t) override { return value; }
    std::uint32_t peek(std::uint32_t) const override { return value; }
    void write(std::uint32_t, std::uint32_t written) override { value = written; }
    std::uint32_t write_clear_bits(std::uint32_t) const override { return 0; }
    void reset() override { value = 0, ++resets; }
    std::uint32_t value = 0;
    int& resets;
  } block(resets);
  Resets& reset_block = system().resets;
  Peripheral& gate = reset_block.attach(ResetBit::dma, block);
  EXPECT_EQ(reset_block.read(0), 0x1ffffffu);
  EXPECT_EQ(reset_block.read(8), 0u);
  gate.write(0, 5);
  EXPECT_EQ(gate.read(0), 0u);
  EXPECT_FALSE(rig_.reports.empty());
  reset_block.write(0, 0x1ffffff & ~(1u << 2));
  EXPECT_EQ(reset_block.read(8), 1u << 2);
  gate.write(0, 5);
  EXPECT_EQ(gate.read(0), 5u);
  reset_block.write(0, 0x1ffffff);
  EXPECT_EQ(gate.peek(0), 0u);
  EXPECT_EQ(resets, 2) << "when released and when held again";
}

// The identification of the chip: chip_images/system.
TEST_F(ClocksTest, TheDebuggerIsNotInReset) { EXPECT_EQ(system().syscfg.read(8), 0x10000000u); }

}  // namespace
}  // namespace lamplock::sim::chip::clocks_test
