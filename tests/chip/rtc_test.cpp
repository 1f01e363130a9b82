// The RTC by the RP2040 datasheet, 4.8: clk_rtc at 46 875 Hz, clk_sys at 125 MHz.
#include "sim/chip/system/rtc.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "tests/chip/dma_system_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::rtc_test {
namespace {

constexpr std::uint32_t clkdiv = 0x00, setup_0 = 0x04, setup_1 = 0x08, control = 0x0c,
                        irq_setup_0 = 0x10, irq_setup_1 = 0x14, rtc_1 = 0x18, rtc_0 = 0x1c,
                        intr = 0x20, inte = 0x24, intf = 0x28, ints = 0x2c;
constexpr std::uint32_t enable = 1, active = 2, load = 16, no_leap_year = 1u << 8;
constexpr std::uint32_t match_enable = 1u << 28, match_active = 1u << 29;

constexpr std::uint32_t date(std::uint32_t year, std::uint32_t month, std::uint32_t day) {
  return year << 12 | month << 8 | day;
}
constexpr std::uint32_t time_of_day(std::uint32_t weekday, std::uint32_t hour, std::uint32_t minute,
                                    std::uint32_t second) {
  return weekday << 24 | hour << 16 | minute << 8 | second;
}

class RtcTest : public ::testing::Test {
 protected:
  RtcTest() {
    rig_.start_adc_and_rtc_clocks();
    rtc_.write(clkdiv, 46'874);
  }
  /// Starts as drivers do; returns when RTC_ACTIVE is set.
  void start(std::uint32_t day, std::uint32_t time, std::uint32_t extra = 0) {
    rtc_.write(control, extra);
    while ((rtc_.read(control) & active) != 0) rig_.pass(10);
    rtc_.write(setup_0, day);
    rtc_.write(setup_1, time);
    rtc_.write(control, load | extra);
    rtc_.write(control, enable | extra);
    while ((rtc_.read(control) & active) == 0) rig_.pass(1);
  }
  bool line() const { return rig_.line(Irq::rtc); }

  static constexpr Cycle second = 125'000'000;
  static constexpr Cycle tick = 125'000'000 / 46'875;  ///< of clk_rtc: 2666.67
  rigs::DmaSystemRig rig_;
  Rtc& rtc_ = rig_.system.rtc;
};

TEST_F(RtcTest, WritesArriveAfterTwoTicksOfItsClock) {
  const Cycle from = rig_.wheel.now();
  start(date(2024, 2, 28), time_of_day(3, 23, 59, 58));
  const Cycle taken = rig_.wheel.now() - from;  // of an unknown phase: one to two whole ticks
  EXPECT_GT(taken, tick);
  EXPECT_LE(taken, 2 * tick + 2);
  EXPECT_EQ(rtc_.read(control), enable | active) << "LOAD clears itself";
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(3, 23, 59, 58));
  EXPECT_EQ(rtc_.read(rtc_1), date(2024, 2, 28));
}

TEST_F(RtcTest, ASecondTakesClkdivTicks) {
  start(date(2021, 5, 6), time_of_day(4, 7, 8, 9));
  rig_.pass(second - 1);
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(4, 7, 8, 9));
  rig_.pass(2);
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(4, 7, 8, 10));
  rig_.pass(3'590 * second);
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(4, 8, 8, 0));
  EXPECT_EQ(rig_.wheel.next(), never_cycle) << "no events without an alarm";
}

TEST_F(RtcTest, TheDateIsLoadedWithTheTimeOfDay) {
  start(date(2021, 12, 31), time_of_day(5, 23, 59, 59));
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(5, 23, 59, 59));
  rig_.pass(second);
  EXPECT_EQ(rtc_.read(rtc_1), date(2021, 12, 31));
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(6, 0, 0, 0));
  EXPECT_EQ(rtc_.read(rtc_1), date(2022, 1, 1));
}

// 4.8.1.2; without the bit 2100 is a leap year (chip_images/rtc).
TEST_F(RtcTest, ALeapYearCanBeForbidden) {
  start(date(2100, 2, 28), time_of_day(0, 23, 59, 59), no_leap_year);
  rig_.pass(second);
  rtc_.read(rtc_0);
  EXPECT_EQ(rtc_.read(rtc_1), date(2100, 3, 1));
}

// Compares with the calendar of the standard library, over midnights of random days.
TEST(RtcTime, CountsTheCalendar) {
  using namespace std::chrono;
  std::mt19937_64 random(3);
  for (int n = 0; n < test::scaled(20'000); ++n) {
    const sys_days from{days{static_cast<int>(random() % 150'000)}};  // from 1970
    const year_month_day before{from};
    RtcTime time{static_cast<std::uint32_t>(static_cast<int>(before.year())),
                 static_cast<unsigned>(before.month()),
                 static_cast<unsigned>(before.day()),
                 weekday{from}.c_encoding(),
                 23,
                 59,
                 59};
    time.tick(!before.year().is_leap());
    const year_month_day after{from + days{1}};
    ASSERT_EQ(time.year, static_cast<std::uint32_t>(static_cast<int>(after.year())));
    ASSERT_EQ(time.month, static_cast<unsigned>(after.month()));
    ASSERT_EQ(time.day, static_cast<unsigned>(after.day()));
    ASSERT_EQ(time.weekday, weekday{from + days{1}}.c_encoding());
    ASSERT_EQ(time.hour + time.minute + time.second, 0u);
  }
}

TEST_F(RtcTest, TheAlarmHoldsItsLineForTheSecondThatMatches) {
  start(date(2021, 5, 6), time_of_day(4, 7, 8, 9));
  const Cycle from = rig_.wheel.now();
  rtc_.write(irq_setup_0, 0);
  rtc_.write(irq_setup_1, 1u << 28 | 12);  // seconds only
  rtc_.write(inte, 1);
  rtc_.write(irq_setup_0, match_enable);
  EXPECT_EQ(rtc_.read(irq_setup_0), match_enable);
  rig_.pass(2 * tick + 2);
  EXPECT_EQ(rtc_.read(irq_setup_0), match_enable | match_active);
  rig_.wheel.advance_to(from + 3 * second - 1);
  EXPECT_FALSE(line());
  rig_.pass(2);
  EXPECT_TRUE(line());
  EXPECT_EQ(rtc_.read(ints), 1u);
  rig_.pass(second);
  EXPECT_FALSE(line());
  rig_.pass(59 * second);
  EXPECT_TRUE(line()) << "each minute again";
  rtc_.write(irq_setup_0, 0);
  rig_.pass(2 * tick + 2);
  EXPECT_FALSE(line());
  EXPECT_EQ(rtc_.read(intr), 0u);
  rtc_.write(intf, 1);
  EXPECT_TRUE(line());
}

TEST_F(RtcTest, TheAlarmComparesEachFieldThatIsEnabled) {
  start(date(2021, 5, 6), time_of_day(4, 7, 8, 9));
  struct Field {
    std::uint32_t reg, enable, value;
  };
  for (const Field& f :
       {Field{irq_setup_0, 26, date(2021, 0, 0)}, Field{irq_setup_0, 25, date(0, 5, 0)},
        Field{irq_setup_0, 24, 6}, Field{irq_setup_1, 31, time_of_day(4, 0, 0, 0)},
        Field{irq_setup_1, 30, time_of_day(0, 7, 0, 0)},
        Field{irq_setup_1, 29, time_of_day(0, 0, 8, 0)}, Field{irq_setup_1, 28, 9}}) {
    for (const bool equal : {true, false}) {
      rtc_.write(irq_setup_0, 0);
      rtc_.write(irq_setup_1, 0);
      const std::uint32_t lowest = f.value & (~f.value + 1);
      const std::uint32_t word = 1u << f.enable | (equal ? f.value : f.value ^ lowest);
      if (f.reg == irq_setup_1) rtc_.write(irq_setup_1, word);
      rtc_.write(irq_setup_0, match_enable | (f.reg == irq_setup_0 ? word : 0u));
      rig_.pass(2 * tick + 2);
      EXPECT_EQ(rtc_.read(intr), equal ? 1u : 0u) << f.enable;
    }
  }
}

TEST_F(RtcTest, StopsWithoutItsClock) {
  start(date(2021, 5, 6), time_of_day(4, 7, 8, 9));
  rig_.system.clocks.write(0x6c, 0);
  rig_.pass(10 * second);
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(4, 7, 8, 9));
  rig_.system.clocks.write(0x6c, 1u << 11);
  rig_.pass(second + tick);
  EXPECT_EQ(rtc_.read(rtc_0), time_of_day(4, 7, 8, 10));
  rtc_.reset();
  EXPECT_EQ(rtc_.read(control), 0u);
}

// 2.2.4: base addresses; 2.14: each block has a bit of RESETS.
TEST_F(RtcTest, BlocksAreAtTheDatasheetsAddresses) {
  rig_.reports.clear();
  rig_.store(0x4005'c000 + setup_0, date(2021, 5, 6));
  EXPECT_EQ(rtc_.read(setup_0), date(2021, 5, 6));
  for (const std::uint32_t spi : {0x4003'c000u, 0x4004'0000u})
    EXPECT_EQ(rig_.load(spi + 0xfe0), 0x22u);
  for (const std::uint32_t i2c : {0x4004'4000u, 0x4004'8000u})
    EXPECT_EQ(rig_.load(i2c + 0xfc), 0x44570140u);
  EXPECT_EQ(rig_.load(0x4004'c000 + 8), 1u << 8) << "ADC FCS: empty";
  EXPECT_TRUE(rig_.reports.empty());
  rig_.store(rig_.resets_base, 1u << 15);
  rig_.store(rig_.resets_base, 0);
  EXPECT_EQ(rig_.load(0x4005'c000 + setup_0), 0u);
}

}  // namespace
}  // namespace lamplock::sim::chip::rtc_test
