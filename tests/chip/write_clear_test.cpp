// Bits that a written 1 clears, through the atomic aliases (RP2040 datasheet, 2.1.2): exactly the
// written bits are cleared, whichever alias is used.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::write_clear_test {
namespace {

constexpr std::uint32_t set_alias = 0x2000, clear_alias = 0x3000;
constexpr std::uint32_t xosc = 0x4002'4000, uart0 = 0x4003'4000, spi0 = 0x4003'c000,
                        timer = 0x4005'4000, rosc = 0x4006'0000, vreg = 0x4006'4000;
constexpr std::uint32_t timer_alarm0 = timer + 0x10, timer_armed = timer + 0x20,
                        timer_raw_low = timer + 0x28, timer_intr = timer + 0x34;
constexpr std::uint32_t bad_write = 1u << 24;

struct WriteClear : testing::TestWithParam<std::uint32_t>, rigs::DmaSystemRig {
  /// A write through the alias under test.
  void clear(std::uint32_t address, std::uint32_t bits) { store(address + GetParam(), bits); }
  void arm_all(std::uint32_t in_us) {
    const std::uint32_t at = load(timer_raw_low) + in_us;
    for (std::uint32_t alarm = 0; alarm < 4; ++alarm) store(timer_alarm0 + 4 * alarm, at);
  }
};

TEST_P(WriteClear, OnlyOneAlarm) {
  arm_all(3);
  pass_time(5 * ps_per_us);
  ASSERT_EQ(load(timer_intr), 0xfu);
  clear(timer_intr, 1u << 2);
  EXPECT_EQ(load(timer_intr), 0xbu);
  clear(timer_intr, 0);
  EXPECT_EQ(load(timer_intr), 0xbu);
  clear(timer_intr, 3);
  EXPECT_EQ(load(timer_intr), 0x8u);
}

TEST_P(WriteClear, DisarmsOnlyOneAlarm) {
  arm_all(1000);
  clear(timer_armed, 1u << 1);
  EXPECT_EQ(load(timer_armed), 0xdu);
}

TEST_P(WriteClear, BadWriteOfTheOscillatorsOnlyWhenItIsWritten) {
  for (const std::uint32_t status : {xosc + 0x04, rosc + 0x18}) {
    store(status == xosc + 0x04 ? xosc + 0x08 : rosc + 0x0c, 1);  // DORMANT: no valid word
    ASSERT_NE(load(status) & bad_write, 0u);
    clear(status, 1u << 12);
    EXPECT_NE(load(status) & bad_write, 0u);
    clear(status, bad_write);
    EXPECT_EQ(load(status) & bad_write, 0u);
  }
}

TEST_P(WriteClear, WrapOfOnlyOneSliceOfThePwm) {
  constexpr std::uint32_t pwm = 0x4005'0000, top = 0x10, slice = 0x14, enable = 0xa0, intr = 0xa4;
  for (const std::uint32_t number : {0u, 1u}) store(pwm + slice * number + top, 9);
  store(pwm + enable, 3);
  pass(15);
  store(pwm + enable, 0);
  clear(pwm + intr, 1);
  EXPECT_EQ(load(pwm + intr), 2u);
}

TEST_P(WriteClear, ThePsmRestartFlagOnlyWhenItIsWritten) {
  constexpr std::uint32_t flag = 1u << 24, had_psm_restart = 1u << 20;
  system.vreg.note(ChipReset::debug_port);
  clear(vreg + 0x8, had_psm_restart);
  EXPECT_EQ(load(vreg + 0x8), flag | had_psm_restart);
  clear(vreg + 0x8, flag);
  EXPECT_EQ(load(vreg + 0x8), had_psm_restart);
}

TEST_P(WriteClear, InterruptsOfThePrimeCells) {
  store(uart0 + 0x24, 67);
  store(uart0 + 0x2c, 0x70);
  store(uart0 + 0x30, 0x381);                                          // looped back
  for (std::uint32_t byte = 0; byte < 40; ++byte) store(uart0, byte);  // more than fits
  pass_time(10 * ps_per_ms);                                           // all received
  constexpr std::uint32_t tx = 1u << 5, timeout = 1u << 6, icr = 0x44, ris = 0x3c;
  const std::uint32_t raised = load(uart0 + ris);
  ASSERT_EQ(raised & (tx | timeout), tx | timeout);
  clear(uart0 + icr, timeout);
  EXPECT_EQ(load(uart0 + ris), raised & ~timeout);

  constexpr std::uint32_t overrun = 1, spi_timeout = 2, spi_icr = 0x20, spi_ris = 0x18;
  store(spi0 + 0x10, 2);
  store(spi0 + 0x0, 7);
  store(spi0 + 0x4, 3);  // looped back
  for (int word = 0; word < 10; ++word) {
    store(spi0 + 0x8, 1);
    pass_time(10 * ps_per_us);
  }
  ASSERT_EQ(load(spi0 + spi_ris) & 3u, overrun | spi_timeout);
  clear(spi0 + spi_icr, overrun);
  EXPECT_EQ(load(spi0 + spi_ris) & 3u, spi_timeout);
}

INSTANTIATE_TEST_SUITE_P(Aliases, WriteClear, testing::Values(0u, set_alias, clear_alias));

}  // namespace
}  // namespace lamplock::sim::chip::write_clear_test
