// Both cores of a chip: their order of running, and a sleeping core wakes in its cycle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <random>
#include <tuple>
#include <vector>

#include "sim/chip/chip.hpp"
#include "tests/chip/listeners.hpp"
#include "tests/chip/put_code.hpp"
#include "tests/scale.hpp"

namespace lamplock::test::two_cores_test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

constexpr std::uint32_t sleep_code = 0x2004'0000, handler = 0x2004'0100, vectors = 0x2004'1000,
                        loop_code = 0x2000'0000, marks = 0x2004'0800, other_stack = 0x2004'2000;
constexpr std::uint32_t syst_csr = 0xe000'e010;
constexpr unsigned pin = 3;

/// Starts code as the ROM would, both cores in the same cycle.
class Start {
 public:
  explicit Start(Chip& chip) : chip_(chip) {
    chip_.power_on();
    chip_.run_until(1000);  // in the ROM
  }
  void core(int id, std::uint32_t pc, std::initializer_list<std::uint32_t> registers) {
    Core& core = chip_.core(id);
    unsigned number = 0;
    for (const std::uint32_t value : registers) core.set_reg(number++, value);
    core.set_reg(13, other_stack - 0x100 * static_cast<unsigned>(id));
    core.set_reg(15, pc);
    core.send_event();  // ends any wait of the core
  }

 private:
  Chip& chip_;
};

/// Records the cycles at which handlers begin.
struct Entries final : rigs::QuietListener {
  void exception_entered(int core, unsigned number, Cycle /*since*/, Cycle at) override {
    entries.emplace_back(core, number, at);
  }
  void woke(int core, Cycle at) override { wakes.emplace_back(core, at); }
  std::vector<std::tuple<int, unsigned, Cycle>> entries;
  std::vector<std::tuple<int, Cycle>> wakes;
};

// ARMv6-M ARM, B3.3: with SYST_RVR n the count reaches 0 every n + 1 cycles. A core in WFI wakes
// then and enters its handler 15 cycles later (Cortex-M0+ TRM, 3.6.1), whatever the other core
// does.
TEST(TwoCores, ACoresSysTickWakesItInItsCycle) {
  constexpr Cycle period = 5000;
  for (const int sleeper : {0, 1}) {
    Chip chip;
    Start start(chip);
    put(chip, sleep_code, {0x6041, 0x2200, 0x6082, 0x2207, 0x6002, 0xbf30, 0xe7fd});
    put(chip, handler, {0x4770});
    put_word(chip, vectors + 15 * 4, handler | 1);
    put(chip, loop_code, {0x3401, 0xe7fd});  // ADDS, B
    Entries entries;
    chip.core(sleeper).listen(&entries);
    chip.core(sleeper).set_vtor(vectors);
    start.core(sleeper, sleep_code, {syst_csr, period - 1});
    start.core(1 - sleeper, loop_code, {});
    chip.run_until(chip.now() + 8 * period);
    ASSERT_GE(entries.entries.size(), 7u);
    ASSERT_FALSE(entries.wakes.empty());
    const auto [core, number, first] = entries.entries[0];
    EXPECT_EQ(core, sleeper);
    EXPECT_EQ(number, 15u);
    for (std::size_t i = 0; i < entries.entries.size(); ++i)
      EXPECT_EQ(std::get<2>(entries.entries[i]), first + i * period) << i;
    for (const auto& entry : entries.entries)
      EXPECT_THAT(entries.wakes, testing::Contains(std::tuple(sleeper, std::get<2>(entry) - 15)));
  }
}

/// Edges of core 0's pin, with a store and a branch for each edge, while core 1 keeps entering a
/// handler and moves lists of words, from memories that core 0 does not use.
std::vector<Cycle> edges_beside_a_busy_core(Cycle period, bool every_clock, bool watched,
                                            Cycle slice) {
  constexpr std::uint32_t clear_reset = 0x4000'f000, io_and_pads = 1u << 5 | 1u << 8,
                          pin_control = 0x4001'4004 + 8 * pin, function_sio = 5,
                          enable_set = 0xd000'0024, toggle = 0xd000'001c;
  Chip chip;
  rigs::Onlooker onlooker;
  Start start(chip);
  const auto write = [&chip](std::uint32_t address, std::uint32_t value) {
    chip.bus().write(address, value, Width::word, Master::core0, chip.now());
  };
  write(clear_reset, io_and_pads);
  write(pin_control, function_sio);
  write(enable_set, 1u << pin);
  put(chip, loop_code, {0x6001, 0xe7fd});  // STR r1, [r0]; B
  put(chip, sleep_code, {0x6041, 0x2200, 0x6082, 0x2207, 0x6002, 0xb4f0, 0xbcf0, 0xe7fc});
  put(chip, handler, {0xb5f0, 0xbdf0});  // PUSH, POP {r4-r7, lr or pc}
  put_word(chip, vectors + 15 * 4, handler | 1);
  chip.core(1).set_vtor(vectors);
  start.core(0, loop_code, {toggle, 1u << pin});
  start.core(1, sleep_code, {syst_csr, static_cast<std::uint32_t>(period - 1)});
  rigs::Pads pads(chip.gpio());
  if (watched) chip.watch_steps(&onlooker);
  chip.pio_dma().set_step_every_clock(every_clock);
  const Cycle end = chip.now() + 4000;
  while (chip.now() < end) chip.run_until(std::min(end, chip.now() + slice));
  std::vector<Cycle> edges = pads.cycles(pin);
  std::erase_if(edges, [end](Cycle at) { return at >= end; });
  return edges;
}

// No operation of several cycles on one core runs ahead of the other: neither an exception nor a
// multiple access of core 1 moves an edge of core 0.
TEST(TwoCores, NeitherRunsAheadOfTheOther) {
  constexpr Cycle whole = 1'000'000;
  for (Cycle period = 60; period < 60 + static_cast<Cycle>(scaled(12)); ++period) {
    SCOPED_TRACE(period);
    const std::vector<Cycle> plain = edges_beside_a_busy_core(period, false, false, whole);
    ASSERT_GT(plain.size(), 1000u);
    for (std::size_t i = 1; i < plain.size(); ++i)
      ASSERT_EQ(plain[i] - plain[i - 1], 3u) << "at " << plain[i];
    EXPECT_EQ(edges_beside_a_busy_core(period, true, false, whole), plain);
    EXPECT_EQ(edges_beside_a_busy_core(period, false, true, whole), plain);
    EXPECT_EQ(edges_beside_a_busy_core(period, true, false, 7), plain);
  }
}

/// Places of both cores some time after a reset by the watchdog, in the middle of a loop or in the
/// ROM.
std::array<std::uint32_t, 2> places_after_a_reset(Cycle begun, bool loop) {
  constexpr std::uint32_t watchdog = 0x4005'8000, ticks = watchdog + 0x2c, load = watchdog + 4,
                          select = 0x4001'0008, enable = 1u << 30;
  Chip chip;
  Start start(chip);
  const auto write = [&chip](std::uint32_t address, std::uint32_t value) {
    chip.bus().write(address, value, Width::word, Master::core0, chip.now());
  };
  write(select, 0x1'fffc);
  write(ticks, 1u << 9 | 12);
  write(load, 200);
  write(watchdog, enable);
  chip.run_until(chip.now() + begun);
  put(chip, loop_code, {0xc80e, 0x380c, 0x6001, 0xe7fb});  // LDM r0!, {r1-r3}; SUBS; STR; B
  for (int id = 0; id < 2 && loop; ++id) start.core(id, loop_code, {marks});
  chip.run_until(chip.now() + 10'000);
  EXPECT_EQ(chip.watchdog_resets(), 1u);
  return {chip.core(0).reg(15), chip.core(1).reg(15)};
}

// RP2040 datasheet, 2.13.2: the watchdog's reset includes the processors. Neither core continues,
// whatever both are doing, including waiting for each other at a memory.
TEST(TwoCores, AResetByTheWatchdogEndsBoth) {
  const std::array<std::uint32_t, 2> in_rom = places_after_a_reset(0, false);
  constexpr Cycle before_it = 1000;  // the reset comes 1190 cycles after its set-up
  for (int i = 0; i < scaled(60); ++i) {
    const Cycle begun = static_cast<Cycle>(i) * 7 % before_it;
    EXPECT_EQ(places_after_a_reset(begun, true), in_rom) << begun;
  }
}

// The simulator may run a core ahead of the other only where the effect is invisible: random
// programs that share words, wake each other and sleep give the same run step by step and in any
// time slices.
TEST(TwoCores, RunAsTheyDoStepByStep) {
  std::mt19937_64 random(1);
  const std::vector<unsigned> instructions = {
      0x3401,  // adds r4, #1
      0x6801,  // ldr r1, [r0]
      0x6041,  // str r1, [r0, #4]
      0x6042,  // str r2, [r0, #4]
      0x6803,  // ldr r3, [r0]
      0x18d2,  // adds r2, r2, r3
      0x4363,  // muls r3, r4
      0xbf40,  // sev
      0xbf20,  // wfe
      0xc87e,  // ldm r0!, {r1-r6}
      0x3818,  // subs r0, #24
      0x6839,  // ldr r1, [r7], SIO CPUID
      0x6d79,  // ldr r1, [r7, #84], FIFO_WR: write only
      0x6579,  // str r1, [r7, #84], FIFO_WR
      0x6dbc,  // ldr r4, [r7, #88], FIFO_RD
      0xb407,  // push {r0-r2}
      0xbc07,  // pop {r0-r2}
  };
  for (int round = 0; round < scaled(60); ++round) {
    std::vector<std::vector<unsigned>> code(2);
    for (auto& each : code) {
      for (int i = 0; i < 30; ++i) each.push_back(instructions[random() % instructions.size()]);
      each.push_back(0xe7df);  // B to the start
    }
    const std::uint64_t cuts = random();
    std::vector<std::vector<std::uint64_t>> results;
    for (const int way : {0, 1, 2}) {
      Chip chip;
      rigs::Onlooker onlooker;
      if (way == 1) chip.watch_steps(&onlooker);
      Start start(chip);
      for (unsigned id = 0; id < 2; ++id) {
        for (unsigned i = 0; i < code[id].size(); ++i)
          put(chip, loop_code + 0x400 * id + 2 * i, {code[id][i]});
        start.core(static_cast<int>(id), loop_code + 0x400 * id,
                   {marks, 1 + id, 2, 3, 4, 5, 6, 0xd000'0000});
      }
      std::mt19937_64 lengths(cuts);
      const Cycle end = chip.now() + 4000;
      while (way == 2 && chip.now() + 200 < end) chip.run_until(chip.now() + lengths() % 100);
      chip.run_until(end);
      std::vector<std::uint64_t> state;
      for (const int id : {0, 1}) {
        state.push_back(chip.core(id).cycle());
        for (unsigned i = 0; i < 16; ++i) state.push_back(chip.core(id).reg(i));
      }
      for (std::uint32_t at = 0; at < 0x100; ++at)
        state.push_back(chip.bus().memory_at(marks - 0x80 + at)[0]);
      results.push_back(state);
    }
    ASSERT_EQ(results[0], results[1]) << round;
    // With other slices a sleeping core may be at another place; the work of the cores is the same.
    results[0][0] = results[2][0] = 0;
    results[0][17] = results[2][17] = 0;
    ASSERT_EQ(results[0], results[2]) << round;
  }
}

}  // namespace
}  // namespace lamplock::test::two_cores_test
