// Clocks on pins, resuscitation, frequency counter, ring oscillator and the order of resets (RP2040
// datasheet, 2.13, 2.15 and 2.17).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/chip/listeners.hpp"
#include "tests/chip/system_rig.hpp"

namespace lamplock::sim::chip::clock_pins_test {
namespace {

constexpr std::uint32_t gpout0 = 0x00, gpout_bytes = 0x0c, sys_control = 0x3c, peri_control = 0x48,
                        resus_control = 0x78, resus_status = 0x7c, fc0_reference = 0x80,
                        fc0_interval = 0x90, fc0_source = 0x94, fc0_status = 0x98,
                        fc0_result = 0x9c, wake_0 = 0xa0, intr = 0xb8, inte = 0xbc, ints = 0xc4;
constexpr std::uint32_t enable = 1u << 11;
/// AUXSRC of GPOUT.
enum Source : std::uint32_t { pll_sys, gpin0, gpin1, pll_usb, rosc, xosc, clk_sys };

using rigs::Edge;

class ClockPinsTest : public ::testing::Test {
 protected:
  ClockPinsTest() { rig_.start_clocks(); }
  void connect(unsigned gpio) { rig_.connect(gpio, PinFunction::clock); }
  void output(unsigned n, Source source, std::uint32_t divider) {
    clocks_.write(gpout0 + gpout_bytes * n + 4, divider);
    clocks_.write(gpout0 + gpout_bytes * n, enable | source << 5);
  }
  bool reported(const std::string& text) const {
    return std::any_of(rig_.reports.begin(), rig_.reports.end(), [&](const std::string& report) {
      return report.find(text) != std::string::npos;
    });
  }
  /// Result of FC0: the frequency in 1/32 kHz.
  std::uint32_t count(std::uint32_t source, std::uint32_t interval) {
    clocks_.write(fc0_reference, 12'000);
    clocks_.write(fc0_interval, interval);
    clocks_.write(fc0_source, source);
    rig_.pass_time(40 * ps_per_ms);
    EXPECT_EQ(clocks_.read(fc0_status) & 1u << 4, 1u << 4);
    return clocks_.read(fc0_result);
  }

  rigs::SystemRig rig_;
  Clocks& clocks_ = rig_.system.clocks;
  rigs::Pads pads_{rig_.gpio};
};

// 2.15.3.4: GPIO 21, 23, 24, 25; 24.8 dividers.
TEST_F(ClockPinsTest, OutputsAreOnTheirPins) {
  const std::array<unsigned, 4> pins{21, 23, 24, 25};
  for (unsigned n = 0; n < 4; ++n) {
    connect(pins[n]);
    const Cycle t = rig_.wheel.now();
    output(n, clk_sys, (10 * (n + 1)) << 8);
    rig_.pass(200);
    const Cycle half = 5 * (n + 1);
    ASSERT_GE(pads_.edges[pins[n]].size(), 4u);
    for (Cycle edge = 0; edge < 4; ++edge)
      EXPECT_EQ(pads_.edges[pins[n]][edge], Edge(edge % 2 == 0, t + half * (edge + 1))) << n;
  }
  EXPECT_TRUE(rig_.reports.empty());
}

// 12 MHz / 12 000 = 1 kHz: always 125 000 cycles of clk_sys.
TEST_F(ClockPinsTest, OutputOfAnotherSourceDoesNotDrift) {
  connect(21);
  const Cycle t = rig_.wheel.now();
  output(0, xosc, 12'000u << 8);
  rig_.pass(12'500'000);
  ASSERT_EQ(pads_.edges[21].size(), 200u);
  EXPECT_EQ(pads_.edges[21].back(), Edge(false, t + 12'500'000));
  EXPECT_EQ(pads_.edges[21][100], Edge(true, t + 101 * 62'500));
}

// A divisor of 10.5 on average: 21 half periods are 110.25 cycles.
TEST_F(ClockPinsTest, FractionalDivider) {
  connect(21);
  const Cycle t = rig_.wheel.now();
  output(0, clk_sys, 10u << 8 | 0x80);
  rig_.pass(1050);
  ASSERT_EQ(pads_.edges[21].size(), 200u);
  EXPECT_EQ(pads_.edges[21].back().second, t + 1050);
}

TEST_F(ClockPinsTest, FasterThanHalfOfTheSystemClockIsReported) {
  connect(21);
  output(0, clk_sys, 2u << 8);
  rig_.pass(10);
  EXPECT_GE(pads_.edges[21].size(), 8u);
  EXPECT_TRUE(rig_.reports.empty());
  output(0, clk_sys, 1u << 8);
  EXPECT_TRUE(reported("GPOUT0"));
}

// Half of clk_sys follows clk_sys down and up again; half of 125 MHz is more than half of 12 MHz.
TEST_F(ClockPinsTest, AnOutputFromTheSystemClockIsNeverTooFastAfterAChange) {
  connect(21);
  output(0, clk_sys, 2u << 8);
  clocks_.write(sys_control, 0);  // clk_ref
  rig_.pass(20);
  EXPECT_EQ(clocks_.hz(Clock::sys), 12'000'000u);
  EXPECT_GE(pads_.edges[21].size(), 8u);
  clocks_.write(sys_control, 1);
  rig_.pass(20);
  EXPECT_EQ(clocks_.hz(Clock::sys), 125'000'000u);
  EXPECT_TRUE(rig_.reports.empty());
}

TEST_F(ClockPinsTest, AnOutputThatStaysIsReportedOnceTheSystemClockIsTooSlowForIt) {
  connect(21);
  output(0, pll_sys, 4u << 8);
  rig_.pass(10);
  EXPECT_TRUE(rig_.reports.empty());
  clocks_.write(sys_control, 0);
  rig_.pass(20);
  EXPECT_TRUE(reported("GPOUT0"));
}

TEST_F(ClockPinsTest, OutputOnNoPinCostsNothing) {
  output(0, clk_sys, 10u << 8);
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 1'000'000);
  rig_.pass(1007);  // 201 half periods: high
  connect(21);
  EXPECT_EQ(pads_.edges[21].size(), 1u);
  EXPECT_TRUE(rig_.pad(21));
  rig_.pass(3);
  EXPECT_FALSE(rig_.pad(21));
}

TEST_F(ClockPinsTest, InputsAreSources) {
  clocks_.set_input_hz(0, 10'000'000);
  clocks_.set_input_hz(1, 32'768);
  clocks_.write(peri_control, enable | 5u << 5);  // GPIN0
  EXPECT_EQ(clocks_.hz(Clock::peri), 0u) << "the pin has another function";
  connect(20);
  EXPECT_EQ(clocks_.hz(Clock::peri), 10'000'000u);
  clocks_.write(0x6c, enable | 5u << 5);  // clk_rtc from GPIN1
  connect(22);
  EXPECT_EQ(clocks_.hz(Clock::rtc), 32'768u);
  EXPECT_EQ(count(6, 10), 10'000u << 5);
}

// 2.15.6.2: 0.98 us times 2^INTERVAL; an edge is 1024 kHz / 2^INTERVAL, RESULT 1/32 kHz.
TEST_F(ClockPinsTest, CounterIsAsExactAsItsInterval) {
  clocks_.set_input_hz(0, 46'875);
  connect(20);
  EXPECT_EQ(count(6, 15), 46'875u * 32 / 1000);
  EXPECT_EQ(count(6, 10), 46u << 5);
  EXPECT_EQ(count(6, 8), 44u << 5);
  EXPECT_EQ(count(6, 0), 0u);
  EXPECT_EQ(count(5, 0), 11u << 15) << "12 MHz";
}

// 2.15.5: clk_sys stops; after TIMEOUT cycles of clk_ref it is clk_ref.
TEST_F(ClockPinsTest, ResuscitationForcesTheReference) {
  clocks_.write(inte, 1);
  clocks_.write(resus_control, 1u << 8 | 120);
  const Picoseconds before = rig_.wheel.time();
  rig_.system.pll_sys.write(0x4, 0x2d);  // power down
  rig_.pass(1);
  EXPECT_EQ(clocks_.read(resus_status), 1u);
  EXPECT_EQ(rig_.wheel.frequency(), 12'000'000u);
  EXPECT_EQ(rig_.wheel.time() - before, 10 * ps_per_us) << "120 cycles";
  EXPECT_TRUE(rig_.line(Irq::clocks));
  EXPECT_EQ(clocks_.read(ints), 1u);
  // As a handler does: clk_sys to clk_ref, then CLEAR.
  clocks_.write(sys_control, 0);
  rig_.pass(10);
  clocks_.write(resus_control, 1u << 8 | 1u << 16 | 120);
  clocks_.write(resus_control, 1u << 8 | 120);
  EXPECT_EQ(clocks_.read(resus_status), 0u);
  EXPECT_EQ(clocks_.read(intr), 0u);
  EXPECT_FALSE(rig_.line(Irq::clocks));
  EXPECT_EQ(rig_.wheel.frequency(), 12'000'000u);
  EXPECT_TRUE(rig_.reports.empty());
}

TEST_F(ClockPinsTest, ResuscitationCanBeForced) {
  clocks_.write(resus_control, 1u << 12);
  EXPECT_EQ(rig_.wheel.frequency(), 12'000'000u);
  clocks_.write(resus_control, 1u << 16);
  EXPECT_EQ(rig_.wheel.frequency(), 125'000'000u);
}

// A stopped clock is reported only for a block in use.
TEST_F(ClockPinsTest, StoppedClocksOfBlocksInUseAreNamed) {
  clocks_.write(wake_0, ~(1u << 12));  // clk_sys_pio0, held in reset
  EXPECT_TRUE(rig_.reports.empty());
  rig_.system.resets.write(0, ~(1u << 10));
  clocks_.write(wake_0, ~(1u << 12));
  EXPECT_TRUE(reported("clk_sys_pio0"));
  EXPECT_FALSE(reported("clk_sys_pio1"));
}

// 2.17.3: stages 0-7, 2-7, 4-7, 6-7. 2.17.4: each bit adds to the drive of a stage.
TEST_F(ClockPinsTest, RingOscillatorFollowsStagesAndDrive) {
  Rosc& ring = rig_.system.rosc;
  EXPECT_EQ(ring.hz(), 6'500'000u);
  for (const auto& [range, stages] : {std::make_pair(0xfa4u, 8u), std::make_pair(0xfa5u, 6u),
                                      std::make_pair(0xfa7u, 4u), std::make_pair(0xfa6u, 2u)}) {
    ring.write(0x0, 0xfab000 | range);
    EXPECT_EQ(ring.hz(), 104'000'000u * 8 / stages / 16) << range;
  }
  ring.write(0x0, 0xfabfa4);
  for (const auto& [bits, drive] :
       {std::make_pair(0x1111u, 2u), std::make_pair(0x3333u, 3u), std::make_pair(0x7777u, 4u)}) {
    ring.write(0x4, 0x9696'0000 | bits);
    ring.write(0x8, 0x9696'0000 | bits);
    EXPECT_EQ(ring.hz(), 6'500'000u * drive);
  }
  ring.write(0x4, 0x7777);  // without the password: as if no bit were set
  // 8 / (4 + 4 / 4) of the nominal frequency.
  EXPECT_EQ(ring.hz(), 10'400'000u);
}

// 2.13.1: a stage's reset is released when the stage before it is done.
TEST_F(ClockPinsTest, AStageAlsoResetsLaterStages) {
  std::string calls;
  const auto note = [&calls](char stage) {
    return [&calls, stage](bool held) {
      calls += held ? '-' : '+';
      calls += stage;
    };
  };
  Psm& psm = rig_.system.psm;
  psm.attach(PsmBit::rom, note('r'));
  psm.attach(PsmBit::sram3, note('m'));
  psm.attach(PsmBit::sio, note('s'));
  psm.attach(PsmBit::proc0, note('0'));
  psm.attach(PsmBit::proc1, note('1'));
  psm.write(0x4, 1u << 16);  // FRCE_OFF PROC1: only that core
  EXPECT_EQ(calls, "-1");
  EXPECT_EQ(psm.read(0xc), 0x0ffffu);
  psm.write(0x4, 0);
  EXPECT_EQ(calls, "-1+1");
  calls.clear();
  psm.write(0x4, 1u << 9);  // SRAM3
  EXPECT_EQ(calls, "-m-s-0-1");
  EXPECT_EQ(psm.read(0xc), 0x001ffu);
  psm.write(0x4, 0);
  EXPECT_EQ(calls, "-m-s-0-1+m+s+0+1");
  calls.clear();
  psm.write(0x8, 1u << 14 | 1u << 15);  // WDSEL: SIO and PROC0
  psm.watchdog_hold();
  psm.watchdog_release();
  EXPECT_EQ(calls, "-s-0-1+s+0+1");
}

}  // namespace
}  // namespace lamplock::sim::chip::clock_pins_test
