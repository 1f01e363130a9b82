// The ADC by the RP2040 datasheet, 4.9: clk_adc at 48 MHz, clk_sys at 125 MHz.
#include "sim/chip/analog/adc.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/chip/dma_system_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::adc_test {
namespace {

constexpr std::uint32_t cs = 0x00, result = 0x04, fcs = 0x08, fifo = 0x0c, divider = 0x10,
                        intr = 0x14, inte = 0x18, ints = 0x20;
constexpr std::uint32_t enable = 1, sensor = 2, once = 4, many = 8, ready = 1u << 8,
                        error = 1u << 9, error_sticky = 1u << 10;
constexpr std::uint32_t fifo_on = 1, fifo_shift = 2, fifo_error = 4, fifo_dreq = 8,
                        fifo_empty = 1u << 8, fifo_full = 1u << 9, fifo_under = 1u << 10,
                        fifo_over = 1u << 11;
constexpr std::uint32_t base = 0x4004'c000;
constexpr std::uint32_t input(std::uint32_t number) { return number << 12; }
constexpr std::uint32_t round_robin(std::uint32_t inputs) { return inputs << 16; }
constexpr std::uint32_t threshold(std::uint32_t level) { return level << 24; }

class AdcTest : public ::testing::Test {
 protected:
  AdcTest() {
    rig_.start_adc_and_rtc_clocks();
    origin_ = rig_.wheel.now();
    adc_.write(cs, enable);
    align();
  }
  /// Advances to a cycle in which edges of clk_adc and clk_sys coincide: one each microsecond.
  void align() { rig_.wheel.advance_to(origin_ + (rig_.wheel.now() - origin_ + 125) / 125 * 125); }
  std::uint32_t convert(std::uint32_t number) {
    adc_.write(cs, enable | sensor | input(number) | once);
    rig_.pass(300);
    return adc_.read(result);
  }
  bool line() const { return rig_.line(Irq::adc_fifo); }
  /// Cycles from now until the interrupt.
  Cycle until_line(Cycle most) {
    const Cycle from = rig_.wheel.now();
    while (!line() && rig_.wheel.now() < from + most) rig_.pass(1);
    return rig_.wheel.now() - from;
  }

  /// 96 cycles of 48 MHz in cycles of 125 MHz (4.9.1: 2 us a sample).
  static constexpr Cycle conversion = 250;
  rigs::DmaSystemRig rig_;
  Adc& adc_ = rig_.system.adc;
  Cycle origin_ = 0;
};

TEST_F(AdcTest, AConversionTakesNinetySixCyclesOfItsClock) {
  EXPECT_EQ(adc_.read(cs), enable | ready);
  adc_.set_input(1, 1.0);
  adc_.write(cs, enable | input(1) | once);
  EXPECT_EQ(adc_.read(cs), enable | input(1));
  rig_.pass(conversion - 1);
  EXPECT_EQ(adc_.read(cs) & ready, 0u);
  rig_.pass(1);
  EXPECT_EQ(adc_.read(cs), enable | input(1) | ready) << "START_ONCE clears itself";
  EXPECT_EQ(adc_.read(result), 1241u);  // 1.0 / 3.3 * 4096 = 1241.2
}

TEST_F(AdcTest, AStartWaitsForTheNextEdgeOfItsClock) {
  rig_.pass(1);  // 8 ns after an edge; the next one is 20.83 ns after it
  adc_.write(cs, enable | once);
  // 97 cycles of clk_adc after the edge: 2020.83 ns, so 252.6 cycles, of which one has passed.
  rig_.pass(251);
  EXPECT_EQ(adc_.read(cs) & ready, 0u);
  rig_.pass(1);
  EXPECT_NE(adc_.read(cs) & ready, 0u);
}

TEST_F(AdcTest, VoltsAndDegreesBecomeCodes) {
  const std::vector<std::pair<double, std::uint32_t>> table{
      {-1, 0}, {0, 0}, {0.0009, 1}, {1.65, 2048}, {3.2999, 4095}, {3.3, 4095}, {9, 4095}};
  for (const auto& [volts, code] : table) {
    adc_.set_input(3, volts);
    EXPECT_EQ(convert(3), code) << volts;
  }
  // 4.9.5: T = 27 - (V - 0.706) / 0.001721.
  EXPECT_EQ(convert(4), 876u);  // 0.706 V
  adc_.set_temperature(60);
  EXPECT_EQ(convert(4), 805u);  // 0.6492 V
  for (const std::string& report : rig_.reports) ADD_FAILURE() << report;
  EXPECT_EQ(convert(5), 0u);
  EXPECT_EQ(rig_.reports.size(), 1u);
  adc_.write(cs, enable | input(4) | once);
  EXPECT_EQ(rig_.reports.size(), 2u) << "the sensor has no power";
}

TEST_F(AdcTest, FreeRunningFillsTheFifoAndOverflows) {
  adc_.set_input(0, 1.65);
  adc_.write(fcs, fifo_on | threshold(4));
  adc_.write(inte, 1);
  adc_.write(cs, enable | many);
  EXPECT_EQ(until_line(10'000), 4 * conversion);
  EXPECT_EQ(adc_.read(fcs), fifo_on | threshold(4) | 4u << 16 | fifo_full);
  EXPECT_EQ(adc_.read(ints), 1u);
  rig_.pass(conversion);
  EXPECT_NE(adc_.read(fcs) & fifo_over, 0u);
  adc_.write(cs, enable);
  rig_.pass(conversion);
  EXPECT_EQ(adc_.read(fifo), 2048u);
  EXPECT_FALSE(line());
  EXPECT_EQ(adc_.read(intr), 0u);
  for (int n = 0; n < 3; ++n) EXPECT_EQ(adc_.read(fifo), 2048u);
  EXPECT_NE(adc_.read(fcs) & fifo_empty, 0u);
  EXPECT_EQ(adc_.read(fcs) & fifo_under, 0u);
  adc_.read(fifo);
  EXPECT_NE(adc_.read(fcs) & fifo_under, 0u);
  adc_.write(fcs, fifo_on | fifo_under);
  EXPECT_EQ(adc_.read(fcs) & (fifo_under | fifo_over), fifo_over);
}

TEST_F(AdcTest, TheDividerPacesWithItsFraction) {
  // 4.9.2.4, DIV: total period 1 + INT + FRAC / 256; first-order delta-sigma.
  struct Case {
    std::uint32_t whole, fraction;
  };
  for (const Case& c :
       {Case{47'999, 0}, Case{127, 128}, Case{200, 1}, Case{95, 255}, Case{10, 7}}) {
    adc_.write(cs, enable);
    rig_.pass(conversion);
    adc_.write(divider, c.whole << 8 | c.fraction);
    adc_.write(inte, 1);
    adc_.write(fcs, fifo_on | threshold(1));
    align();
    const Cycle from = rig_.wheel.now();
    adc_.write(cs, enable | many);
    std::uint64_t period = (c.whole + 1) * 256 + c.fraction;
    if (c.whole < 95) period = 96 * 256;  // no faster than conversions
    for (std::uint64_t n = 0; n < 6; ++n) {
      const std::uint64_t cycles = n * period / 256 + 96;
      const Cycle expected = (cycles * 125 + 47) / 48;
      rig_.wheel.advance_to(from + expected - 1);
      EXPECT_FALSE(line()) << c.whole << ' ' << n;
      rig_.pass(1);
      EXPECT_TRUE(line()) << c.whole << ' ' << n;
      adc_.read(fifo);
    }
  }
}

TEST_F(AdcTest, RoundRobinTakesEachInputInTurn) {
  for (unsigned n = 0; n < 4; ++n) adc_.set_input(n, 0.1 + n);
  adc_.write(fcs, fifo_on | threshold(4));
  adc_.write(cs, enable | sensor | many | input(2) | round_robin(0b10101));
  rig_.pass(3 * conversion + 10);
  EXPECT_EQ(adc_.read(cs) & input(7), input(2)) << "2, 4, 0, then 2 again";
  adc_.write(cs, enable | sensor | input(2));
  rig_.pass(conversion);
  const auto code = [](double volts) { return static_cast<std::uint32_t>(volts / 3.3 * 4096); };
  EXPECT_EQ(adc_.read(fifo), code(2.1));
  EXPECT_EQ(adc_.read(fifo), 876u);
  EXPECT_EQ(adc_.read(fifo), code(0.1));
  EXPECT_EQ(adc_.read(fifo), code(2.1));
}

TEST_F(AdcTest, AnErrorIsStoredWithItsSample) {
  adc_.set_input(0, 1.65);
  adc_.write(fcs, fifo_on | fifo_error | fifo_shift);
  adc_.fail_next_conversion();
  convert(0);
  EXPECT_EQ(adc_.read(cs) & (error | error_sticky), error | error_sticky);
  convert(0);
  EXPECT_EQ(adc_.read(cs) & (error | error_sticky), error_sticky);
  EXPECT_EQ(adc_.read(fifo), 0x8080u) << "shifted, but for the error bit";
  EXPECT_EQ(adc_.read(fifo), 0x80u);
  // A write of another bit through the set alias keeps the sticky bit; written itself, it clears.
  rig_.store(base + 0x2000 + cs, sensor);
  EXPECT_NE(adc_.read(cs) & error_sticky, 0u);
  rig_.store(base + 0x2000 + cs, error_sticky);
  EXPECT_EQ(adc_.read(cs) & error_sticky, 0u);
}

TEST_F(AdcTest, TheDmaTransfersEachSampleAtOnce) {
  adc_.set_input(0, 0.5);
  adc_.write(fcs, fifo_on | fifo_dreq | threshold(1));
  rig_.start_dma(0, base + fifo, rig_.ram, 6, 1, false, true, Dreq::adc);
  align();
  const Cycle from = rig_.wheel.now();
  adc_.write(cs, enable | many);
  rig_.wheel.advance_to(from + 3 * conversion + 10);
  adc_.set_input(0, 1.0);  // the fourth sample has been taken
  rig_.wheel.advance_to(from + 6 * conversion);
  EXPECT_TRUE(rig_.dma_busy(0));
  rig_.pass(20);
  EXPECT_FALSE(rig_.dma_busy(0));
  for (std::uint32_t n = 0; n < 6; ++n) {
    const std::uint32_t word = rig_.load((rig_.ram + 2 * n) & ~3u);
    EXPECT_EQ(word >> (n % 2 * 16) & 0xffffu, n < 4 ? 620u : 1241u) << n;
  }
  EXPECT_EQ(adc_.read(fcs) & fifo_over, 0u);
}

TEST_F(AdcTest, StopsWithItsClockAndWhenDisabled) {
  adc_.write(cs, enable | once);
  rig_.system.clocks.write(0x60, 0);
  rig_.pass(10 * conversion);
  EXPECT_EQ(adc_.read(cs) & ready, 0u);
  rig_.system.clocks.write(0x60, 1u << 11);
  rig_.pass(conversion + 3);
  EXPECT_NE(adc_.read(cs) & ready, 0u);
  adc_.write(cs, enable | once);
  adc_.write(cs, 0);
  EXPECT_EQ(adc_.read(cs), 0u);
  adc_.reset();
  EXPECT_EQ(adc_.read(fcs), fifo_empty);
}

// The simulator skips unobserved conversions: frequent reads must not change the result.
TEST_F(AdcTest, ReadsDoNotChangeTheResult) {
  std::mt19937_64 random(11);
  for (int round = 0; round < test::scaled(40); ++round) {
    rigs::DmaSystemRig other;
    other.start_adc_and_rtc_clocks();
    rig_.wheel.advance_to(rig_.wheel.now() + 1000);
    rigs::DmaSystemRig lazy;
    lazy.start_adc_and_rtc_clocks();
    const auto control = static_cast<std::uint32_t>(random());
    const std::uint32_t inputs = random() % 2 == 0 ? 0 : control & round_robin(31);
    const std::uint32_t divide =
        random() % 3 == 0 ? 0 : static_cast<std::uint32_t>(random() % 60'000);
    const std::uint32_t fifo_control = random() % 2 == 0 ? fifo_on : 0;
    const Cycle steps = 200 + random() % 2000;
    const Cycle step = 50 + random() % 400;
    for (rigs::DmaSystemRig* rig : {&other, &lazy}) {
      rig->system.adc.write(divider, divide);
      rig->system.adc.write(fcs, fifo_control);
      rig->system.adc.set_input(1, 1.2);
      rig->system.adc.write(cs, enable | sensor | many | inputs | input(control % 5));
    }
    for (Cycle n = 0; n < steps; ++n) {
      other.pass(step);
      other.system.adc.read(cs);
    }
    lazy.pass(steps * step);
    for (const std::uint32_t offset : {cs, result, fcs})
      EXPECT_EQ(other.system.adc.read(offset), lazy.system.adc.read(offset)) << round;
    const Cycle rest = random() % 3000;
    other.pass(rest);
    lazy.pass(rest);
    EXPECT_EQ(other.system.adc.read(cs), lazy.system.adc.read(cs)) << round;
  }
}

}  // namespace
}  // namespace lamplock::sim::chip::adc_test
