// Both cores of a chip: who runs when, and that one which sleeps wakes in its cycle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <initializer_list>
#include <random>
#include <tuple>
#include <vector>

#include "sim/chip/chip.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

constexpr std::uint32_t sleep_code = 0x2004'0000, handler = 0x2004'0100, vectors = 0x2004'1000,
                        loop_code = 0x2000'0000, marks = 0x2004'0800, other_stack = 0x2004'2000;
constexpr std::uint32_t syst_csr = 0xe000'e010;

void put(Chip& chip, std::uint32_t address, std::initializer_list<unsigned> code) {
  for (const unsigned value : code) {
    const auto half = static_cast<std::uint16_t>(value);
    std::memcpy(chip.bus().memory_at(address).data(), &half, sizeof half);
    address += 2;
  }
}
void put_word(Chip& chip, std::uint32_t address, std::uint32_t value) {
  std::memcpy(chip.bus().memory_at(address).data(), &value, sizeof value);
}

/// Enters code as the ROM would, both cores in the same cycle.
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
    core.send_event();  // out of whatever it waits in
  }

 private:
  Chip& chip_;
};

/// Counts the cycles at which handlers begin.
class Entries final : public CoreListener {
 public:
  void exception_entered(int core, unsigned number, Cycle /*since*/, Cycle at) override {
    entries.emplace_back(core, number, at);
  }
  void exception_left(int /*core*/, unsigned /*number*/, Cycle /*at*/) override {}
  void called(int /*core*/, std::uint32_t /*from*/, std::uint32_t /*to*/, Cycle /*at*/) override {}
  void branched(int /*core*/, std::uint32_t /*to*/, Cycle /*at*/) override {}
  void slept(int core, Cycle at) override { sleeps.emplace_back(core, at); }
  void woke(int core, Cycle at) override { wakes.emplace_back(core, at); }
  void masked(int /*core*/, bool /*off*/, Cycle /*at*/) override {}
  std::vector<std::tuple<int, unsigned, Cycle>> entries;
  std::vector<std::tuple<int, Cycle>> sleeps, wakes;
};

// ARMv6-M ARM, B3.3: with SYST_RVR n the count reaches 0 every n + 1 cycles. A core in WFI wakes
// then and enters its handler 15 cycles later (Cortex-M0+ TRM, 3.6.1), whatever the other one does.
TEST(TwoCores, OnesOwnSysTickWakesItInItsCycle) {
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

/// Looks at nothing and lets everything pass: the chip goes step by step.
class Onlooker final : public StepWatcher {
 public:
  bool before_step(Core& /*core*/) override { return true; }
};

// A core may run on without the other one only where nobody can tell: random programs that share
// words, wake each other and sleep give the same run step by step, and however time is cut.
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
      Onlooker onlooker;
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
    // Where time is cut a sleeping core may stand elsewhere; what the cores have done is the same.
    results[0][0] = results[2][0] = 0;
    results[0][17] = results[2][17] = 0;
    ASSERT_EQ(results[0], results[2]) << round;
  }
}

}  // namespace
}  // namespace lamplock::test
