// Two masters at one port of the crossbar (RP2040 datasheet, 2.1.1, 2.6.2).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "sim/chip/chip.hpp"
#include "tests/chip/core_rig.hpp"
#include "tests/chip/listeners.hpp"
#include "tests/chip/put_code.hpp"

namespace lamplock::test::contention_test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

constexpr std::uint32_t bank4 = 0x2004'0000, bank5 = 0x2004'1000;
constexpr std::uint32_t high_core0 = 1u << 0, high_core1 = 1u << 4;

class ContentionTest : public testing::Test {
 protected:
  ContentionTest() { bus_.set_two_cores(true); }
  std::uint32_t wait(Master master, std::uint32_t address, Cycle at) {
    return bus_.read(address, Width::word, master, at).wait;
  }
  TimeWheel wheel_;
  Timing timing_;
  Bus bus_{wheel_, timing_, {}};
};

TEST_F(ContentionTest, TheLoserOfAClashWaitsACycle) {
  EXPECT_EQ(wait(Master::core0, bank4, 100), 0u);
  EXPECT_EQ(wait(Master::core1, bank4 + 0x40, 100), 1u);
  EXPECT_EQ(wait(Master::core0, bank4, 200), 0u);
  EXPECT_EQ(wait(Master::core1, bank4, 201), 0u) << "one after the other";
  EXPECT_EQ(bus_.arbiter().contested(BusPort::sram4), 1u);
}

// 2.6.2: banks 0 to 3 striped by word, 4 and 5 separate; 0x21000000: bank by bank.
TEST_F(ContentionTest, BanksAreIndependent) {
  Cycle at = 100;
  const auto clash = [&](std::uint32_t a, std::uint32_t b) {
    at += 10;
    return wait(Master::core0, a, at) + wait(Master::core1, b, at) +
           bus_.arbiter().take_owed(Requester::core0);
  };
  for (std::uint32_t i = 0; i < 8; ++i)
    EXPECT_EQ(clash(0x2000'0000, 0x2000'0100 + 4 * i), i % 4 == 0 ? 1u : 0u) << i;
  for (std::uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(clash(0x2000'0000 + 4 * i, 0x2100'0000 + 0x1'0000 * i + 0x20), 1u) << i;
  EXPECT_EQ(clash(0x2000'0000, 0x2101'0000), 0u);
  EXPECT_EQ(clash(bank4, bank5), 0u);
  EXPECT_EQ(clash(bank5, bank5 + 0xffc), 1u);
  EXPECT_EQ(clash(0x0000'0100, 0x0000'0200), 1u) << "ROM";
  EXPECT_EQ(clash(0x0000'0100, bank4), 0u);
}

// 2.1.3: a read of APB has three cycles of data phase, a write four; the bridge serves one at a
// time.
TEST_F(ContentionTest, TheBridgeIsBusyForTheWholeAccess) {
  EXPECT_EQ(wait(Master::core0, 0x4005'4000, 100), 2u);
  EXPECT_EQ(wait(Master::core1, 0x4001'4000, 100), 3u + 2u);
  EXPECT_EQ(bus_.write(0x4001'4000, 0, Width::word, Master::core0, 200).wait, 3u);
  EXPECT_EQ(wait(Master::core1, 0x4001'4000, 203), 1u + 2u);
  EXPECT_EQ(wait(Master::core0, 0x5020'0000, 300), 0u);
  EXPECT_EQ(wait(Master::core1, 0x5030'0000, 300), 1u) << "AHB-Lite peripherals share a port";
  EXPECT_EQ(wait(Master::core0, 0xd000'0000, 400) + wait(Master::core1, 0xd000'0000, 400), 0u)
      << "each core has its own port to SIO";
}

// 2.1.1.1: round-robin between equals, high priority first.
TEST_F(ContentionTest, EqualsTakeTurnsAndHighPriorityGoesFirst) {
  Arbiter arbiter;
  const auto request = [&](Requester who, Cycle at) {
    return arbiter.request(BusPort::sram0, who, at, 1);
  };
  const auto owed = [&](Requester who) { return arbiter.take_owed(who); };
  EXPECT_EQ(request(Requester::core0, 90), 0u);  // so it is core 1's turn
  EXPECT_EQ(request(Requester::core0, 100), 0u);
  EXPECT_EQ(request(Requester::core1, 100), 0u);
  EXPECT_EQ(owed(Requester::core0), 1u);
  EXPECT_EQ(owed(Requester::core1), 0u);
  for (const auto& [high, first, second] :
       {std::array{high_core0, 0u, 1u}, std::array{high_core1, 0u, 1u},
        std::array{high_core0, 1u, 0u}, std::array{high_core1, 1u, 0u}}) {
    static Cycle at = 200;
    at += 100;
    arbiter.set_priorities(high);
    EXPECT_EQ(request(static_cast<Requester>(first), at), 0u);
    const std::uint32_t waits = request(static_cast<Requester>(second), at);
    const bool second_is_high = (high == high_core0) == (second == 0);
    EXPECT_EQ(waits, second_is_high ? 0u : 1u);
    EXPECT_EQ(owed(static_cast<Requester>(first)), second_is_high ? 1u : 0u);
  }
}

TEST_F(ContentionTest, AMasterAloneNeverWaits) {
  bus_.set_two_cores(false);
  EXPECT_EQ(wait(Master::core0, bank4, 100), 0u);
  EXPECT_EQ(wait(Master::core1, bank4, 100), 0u);
}

/// Two cores that run in step.
struct Pair {
  Pair() {
    for (Core* core : {&core0, &core1}) {
      core->reset(0);
      core->set_xpsr(1u << 24);
    }
    bus.set_two_cores(true);
  }
  void code(std::uint32_t at, unsigned instruction, unsigned count) {
    for (unsigned i = 0; i < count; ++i) put(bus, at + 2 * i, {instruction});
  }
  /// Cycles that each needs for its `count` instructions.
  std::array<Cycle, 2> run(std::uint32_t code0, std::uint32_t code1, unsigned count) {
    core0.set_reg(15, code0);
    core1.set_reg(15, code1);
    const Cycle from = core0.cycle();
    std::array<unsigned, 2> left{count, count};
    while (left[0] + left[1] != 0) {
      const bool first = left[1] == 0 || (left[0] != 0 && core0.cycle() <= core1.cycle());
      (first ? core0 : core1).step();
      --left[first ? 0 : 1];
    }
    // Owed cycles are subtracted with the next step.
    return {core0.cycle() - from + bus.arbiter().take_owed(Requester::core0),
            core1.cycle() - from + bus.arbiter().take_owed(Requester::core1)};
  }
  TimeWheel wheel;
  Timing timing;
  IrqLines irqs;
  Bus bus{wheel, timing, {}};
  Core core0{0, bus, wheel, irqs, timing, {}};
  Core core1{1, bus, wheel, irqs, timing, {}};
};

// 100 loads of two cycles each from one bank, code elsewhere: after one clash the cores are one
// cycle apart and never clash again. Others measured this on silicon (rp2040-experiments,
// bus_behavior, experiment 5): 200 and 201 cycles, one contested access. In two banks they never
// meet.
TEST(TwoCoresInStep, ClashOnceInABankAndNeverAgain) {
  for (const std::uint32_t other : {0x2000'0000u, 0x2000'0004u}) {
    Pair pair;
    for (const std::uint32_t code : {bank4, bank5}) pair.code(code, 0x6801, 100);  // ldr r1, [r0]
    pair.core0.set_reg(0, 0x2000'0000);
    pair.core1.set_reg(0, other);
    const auto [cycles0, cycles1] = pair.run(bank4, bank5, 100);
    const unsigned clashes = other == 0x2000'0000 ? 1 : 0;
    EXPECT_EQ(std::min(cycles0, cycles1), 200u);
    EXPECT_EQ(std::max(cycles0, cycles1), 200u + clashes);
    EXPECT_EQ(pair.bus.arbiter().contested(BusPort::sram0), clashes);
  }
}

TEST(TwoCoresInStep, FetchTheSameCodeATurnApart) {
  Pair pair;
  pair.code(bank4, 0xbf00, 100);
  const auto [cycles0, cycles1] = pair.run(bank4, bank4, 100);
  EXPECT_EQ(cycles0 + cycles1, 201u) << "a word every two cycles each: room for both";
  EXPECT_EQ(pair.bus.arbiter().contested(BusPort::sram4), 1u);
}

// Eight words of a frame (ARMv6-M ARM, B1.5.6), a cycle each: a master that requests during the
// first waits for all.
TEST(TwoCoresInStep, AFrameTakesItsPortForEightCycles) {
  Pair pair;
  pair.code(bank5, 0xdf00, 1);  // svc 0
  pair.bus.arbiter().set_priorities(high_core0);
  pair.core0.set_reg(15, bank5);
  pair.core0.set_reg(13, bank4 + 0x100);
  const Cycle entry = pair.core0.cycle();
  pair.core0.step();
  ASSERT_EQ(pair.core0.exception(), 11u);
  EXPECT_EQ(pair.bus.read(bank4, Width::word, Master::core1, entry).wait, 8u);
}

// 2.1.1.1: "high-priority masters will never observe any slowdown" at a memory without wait states,
// also where the other one loads a list of words.
TEST(Arbiter, HighPriorityGoesBetweenTheWordsOfAList) {
  Arbiter arbiter;
  arbiter.set_priorities(high_core1);
  for (Cycle at = 100; at < 104; ++at)
    EXPECT_EQ(arbiter.request(BusPort::sram4, Requester::core0, at, 1), 0u);
  EXPECT_EQ(arbiter.request(BusPort::sram4, Requester::core1, 101, 1), 0u);
  EXPECT_EQ(arbiter.take_owed(Requester::core0), 1u);
  // An access that the bridge has begun is completed.
  EXPECT_EQ(arbiter.request(BusPort::apb, Requester::core0, 200, 3), 0u);
  EXPECT_EQ(arbiter.request(BusPort::apb, Requester::core1, 201, 3), 2u);
  EXPECT_EQ(arbiter.take_owed(Requester::core0), 0u);
}

constexpr std::uint32_t dma_base = 0x5000'0000, busctrl_base = 0x4003'0000;
constexpr std::uint32_t high_dma_read = 1u << 8;
constexpr std::uint32_t treq_timer0 = 0x3b, treq_permanent = 0x3f;
constexpr std::uint32_t control_word = 2u << 2 | 1u;  // words, enabled, one address
constexpr std::uint32_t contested_sram4 = 6;          // 2.1.5, PERFSEL0
constexpr unsigned load_count = 200;

/// Core 0 in bank 5: loads from bank 4, then a loop; core 1 sleeps in ROM.
struct LoneCore {
  LoneCore() {
    chip.power_on();
    chip.run_until(2000);
    write(0x4000'f000, 1u << 1 | 1u << 2);  // out of reset: BUSCTRL, DMA
    write(busctrl_base + 0xc, contested_sram4);
    for (std::uint32_t i = 0; i < load_count; ++i) put(bank5 + 2 * i, 0x6801);  // ldr r1, [r0]
    put(end, 0xe7fe);                                                           // b .
  }
  void put(std::uint32_t address, std::uint16_t half) { test::put(chip, address, {half}); }
  void write(std::uint32_t address, std::uint32_t value) {
    chip.bus().write(address, value, Width::word, Master::core0, chip.now());
  }
  std::uint32_t read(std::uint32_t address) {
    return chip.bus().read(address, Width::word, Master::core0, chip.now()).value;
  }
  void start_dma(std::uint32_t from, std::uint32_t to, std::uint32_t count, std::uint32_t treq) {
    write(dma_base + 0x0, from);
    write(dma_base + 0x4, to);
    write(dma_base + 0x8, count);
    write(dma_base + 0xc, treq << 15 | control_word);
  }
  /// Cycles of the loads.
  Cycle loads() { return run(bank5, end); }
  Cycle run(std::uint32_t first, std::uint32_t last) {
    Core& core = chip.core(0);
    core.set_reg(0, bank4);
    core.set_reg(15, first);
    const Cycle from = core.cycle();
    while (core.reg(15) != last) chip.run_until(core.cycle() + 1);
    return core.cycle() - from;
  }
  std::uint32_t contested() { return read(busctrl_base + 0x8); }
  static constexpr std::uint32_t end = bank5 + 2 * load_count;
  Chip chip;
};

TEST(DmaAndALoneCore, NeverWaitsWithoutADma) {
  LoneCore rig;
  EXPECT_EQ(rig.loads(), 2 * load_count);
  EXPECT_EQ(rig.contested(), 0u);
}

// The core requests in every second cycle, the DMA in each: in round-robin the core always waited
// longer and goes first, and the DMA has the other half of the cycles.
TEST(DmaAndALoneCore, AStreamAlternatesWithTheCore) {
  LoneCore rig;
  rig.start_dma(bank4, 0x2000'0000, 10'000, treq_permanent);
  const std::uint32_t before = rig.read(dma_base + 8);
  EXPECT_EQ(rig.loads(), 2 * load_count);
  EXPECT_NEAR(before - rig.read(dma_base + 8), load_count, 4);
  EXPECT_NEAR(rig.contested(), load_count, 4);
}

// A stream with priority leaves a core without priority no cycle until its end.
TEST(DmaAndALoneCore, AStreamWithPriorityBlocksTheCore) {
  for (const std::uint32_t core : {0u, high_core0}) {
    LoneCore rig;
    rig.write(busctrl_base, high_dma_read | core);
    rig.start_dma(bank4, 0x2000'0000, 10'000, treq_permanent);
    const Cycle cycles = rig.loads();
    if (core == 0)
      EXPECT_NEAR(static_cast<double>(cycles), 10'000.0 + 2 * load_count, 8.0);
    else
      EXPECT_EQ(cycles, 2 * load_count) << "equals again";
  }
}

// A transfer every five cycles precedes the core, whose last access is more recent: two loads and
// one wait cycle every five cycles. With a transfer every six cycles, the core is a cycle later
// after the first clash and never clashes again.
TEST(DmaAndALoneCore, PacedTransfersCostACycleAtEachClash) {
  for (const std::uint32_t period : {5u, 6u}) {
    LoneCore rig;
    rig.write(dma_base + 0x420, 1u << 16 | period);  // TIMER0
    rig.start_dma(bank4, 0x2000'0000, 10'000, treq_timer0);
    rig.loads();  // so that both have used the port
    const std::uint32_t before = rig.contested();
    const Cycle cycles = rig.loads();
    if (period == 5)
      EXPECT_NEAR(static_cast<double>(cycles), 2 * load_count * 5.0 / 4.0, 1.0);
    else
      EXPECT_LE(cycles, 2 * load_count + 1);
    EXPECT_NEAR(rig.contested() - before, static_cast<double>(cycles - 2 * load_count), 1.0);
  }
}

// Code without branches fetches a word every two cycles, as the loads above.
TEST(DmaAndALoneCore, FetchesClashWithTransfersToo) {
  constexpr std::uint32_t nops = 400;
  LoneCore rig;
  for (std::uint32_t i = 0; i <= nops; ++i) rig.put(bank4 + 2 * i, i == nops ? 0xe7fe : 0xbf00);
  EXPECT_EQ(rig.run(bank4, bank4 + 2 * nops), nops);
  rig.write(dma_base + 0x420, 1u << 16 | 5u);
  rig.start_dma(bank4 + 0x800, 0x2000'0000, 10'000, treq_timer0);
  rig.run(bank4, bank4 + 2 * nops);
  EXPECT_NEAR(static_cast<double>(rig.run(bank4, bank4 + 2 * nops)), nops * 5.0 / 4.0, 1.0);
}

TEST(DmaAndALoneCore, PriorityOfTheCoreAvoidsWaiting) {
  LoneCore rig;
  rig.write(busctrl_base, high_core0);
  rig.write(dma_base + 0x420, 1u << 16 | 5u);
  rig.start_dma(bank4, 0x2000'0000, 10'000, treq_timer0);
  rig.chip.run_until(rig.chip.now() + 20);
  EXPECT_EQ(rig.loads(), 2 * load_count);
  EXPECT_GT(rig.contested(), 30u);
}

/// How the simulator runs.
enum class Way : std::uint8_t { plain, watched, every_clock, slices };

/// The cycles in which a core jumps.
struct Jumps final : rigs::QuietListener {
  void branched(int, std::uint32_t, Cycle at) override { cycles.push_back(at); }
  std::vector<Cycle> cycles;
};

/// Random loops of one core or two and two paced channels, all over SRAM.
struct Meeting : LoneCore {
  explicit Meeting(unsigned seed) : random(seed) {
    write(busctrl_base, any(0x1'0000) & 0x1111u);
    for (std::uint32_t i = 0; i < 2; ++i) {
      write(dma_base + 0x420 + 4 * i, 1u << 16 | (2 + any(20)));
      const std::uint32_t channel = dma_base + 0x40 * i;
      write(channel + 0x0, bank4 + 4 * any(16));
      write(channel + 0x4, 0x2000'0000 + 4 * any(16));
      write(channel + 0x8, 100'000);
      write(channel + 0xc, (treq_timer0 + i) << 15 | i << 11 | control_word | any(2) << 4);
    }
    loop(0);
    if (any(2) != 0) {
      loop(1);
      chip.core(1).send_event();
    }
  }
  std::uint32_t any(std::uint32_t below) { return static_cast<std::uint32_t>(random() % below); }
  void loop(int id) {
    // ldr r1, [r0]; ldm r0!, {r2-r4}; subs r0, #12; str r1, [r5]; nop; mov pc, r6
    constexpr std::array<std::uint16_t, 6> code = {0x6801, 0xc81c, 0x380c, 0x6029, 0xbf00, 0x46b7};
    const std::uint32_t place = (any(2) == 0 ? bank5 : bank4) + 0x400;
    for (std::uint32_t i = 0; i < code.size(); ++i) put(place + 2 * i, code[i]);
    Core& core = chip.core(id);
    core.set_reg(0, bank4 + 4 * any(8));
    core.set_reg(5, 0x2000'0000 + 4 * any(16));
    core.set_reg(6, place);
    core.set_reg(15, place);
  }
  std::mt19937 random;
};

/// Cycles of the rounds of core 0 and core 1.
using Rounds = std::array<std::vector<Cycle>, 2>;

Rounds rounds(Way way, unsigned seed) {
  rigs::Onlooker onlooker;
  Meeting rig(seed);
  if (way == Way::watched) rig.chip.watch_steps(&onlooker);
  if (way == Way::every_clock) rig.chip.pio_dma().set_step_every_clock(true);
  std::array<Jumps, 2> jumps;
  for (int id = 0; id < 2; ++id) rig.chip.core(id).listen(&jumps[static_cast<std::size_t>(id)]);
  const Cycle end = rig.chip.now() + 5000;
  while (rig.chip.now() < end)
    rig.chip.run_until(way == Way::slices ? std::min(end, rig.chip.now() + 1 + rig.any(9)) : end);
  // Runs may end one instruction apart.
  for (Jumps& each : jumps) std::erase_if(each.cycles, [end](Cycle at) { return at >= end - 10; });
  return {jumps[0].cycles, jumps[1].cycles};
}

TEST(CoresAndDma, ClashInTheSameCyclesInEveryWayOfRunning) {
  unsigned two = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Rounds plain = rounds(Way::plain, seed);
    EXPECT_GT(plain[0].size(), 100u);
    if (plain[1].size() > 100) ++two;
    EXPECT_EQ(rounds(Way::watched, seed), plain) << seed;
    EXPECT_EQ(rounds(Way::every_clock, seed), plain) << seed;
    EXPECT_EQ(rounds(Way::slices, seed), plain) << seed;
  }
  EXPECT_GT(two, 10u);
}

// A read that yields to another master has its word a clock later, and so does its write.
TEST(DmaAndALoneCore, AReadThatWaitsEndsItsTransferLater) {
  const auto clocks = [](std::uint32_t code, Cycle offset) {
    LoneCore rig;
    for (std::uint32_t i = 0; i < 400; ++i) rig.put(code + 2 * i, 0xbf00);
    rig.write(busctrl_base, high_core0);
    rig.chip.core(0).set_reg(15, code);
    rig.chip.run_until(rig.chip.now() + 10 + offset);
    const Cycle from = rig.chip.now();
    rig.start_dma(bank4 + 0x800, 0x2000'0000, 1, treq_permanent);
    while ((rig.read(dma_base + 0xc) >> 24 & 1u) != 0) rig.chip.run_until(rig.chip.now() + 1);
    return rig.chip.now() - from;
  };
  const Cycle alone = clocks(bank5, 0);
  EXPECT_EQ(clocks(bank5, 1), alone);
  // The core fetches a word in every second cycle.
  EXPECT_EQ(clocks(bank4, 0) + clocks(bank4, 1), 2 * alone + 1);
}

// 2.1.1: reads and writes of the DMA are two masters. A bank's port has one access per clock: a
// copy inside a bank takes two clocks per word, a copy between banks one clock.
TEST(DmaAlone, ReadsAndWritesMeetInOneBank) {
  const auto clocks = [](std::uint32_t to, std::uint32_t count) {
    LoneCore rig;
    rig.chip.core(0).set_reg(15, LoneCore::end);
    rig.start_dma(bank4, to, count, treq_permanent);
    const Cycle from = rig.chip.now();
    while ((rig.read(dma_base + 0xc) >> 24 & 1u) != 0) rig.chip.run_until(rig.chip.now() + 1);
    return rig.chip.now() - from;
  };
  EXPECT_EQ(clocks(bank4 + 0x800, 200) - clocks(bank4 + 0x800, 100), 200u);
  EXPECT_EQ(clocks(0x2000'0000, 200) - clocks(0x2000'0000, 100), 100u);
}

TEST(PerformanceCounter, ContinuesWithAnotherEventAndIsClearedByAnyWrite) {
  LoneCore rig;
  rig.start_dma(bank4, 0x2000'0000, 10'000, treq_permanent);
  rig.loads();
  const std::uint32_t count = rig.contested();
  EXPECT_GT(count, 100u);
  rig.write(busctrl_base + 0xc, 4);  // contested accesses of SRAM5
  EXPECT_EQ(rig.contested(), count);
  rig.write(busctrl_base + 0x8, 1);
  EXPECT_EQ(rig.contested(), 0u);
}

}  // namespace
}  // namespace lamplock::test::contention_test
