// The sleep of the whole chip (RP2040 datasheet, 2.11.2, 2.15.3.5): while both cores sleep deeply
// and the DMA is idle, SLEEP_EN selects the running clocks; a core that wakes restores them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>
#include <vector>

#include "tests/chip/listeners.hpp"
#include "tests/chip/put_code.hpp"

namespace lamplock::sim::chip::system_sleep_test {
namespace {

constexpr std::uint32_t clocks = 0x4000'8000, rtc_ctrl = clocks + 0x6c, rtc_div = clocks + 0x70,
                        sleep_en0 = clocks + 0xa8, sleep_en1 = clocks + 0xac,
                        enabled0 = clocks + 0xb0, enabled1 = clocks + 0xb4;
constexpr std::uint32_t resets = 0x4000'c000, pwm = 0x4005'0000, timer = 0x4005'4000,
                        watchdog_tick = 0x4005'802c, rtc = 0x4005'c000, dma = 0x5000'0000,
                        xosc = 0x4002'4000;
constexpr std::uint32_t code = 0x2004'0000, stack = 0x2004'2000;
constexpr std::uint32_t scr = 0xe000'ed10, iser = 0xe000'e100, sleep_deep = 4;
constexpr std::uint32_t sleep_timer = 1u << 5, sleep_rtc = 1u << 21;

struct Sleeper : PadListener, rigs::QuietListener {
  Sleeper() {
    chip.power_on();
    chip.run_until(2000);
    EXPECT_TRUE(chip.core(1).sleeping_deeply()) << "in the ROM (2.8.2)";
    put(resets + 0x3000, 1u << 2 | 1u << 5 | 1u << 8 | 1u << 14 | 1u << 15 | 1u << 21);
    put(watchdog_tick, 6 | 1u << 9);
    // gpio25: PWM of ten cycles; the ROM runs from the ring oscillator, and so does clk_sys.
    put(0x4001'40cc, 4);
    put(pwm + 0x60, 9);
    put(pwm + 0x5c, 5u << 16);
    put(pwm + 0x50, 1);
    chip.gpio().listen(*this);
    chip.core(0).listen(this);
  }
  void put(std::uint32_t address, std::uint32_t value) {
    ASSERT_FALSE(chip.bus().write(address, value, Width::word, Master::core0, chip.now()).fault);
  }
  std::uint32_t get(std::uint32_t address) {
    return chip.bus().read(address, Width::word, Master::core0, chip.now()).value;
  }
  /// Core 0 enables an interrupt that wakes it without a handler, and sleeps.
  void sleep(std::uint32_t scr_value, unsigned irq) {
    test::put(chip, code,
              {0xb672,    // cpsid i
               0x6013,    // str r3, [r2]
               0x6001,    // str r1, [r0]
               0xbf30,    // wfi
               0xe7fe});  // b .
    Core& core = chip.core(0);
    unsigned number = 0;
    for (const std::uint32_t value : {scr, scr_value, iser, 1u << irq})
      core.set_reg(number++, value);
    core.set_reg(13, stack);
    core.set_reg(15, code);
    core.send_event();
  }
  /// Only the timer keeps its clock; its alarm ends the sleep.
  void wake_by_timer(std::uint32_t us) {
    put(sleep_en0, 0);
    put(sleep_en1, sleep_timer);
    put(timer + 0x38, 1);
    put(timer + 0x10, get(timer + 0x28) + us);
  }
  void run(Picoseconds time) { chip.run_until(chip.wheel().cycle_at(chip.time() + time)); }
  std::size_t edges_between(Cycle first, Cycle last) const {
    std::size_t count = 0;
    for (const Cycle at : edges) count += at > first && at < last ? 1u : 0u;
    return count;
  }

  void pad_changed(unsigned gpio, bool, Cycle at) override {
    if (gpio == 25) edges.push_back(at);
  }
  void slept(int, Cycle at) override { slept_at.push_back(at); }
  void woke(int, Cycle at) override { woke_at.push_back(at); }

  Chip chip;
  std::vector<Cycle> edges, slept_at, woke_at;
};

TEST(SystemSleep, StopsClocksUntilACoreWakes) {
  Sleeper rig;
  rig.chip.run_until(rig.chip.now() + 20);  // two periods of the PWM
  rig.wake_by_timer(1000);
  rig.sleep(sleep_deep, 0);
  rig.run(500 * ps_per_us);
  EXPECT_EQ(rig.get(enabled0), 0u);
  EXPECT_EQ(rig.get(enabled1), sleep_timer);
  rig.run(1000 * ps_per_us);
  ASSERT_EQ(rig.woke_at.size(), 1u);
  const Cycle slept = rig.slept_at.back(), woke = rig.woke_at.back();
  EXPECT_GT(woke - slept, 5000u);
  // WFI itself takes two cycles.
  EXPECT_EQ(rig.edges_between(slept + 2, woke), 0u);
  EXPECT_GE(rig.edges_between(slept - 10, slept + 1), 2u) << "a period";
  EXPECT_GT(rig.edges_between(woke, woke + 100), 15u);
  EXPECT_EQ(rig.get(enabled0), 0xffff'ffffu);
  // The counter continues where it was: the cycles asleep do not count.
  const auto last = std::lower_bound(rig.edges.begin(), rig.edges.end(), woke);
  EXPECT_EQ((*last - woke) + (slept + 2 - *(last - 1)), 5u);
}

TEST(SystemSleep, NeedsSleepdeep) {
  Sleeper rig;
  rig.wake_by_timer(1000);
  rig.sleep(0, 0);
  rig.run(1500 * ps_per_us);
  const Cycle slept = rig.slept_at.back(), woke = rig.woke_at.back();
  EXPECT_GE(rig.edges_between(slept, woke), (woke - slept) / 5 - 1);
}

// A timer paces the channel: 100 transfers, 100 cycles each.
TEST(SystemSleep, WaitsForTheDma) {
  Sleeper rig;
  rig.put(dma + 0x420, 1u << 16 | 100);
  rig.put(dma + 0x0, code + 0x800);
  rig.put(dma + 0x4, code + 0xc00);
  rig.put(dma + 0x8, 20);
  rig.put(dma + 0xc, 1u | 2u << 2 | 0x3bu << 15);
  const Cycle begun = rig.chip.now();
  rig.wake_by_timer(1000);
  rig.sleep(sleep_deep, 0);
  rig.run(1500 * ps_per_us);
  const Cycle end = begun + 20 * 100, woke = rig.woke_at.back();
  EXPECT_GT(rig.edges_between(end - 100, end), 18u);
  EXPECT_EQ(rig.edges_between(end + 10, woke), 0u);
  EXPECT_GT(woke, end + 1000);
}

// As in the SDK's sleep: only clk_rtc, 46 875 Hz from the crystal, and its alarm.
TEST(SystemSleep, TheRtcWakes) {
  Sleeper rig;
  rig.put(xosc + 0xc, 1);
  rig.put(xosc, 0xfabaa0);
  rig.run(ps_per_ms);
  rig.put(rtc_div, 256u << 8);
  rig.put(rtc_ctrl, 1u << 11 | 3u << 5);
  rig.put(rtc, 46'875 - 1);
  rig.put(rtc + 0x4, 2020u << 12 | 1u << 8 | 1);
  rig.put(rtc + 0x8, 0);
  rig.put(rtc + 0xc, 1u << 4);
  rig.run(ps_per_ms);
  rig.put(rtc + 0xc, 1);
  rig.put(rtc + 0x14, 1u << 28 | 3);  // second 3
  rig.put(rtc + 0x10, 1u << 28);
  rig.put(rtc + 0x24, 1);
  rig.put(sleep_en0, sleep_rtc);
  rig.put(sleep_en1, 0);
  const Picoseconds begun = rig.chip.time();
  rig.sleep(sleep_deep, 25);
  rig.run(4 * ps_per_s);
  ASSERT_EQ(rig.woke_at.size(), 1u);
  const Picoseconds slept = rig.chip.wheel().time_of(rig.woke_at.back()) - begun;
  EXPECT_NEAR(static_cast<double>(slept), 3e12, 1e8);
  EXPECT_EQ(rig.edges_between(rig.slept_at.back() + 2, rig.woke_at.back()), 0u);
  for (const std::string& report : rig.chip.not_modelled())
    EXPECT_THAT(report, testing::HasSubstr("clk_sys_io "));
}

TEST(SystemSleep, IsTheSameStepByStep) {
  const auto run = [](bool stepwise, Picoseconds piece) {
    Sleeper rig;
    rigs::Onlooker onlooker;
    rig.chip.watch_steps(stepwise ? &onlooker : nullptr);
    rig.wake_by_timer(300);
    rig.sleep(sleep_deep, 0);
    const Cycle end = rig.chip.now() + 3250;
    while (rig.chip.now() < end)
      rig.chip.run_until(std::min(end, rig.chip.wheel().cycle_at(rig.chip.time() + piece)));
    return std::tuple(rig.edges, rig.slept_at, rig.woke_at);
  };
  const auto whole = run(false, ps_per_s);
  EXPECT_FALSE(std::get<0>(whole).empty());
  EXPECT_TRUE(run(true, ps_per_s) == whole);
  EXPECT_TRUE(run(false, 7 * ps_per_us) == whole);
}

// A reset of the chip restores the clocks.
TEST(SystemSleep, AResetEndsIt) {
  Sleeper rig;
  rig.put(sleep_en0, 0);
  rig.put(sleep_en1, 0);
  rig.sleep(sleep_deep, 0);
  rig.run(100 * ps_per_us);
  EXPECT_EQ(rig.get(enabled1), 0u);
  rig.chip.run_pin();
  rig.run(10 * ps_per_us);
  EXPECT_EQ(rig.get(enabled0), 0xffff'ffffu);
  EXPECT_EQ(rig.get(enabled1), 0x7fffu);
}

}  // namespace
}  // namespace lamplock::sim::chip::system_sleep_test
