// Clocks that WAKE_EN stops (RP2040 datasheet, 2.15.3.5): a block keeps its state, time does not
// pass for it, and it continues from there. Each block's own test covers its use of the clock.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <utility>
#include <vector>

#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::clock_gates_test {
namespace {

constexpr std::uint32_t wake_en = 0xa0, enabled = 0xb0;
constexpr std::uint32_t io_bank = 0x4001'4000, uart0 = 0x4003'4000, spi0 = 0x4003'c000,
                        adc = 0x4004'c000, pwm = 0x4005'0000, timer = 0x4005'4000,
                        watchdog = 0x4005'8000, rtc = 0x4005'c000, pio0 = 0x5020'0000;
constexpr Cycle still = 12'345;  ///< how long clocks are stopped, of the 125 MHz of the rig

using Edge = std::pair<unsigned, Cycle>;

/// A system that records the pins of a run.
struct Gated : PadListener, rigs::DmaSystemRig {
  Gated() {
    gpio.listen(*this);
    bus.map(pio0, fabric.pio0());
    // In a chip, the chip connects PIO and DMA.
    system.clocks.on_gate(ClockGate::sys_pio0,
                          [this](bool runs) { fabric.set_pio_clock(0, runs); });
    system.clocks.on_gate(ClockGate::sys_dma, [this](bool runs) { fabric.set_dma_clock(runs); });
  }
  void pad_changed(unsigned pin, bool, Cycle at) override { edges.emplace_back(pin, at - origin); }
  void begin() {
    origin = wheel.now();
    edges.clear();
  }
  void set_gate(ClockGate gate, bool runs) {
    const auto bit = static_cast<unsigned>(gate);
    const std::uint32_t address = wake_en + 4 * (bit / 32), mask = 1u << bit % 32;
    const std::uint32_t value = system.clocks.read(address);
    system.clocks.write(address, runs ? value | mask : value & ~mask);
  }
  void select(unsigned pin, std::uint32_t function) { store(io_bank + 8 * pin + 4, function); }
  /// Stops a clock at `after` cycles from here, for `still`; then `rest` cycles more.
  void run(ClockGate gate, Cycle after, Cycle rest, bool stop) {
    pass(after);
    if (stop) {
      set_gate(gate, false);
      pass(still);
      set_gate(gate, true);
    }
    pass(rest);
  }

  Cycle origin = 0;
  std::vector<Edge> edges;
};

/// Converts the edges of a run that stopped after `after` cycles to those of a run without the
/// stop. State latched by the PIO in its last clock appears in its next clock.
std::vector<Edge> without_stop(std::vector<Edge> edges, Cycle after) {
  for (Edge& edge : edges)
    if (edge.second > after + 1) {
      EXPECT_GT(edge.second, after + still) << "an edge without a clock";
      edge.second -= still;
    }
  return edges;
}

/// Runs with and without a stop at several moments and compares.
template <class Setup>
void expect_stands_still(ClockGate gate, Cycle length, std::size_t min_edges, Setup setup) {
  Gated whole;
  setup(whole);
  whole.begin();
  whole.run(gate, 0, length, false);
  ASSERT_GE(whole.edges.size(), min_edges);
  for (Cycle after = 1; after < length; after += length / 13) {
    Gated stopped;
    setup(stopped);
    stopped.begin();
    stopped.run(gate, after, length - after, true);
    EXPECT_EQ(without_stop(stopped.edges, after), whole.edges) << after;
    EXPECT_THAT(stopped.reports, testing::IsEmpty());
  }
}

TEST(ClockGates, PwmStops) {
  expect_stands_still(ClockGate::sys_pwm, 2'000, 20, [](Gated& rig) {
    rig.select(2, 4);
    rig.store(pwm + 0x18, 1u << 4 | 5);  // slice 1: divided by 1 5/16
    rig.store(pwm + 0x24, 99);
    rig.store(pwm + 0x20, 30);
    rig.store(pwm + 0x14, 1);
  });
}

TEST(ClockGates, PioStops) {
  for (const bool every_clock : {false, true})
    expect_stands_still(ClockGate::sys_pio0, 2'000, 20, [every_clock](Gated& rig) {
      rig.fabric.set_step_every_clock(every_clock);
      rig.select(3, 6);
      const std::uint32_t code[] = {0xe081,  // set pindirs, 1
                                    0xe024,  // set x, 4
                                    0xe301,  // set pins, 1 [3]
                                    0x0042 | 1u << 8 /* jmp x--, 2 [1] */,
                                    0xe000,   // set pins, 0
                                    0x0001};  // jmp 1
      for (std::uint32_t n = 0; n < std::size(code); ++n) rig.store(pio0 + 0x48 + 4 * n, code[n]);
      rig.store(pio0 + 0xdc, 1u << 26 | 3u << 5);  // SET: one pin from 3
      rig.store(pio0 + 0xc8, 2u << 16 | 77u << 8);
      rig.store(pio0, 1);
    });
}

// A bit is 8 x 16 cycles; the line keeps its level, also in the middle of a bit.
TEST(ClockGates, UartStops) {
  expect_stands_still(ClockGate::peri_uart0, 4'000, 15, [](Gated& rig) {
    rig.select(0, 2);
    rig.store(uart0 + 0x24, 8);
    rig.store(uart0 + 0x2c, 0x70);
    rig.store(uart0 + 0x30, 0x301);
    for (const std::uint32_t byte : {0x55u, 0x0fu, 0xa1u}) rig.store(uart0, byte);
  });
}

// The receiver accepts a byte if the line stopped for the same time as the receiver.
TEST(ClockGates, UartContinuesToReceive) {
  Gated rig;
  rig.store(uart0 + 0x24, 8);
  rig.store(uart0 + 0x2c, 0x70);
  rig.store(uart0 + 0x30, 0x381);  // looped back
  rig.store(uart0, 0x5a);
  rig.pass(600);
  rig.set_gate(ClockGate::peri_uart0, false);
  rig.pass(still);
  EXPECT_EQ(rig.load(uart0 + 0x18) & 1u << 4, 1u << 4) << "nothing received";
  rig.set_gate(ClockGate::peri_uart0, true);
  rig.pass(9 * 128 + 64 - 600 - 1);
  EXPECT_EQ(rig.load(uart0 + 0x18) & 1u << 4, 1u << 4);
  rig.pass(2);
  EXPECT_EQ(rig.load(uart0), 0x5au);
}

TEST(ClockGates, AByteForTheUartWaitsForItsClock) {
  Gated rig;
  Uart& uart = rig.system.uart0;
  uart.write(0x24, 67);
  uart.write(0x28, 52);
  uart.write(0x2c, 0x70);
  uart.write(0x30, 0x301);
  rig.set_gate(ClockGate::peri_uart0, false);
  rig.pass(1000);
  uart.send_to_chip(0x5a);
  rig.pass(still);
  rig.set_gate(ClockGate::peri_uart0, true);
  constexpr Cycle bit = 1085, sample = 9 * bit + bit / 2;  // the middle of the stop bit
  rig.pass(sample - 1);
  EXPECT_NE(uart.read(0x18) & 1u << 4, 0u);
  rig.pass(2);
  EXPECT_EQ(uart.read(0), 0x5au);
}

TEST(ClockGates, SpiStops) {
  expect_stands_still(ClockGate::peri_spi0, 1'500, 40, [](Gated& rig) {
    rig.select(2, 1);
    rig.select(3, 1);
    rig.select(5, 1);
    rig.store(spi0 + 0x10, 10);
    rig.store(spi0, 1u << 7 | 1u << 8 | 7);  // 20 cycles a bit
    rig.store(spi0 + 4, 2);
    for (const std::uint32_t word : {0xa5u, 0x31u, 0xffu}) rig.store(spi0 + 8, word);
  });
}

TEST(ClockGates, TimerStops) {
  Gated rig;
  const std::uint32_t from = rig.load(timer + 0x28);
  rig.store(timer + 0x38, 1);
  rig.store(timer + 0x10, from + 40);
  rig.pass(30 * 125);
  rig.set_gate(ClockGate::sys_timer, false);
  rig.pass(1'000 * 125);
  EXPECT_FALSE(rig.line(Irq::timer_0));
  rig.set_gate(ClockGate::sys_timer, true);
  EXPECT_EQ(rig.load(timer + 0x28), from + 30);
  rig.pass(9 * 125);
  EXPECT_FALSE(rig.line(Irq::timer_0));
  rig.pass(125 + 1);
  EXPECT_TRUE(rig.line(Irq::timer_0));
}

TEST(ClockGates, WatchdogStops) {
  Gated rig;
  rig.store(watchdog + 4, 2 * 100);  // erratum E1: 100 us
  rig.store(watchdog, 1u << 30);
  rig.pass(50 * 125);
  rig.set_gate(ClockGate::sys_watchdog, false);
  rig.pass(1'000 * 125);
  EXPECT_NEAR(rig.load(watchdog) & 0xffffffu, 100, 2);
  rig.set_gate(ClockGate::sys_watchdog, true);
  rig.pass(48 * 125);
  EXPECT_EQ(rig.load(watchdog + 8), 0u);
  rig.pass(4 * 125);
  EXPECT_EQ(rig.load(watchdog + 8), 1u) << "has fired";
}

// 96 cycles of clk_adc at 48 MHz: 2 us.
TEST(ClockGates, AdcStops) {
  Gated rig;
  rig.start_adc_and_rtc_clocks();
  rig.reports.clear();
  rig.store(adc, 1 | 4);  // START_ONCE
  rig.pass(125);
  rig.set_gate(ClockGate::adc_adc, false);
  rig.pass(still);
  EXPECT_EQ(rig.load(adc) & 1u << 8, 0u) << "not ready";
  rig.set_gate(ClockGate::adc_adc, true);
  rig.pass(110);
  EXPECT_EQ(rig.load(adc) & 1u << 8, 0u);
  rig.pass(30);
  EXPECT_EQ(rig.load(adc) & 1u << 8, 1u << 8);
}

TEST(ClockGates, RtcStops) {
  Gated rig;
  rig.start_adc_and_rtc_clocks();
  rig.store(rtc, 46'875 - 1);
  rig.store(rtc + 4, 2020u << 12 | 1u << 8 | 1);
  rig.store(rtc + 0xc, 1u << 4);  // load
  rig.pass_time(ps_per_ms);
  rig.store(rtc + 0xc, 1);
  rig.pass_time(ps_per_s / 2);
  rig.set_gate(ClockGate::rtc_rtc, false);
  rig.pass_time(10 * ps_per_s);
  rig.set_gate(ClockGate::rtc_rtc, true);
  rig.pass_time(ps_per_s / 4);
  EXPECT_EQ(rig.load(rtc + 0x1c) & 0x3fu, 0u);
  rig.pass_time(ps_per_s / 2);
  EXPECT_EQ(rig.load(rtc + 0x1c) & 0x3fu, 1u);
}

// A word a clock (2.5).
TEST(ClockGates, DmaStops) {
  constexpr std::uint32_t words = 1'000, count = 8;
  const auto busy_for = [](Cycle stop_after) {
    Gated rig;
    const Cycle begun = rig.wheel.now();
    rig.start_dma(0, rig.ram, rig.ram + 0x8000, words, 2, true, true, Dreq{63});
    if (stop_after != 0) {
      rig.pass(stop_after);
      rig.set_gate(ClockGate::sys_dma, false);
      const std::uint32_t left = rig.fabric.dma().peek(count);
      rig.pass(still);
      EXPECT_EQ(rig.fabric.dma().peek(count), left);
      rig.set_gate(ClockGate::sys_dma, true);
    }
    while (rig.dma_busy(0)) rig.pass(1);
    return rig.wheel.now() - begun;
  };
  const Cycle whole = busy_for(0);
  EXPECT_GE(whole, words);
  for (const Cycle after : {1u, 2u, 3u, 4u, 500u, 999u}) EXPECT_EQ(busy_for(after), whole + still);
}

TEST(ClockGates, RegistersWithoutAClockDoNotAnswer) {
  Gated rig;
  rig.store(pwm + 0x10, 77);
  rig.set_gate(ClockGate::sys_pwm, false);
  EXPECT_EQ(rig.system.clocks.read(enabled) >> 17 & 1u, 0u);
  EXPECT_THAT(rig.reports, testing::IsEmpty());
  rig.store(pwm + 0x10, 5);
  EXPECT_THAT(rig.reports, testing::ElementsAre("PWM: accessed while its clock is stopped"));
  rig.set_gate(ClockGate::sys_pwm, true);
  EXPECT_EQ(rig.load(pwm + 0x10), 77u);
}

// Edges without a clock are missed; the level is seen when the clock is back.
TEST(ClockGates, PwmCountsNoEdgesWithoutAClock) {
  Gated rig;
  rig.select(1, 4);
  rig.store(pwm + 0x0, 1 | 2u << 4);  // slice 0: rising edges of B
  const auto pulse = [&rig] {
    for (const External level : {External::high, External::low}) {
      rig.gpio.set_external(1, level, rig.wheel.now());
      rig.pass(5);
    }
  };
  pulse();
  pulse();
  rig.set_gate(ClockGate::sys_pwm, false);
  pulse();
  rig.set_gate(ClockGate::sys_pwm, true);
  EXPECT_EQ(rig.load(pwm + 0x8), 2u);
  pulse();
  EXPECT_EQ(rig.load(pwm + 0x8), 3u);
}

}  // namespace
}  // namespace lamplock::sim::chip::clock_gates_test
