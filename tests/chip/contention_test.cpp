// Two masters at one port of the crossbar (RP2040 datasheet, 2.1.1, 2.6.2).
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <initializer_list>
#include <optional>

#include "sim/chip/chip.hpp"
#include "tests/chip/core_rig.hpp"

namespace lamplock::test {
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

// 2.6.2: banks 0 to 3 by the word, 4 and 5 for themselves; 0x21000000: bank by bank.
TEST_F(ContentionTest, BanksAreApart) {
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

// 2.1.3: a read of APB has three cycles of data phase, a write four; the bridge does one at a time.
TEST_F(ContentionTest, TheBridgeIsBusyForTheWholeAccess) {
  EXPECT_EQ(wait(Master::core0, 0x4005'4000, 100), 2u);
  EXPECT_EQ(wait(Master::core1, 0x4001'4000, 100), 3u + 2u);
  EXPECT_EQ(bus_.write(0x4001'4000, 0, Width::word, Master::core0, 200).wait, 3u);
  EXPECT_EQ(wait(Master::core1, 0x4001'4000, 203), 1u + 2u);
  EXPECT_EQ(wait(Master::core0, 0x5020'0000, 300), 0u);
  EXPECT_EQ(wait(Master::core1, 0x5030'0000, 300), 1u) << "AHB-Lite peripherals share a port";
  EXPECT_EQ(wait(Master::core0, 0xd000'0000, 400) + wait(Master::core1, 0xd000'0000, 400), 0u)
      << "each core has its own way to SIO";
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

/// Two cores in step.
struct Pair {
  Pair() {
    for (Core* core : {&core0, &core1}) {
      core->reset(0);
      core->set_xpsr(1u << 24);
    }
    bus.set_two_cores(true);
  }
  void code(std::uint32_t at, unsigned instruction, unsigned count) {
    for (unsigned i = 0; i < count; ++i, at += 2) {
      const auto half = static_cast<std::uint16_t>(instruction);
      std::memcpy(bus.memory_at(at).data(), &half, sizeof half);
    }
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
    // What is owed is given back with the next step.
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

// 100 loads of two cycles each from one bank, code elsewhere: after one clash the cores are a cycle
// apart and never meet again. Measured so on silicon by others (rp2040-experiments, bus_behavior,
// experiment 5): 200 and 201 cycles, one contested access.
TEST(TwoCoresInStep, ClashOnceAndAreApartThen) {
  Pair pair;
  pair.code(bank4, 0x6801, 100);  // ldr r1, [r0]
  pair.code(bank5, 0x6801, 100);
  for (Core* core : {&pair.core0, &pair.core1}) core->set_reg(0, 0x2000'0000);
  const auto [cycles0, cycles1] = pair.run(bank4, bank5, 100);
  EXPECT_EQ(std::min(cycles0, cycles1), 200u);
  EXPECT_EQ(std::max(cycles0, cycles1), 201u);
  EXPECT_EQ(pair.bus.arbiter().contested(BusPort::sram0), 1u);
}

TEST(TwoCoresInStep, FetchTheSameCodeATurnApart) {
  Pair pair;
  pair.code(bank4, 0xbf00, 100);
  const auto [cycles0, cycles1] = pair.run(bank4, bank4, 100);
  EXPECT_EQ(cycles0 + cycles1, 201u) << "a word every two cycles each: room for both";
  EXPECT_EQ(pair.bus.arbiter().contested(BusPort::sram4), 1u);
}

TEST(TwoCoresInStep, DoNotMeetInDifferentBanks) {
  Pair pair;
  pair.code(bank4, 0x6801, 100);
  pair.code(bank5, 0x6801, 100);
  pair.core0.set_reg(0, 0x2000'0000);
  pair.core1.set_reg(0, 0x2000'0004);
  EXPECT_EQ(pair.run(bank4, bank5, 100), (std::array<Cycle, 2>{200, 200}));
}

/// Core 0 loads 200 times from bank 4 while the DMA copies there as fast as it can.
Cycle loads_beside_dma(bool dma, std::uint32_t priorities) {
  Chip chip;
  chip.power_on();
  chip.run_until(2000);
  Bus& bus = chip.bus();
  const auto write = [&](std::uint32_t address, std::uint32_t value) {
    bus.write(address, value, Width::word, Master::core0, chip.now());
  };
  write(0x4000'f000, 1u << 1 | 1u << 2);  // out of reset: BUSCTRL, DMA
  write(0x4003'0000, priorities);
  write(0x4003'000c, 6);  // PERFSEL0: contested accesses of SRAM4
  for (std::uint32_t i = 0; i < 200; ++i) {
    const std::uint16_t load = 0x6801;
    std::memcpy(bus.memory_at(bank5 + 2 * i).data(), &load, sizeof load);
  }
  const std::uint16_t stay = 0xe7fe;
  std::memcpy(bus.memory_at(bank5 + 400).data(), &stay, sizeof stay);
  if (dma) {
    write(0x5000'0000, bank4);
    write(0x5000'0004, bank4 + 0x800);
    write(0x5000'0008, 10'000);
    write(0x5000'000c, 0x3fu << 15 | 2u << 2 | 1u);  // unpaced words, one address
  }
  Core& core = chip.core(0);
  core.set_reg(0, bank4);
  core.set_reg(15, bank5);
  const Cycle from = core.cycle();
  while (core.reg(15) != bank5 + 400) chip.run_until(core.cycle() + 1);
  const Cycle cycles = core.cycle() - from;
  const bool contested = bus.read(0x4003'0008, Width::word, Master::core0, chip.now()).value != 0;
  EXPECT_EQ(contested, dma);
  return cycles;
}

// 2.1.1.1: accesses of a high-priority master to a memory without wait states never take longer.
TEST(DmaStream, HoldsUpACoreOnlyWithPriority) {
  EXPECT_EQ(loads_beside_dma(false, 0), 400u);
  // By turns the core, which asks in every second cycle, is always the one that waited longer.
  EXPECT_EQ(loads_beside_dma(true, 0), 400u);
  EXPECT_EQ(loads_beside_dma(true, 1u << 0), 400u);
  // A stream with priority leaves no cycle free: the core waits for its end.
  EXPECT_GT(loads_beside_dma(true, 1u << 8 | 1u << 12), 9'000u);
}

}  // namespace
}  // namespace lamplock::test
