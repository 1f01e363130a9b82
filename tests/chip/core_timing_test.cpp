// Cycles of every class of instruction against the table of the Cortex-M0+ Technical Reference
// Manual (table 3-1, single-cycle multiplier, memory without wait states), and of exceptions.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/chip/core_rig.hpp"
#include "tests/chip/listeners.hpp"

namespace lamplock::test::core_timing_test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

struct Row {
  const char* what;
  std::vector<unsigned> code;
  Cycle cycles;
};

// r0 = data, r1 = 4, r2 = SIO, r3 = code address + 1 (Thumb), sp = in data; all flags clear but C.
const std::vector<Row>& table() {
  static const std::vector<Row> rows = {
      {"movs imm", {0x2001}, 1},    {"movs reg", {0x0009}, 1},    {"mov high", {0x4688}, 1},
      {"mov pc", {0x469f}, 2},      {"adds imm3", {0x1c49}, 1},   {"adds reg", {0x1849}, 1},
      {"add high", {0x4441}, 1},    {"add pc", {0x448f}, 2},      {"adds imm8", {0x3101}, 1},
      {"adcs", {0x4149}, 1},        {"add sp imm", {0xb001}, 1},  {"add rd sp", {0xa901}, 1},
      {"adr", {0xa101}, 1},         {"subs reg", {0x1a49}, 1},    {"subs imm3", {0x1e49}, 1},
      {"subs imm8", {0x3901}, 1},   {"sbcs", {0x4189}, 1},        {"sub sp imm", {0xb081}, 1},
      {"rsbs", {0x4249}, 1},        {"muls", {0x4349}, 1},        {"cmp reg", {0x4289}, 1},
      {"cmn", {0x42c9}, 1},         {"cmp imm", {0x2901}, 1},     {"cmp high", {0x4588}, 1},
      {"ands", {0x4009}, 1},        {"eors", {0x4049}, 1},        {"orrs", {0x4309}, 1},
      {"bics", {0x4389}, 1},        {"mvns", {0x43c9}, 1},        {"tst", {0x4209}, 1},
      {"lsls imm", {0x0049}, 1},    {"lsls reg", {0x4089}, 1},    {"lsrs imm", {0x0849}, 1},
      {"lsrs reg", {0x40c9}, 1},    {"asrs imm", {0x1049}, 1},    {"asrs reg", {0x4109}, 1},
      {"rors", {0x41c9}, 1},        {"ldr imm", {0x6804}, 2},     {"ldrh imm", {0x8804}, 2},
      {"ldrb imm", {0x7804}, 2},    {"ldr reg", {0x5844}, 2},     {"ldrh reg", {0x5a44}, 2},
      {"ldrsh reg", {0x5e44}, 2},   {"ldrb reg", {0x5c44}, 2},    {"ldrsb reg", {0x5644}, 2},
      {"ldr literal", {0x4c01}, 2}, {"ldr sp", {0x9c01}, 2},      {"str imm", {0x6004}, 2},
      {"strh imm", {0x8004}, 2},    {"strb imm", {0x7004}, 2},    {"str reg", {0x5044}, 2},
      {"strh reg", {0x5244}, 2},    {"strb reg", {0x5444}, 2},    {"str sp", {0x9401}, 2},
      {"ldr SIO", {0x6814}, 1},     {"str SIO", {0x6014}, 1},     {"ldrb SIO", {0x7814}, 1},
      {"strb SIO", {0x7014}, 1},    {"ldm 1", {0xc810}, 2},       {"ldm 4", {0xc8f0}, 5},
      {"ldm 8", {0xc8ff}, 9},       {"stm 1", {0xc010}, 2},       {"stm 4", {0xc0f0}, 5},
      {"stm 8", {0xc0ff}, 9},       {"push 1", {0xb410}, 2},      {"push 8 lr", {0xb5ff}, 10},
      {"push lr", {0xb500}, 2},     {"pop 1", {0xbc10}, 2},       {"pop 8", {0xbcff}, 9},
      {"pop pc", {0xbd00}, 4},      {"pop 4 pc", {0xbdf0}, 8},    {"beq not taken", {0xd000}, 1},
      {"bne taken", {0xd100}, 2},   {"b", {0xe000}, 2},           {"bl", {0xf000, 0xf800}, 3},
      {"bx", {0x4718}, 2},          {"blx", {0x4798}, 2},         {"sxth", {0xb209}, 1},
      {"sxtb", {0xb249}, 1},        {"uxth", {0xb289}, 1},        {"uxtb", {0xb2c9}, 1},
      {"rev", {0xba09}, 1},         {"rev16", {0xba49}, 1},       {"revsh", {0xbac9}, 1},
      {"cpsid", {0xb672}, 1},       {"cpsie", {0xb662}, 1},       {"mrs", {0xf3ef, 0x8400}, 3},
      {"msr", {0xf381, 0x8800}, 3}, {"dmb", {0xf3bf, 0x8f5f}, 3}, {"dsb", {0xf3bf, 0x8f4f}, 3},
      {"isb", {0xf3bf, 0x8f6f}, 3}, {"sev", {0xbf40}, 1},         {"yield", {0xbf10}, 1},
      {"nop", {0xbf00}, 1},         {"wfi", {0xbf30}, 2},         {"wfe", {0xbf20}, 2},
  };
  return rows;
}

void prepare(CoreRig& rig) {
  rig.restart();
  for (std::uint32_t i = 0; i < 64; ++i) rig.put_word(CoreRig::data + 4 * i, CoreRig::code + 0x101);
  rig.core.set_reg(0, CoreRig::data);
  rig.core.set_reg(1, 4);
  rig.core.set_reg(2, 0xd000'0000);
  rig.core.set_reg(3, CoreRig::code + 0x201);
  rig.core.set_reg(13, CoreRig::data + 64);
  rig.core.set_xpsr((1u << 29) | (1u << 24));
}

TEST(CoreTiming, EveryInstructionClassAsTheManual) {
  CoreRig rig;
  for (const Row& row : table()) {
    prepare(rig);
    std::uint32_t at = CoreRig::code + 0x100;
    for (const unsigned half : row.code) {
      rig.put(at, {half});
      at += 2;
    }
    rig.core.set_reg(15, CoreRig::code + 0x100);
    EXPECT_EQ(rig.core.step(), row.cycles) << row.what;
    EXPECT_EQ(rig.core.exception(), 0u) << row.what;
  }
}

/// Cycles of one instruction with r0 = `address`.
Cycle cost(CoreRig& rig, std::uint32_t address, unsigned half) {
  prepare(rig);
  rig.put(CoreRig::code + 0x100, {half});
  rig.core.set_reg(0, address);
  rig.core.set_reg(15, CoreRig::code + 0x100);
  return rig.core.step();
}

// On APB a read has 3 cycles of data phase and a write 4 (RP2040 datasheet, 2.1.3), instead of the
// single cycle of an access without wait states.
TEST(CoreTiming, ApbCostsWhatTheBridgeAdds) {
  CoreRig rig;
  EXPECT_EQ(cost(rig, 0x4005'4000, 0x6804), 1u + 3u);  // ldr
  EXPECT_EQ(cost(rig, 0x4005'4000, 0x6004), 1u + 4u);  // str
}

TEST(CoreTiming, WaitStatesOfTheBusAreAdded) {
  Timing timing;
  timing.apb_read_wait = 3;
  timing.apb_write_wait = 4;
  timing.ahb_wait = 1;
  CoreRig rig(timing);
  EXPECT_EQ(cost(rig, 0x4005'4000, 0x6804), 5u);                // ldr, APB
  EXPECT_EQ(cost(rig, 0x4005'4000, 0x6004), 6u);                // str, APB
  EXPECT_EQ(cost(rig, 0x5020'0000, 0x6804), 3u);                // ldr, AHB-Lite
  EXPECT_EQ(cost(rig, 0x4005'4000, 0xc830), 1u + 2 * (1 + 3));  // ldm of two
  EXPECT_EQ(cost(rig, 0xe000'ed00, 0x6804), 2u);                // the core's own registers
}

/// Records entries, calls and branches.
struct Entries final : rigs::QuietListener {
  struct Entry {
    unsigned number;
    Cycle at;
  };
  struct Jump {
    bool call;
    std::uint32_t to;
    Cycle at;
    bool operator==(const Jump&) const = default;
  };
  void exception_entered(int, unsigned number, Cycle, Cycle at) override {
    entries.push_back({number, at});
  }
  void called(int, std::uint32_t, std::uint32_t to, Cycle at) override {
    jumps.push_back({true, to, at});
  }
  void branched(int, std::uint32_t to, Cycle at) override { jumps.push_back({false, to, at}); }
  std::vector<Entry> entries;
  std::vector<Jump> jumps;
};

/// Runs a program repeatedly; raises line 0 at `when` and returns the cycles from there to the
/// handler's first instruction.
Cycle latency(const std::vector<unsigned>& code, Cycle delay) {
  CoreRig rig;
  prepare(rig);
  Entries entries;
  rig.core.listen(&entries);
  Alarm alarm(rig.wheel);
  std::uint32_t at = CoreRig::code + 0x100;
  for (int i = 0; i < 40; ++i)
    for (const unsigned half : code) {
      rig.put(at, {half});
      at += 2;
    }
  rig.poke(0xe000'e100, 1);
  rig.core.set_reg(15, CoreRig::code + 0x100);
  const Cycle when = rig.core.cycle() + delay;
  alarm.at(when, [&] { rig.irqs.set(Irq::timer_0, true); });
  rig.core.run_until(when + 200);
  EXPECT_FALSE(entries.entries.empty());
  if (entries.entries.empty()) return 0;
  EXPECT_EQ(entries.entries.front().number, 16u);
  return entries.entries.front().at - when;
}

TEST(CoreTiming, InterruptLatencyIs15AtMost) {
  const std::vector<std::vector<unsigned>> programs = {
      {0xbf00},         {0x6804}, {0x6004},         {0xc8f0, 0x3810}, {0xc0f0, 0x3810},
      {0xb4ff, 0xbcff}, {0xe7ff}, {0xf000, 0xf800}, {0xf3bf, 0x8f4f}, {0xf3ef, 0x8400},
      {0xbf30},         {0x6814}, {0xbd00},         {0x4718}};
  for (const auto& program : programs)
    for (Cycle delay = 1; delay < 30; ++delay)
      EXPECT_EQ(latency(program, delay), 15u) << std::hex << program[0] << " " << delay;
}

// Otherwise a long PUSH would delay the interrupt; after the handler the access restarts.
TEST(CoreTiming, MultipleAccessIsAbandonedAndRestarted) {
  CoreRig rig;
  prepare(rig);
  Alarm alarm(rig.wheel);
  rig.put(CoreRig::code + 0x100, {0xcaff, 0xbf00});  // ldm r2!, {r0-r7}
  rig.core.set_reg(2, CoreRig::data);
  rig.core.set_reg(7, 77);
  rig.poke(0xe000'e100, 1);
  rig.core.set_reg(15, CoreRig::code + 0x100);
  const Cycle start = rig.core.cycle();
  alarm.at(start + 4, [&] { rig.irqs.set(Irq::timer_0, true); });
  EXPECT_EQ(rig.core.step(), 4u);
  EXPECT_EQ(rig.core.reg(15), CoreRig::code + 0x100);
  EXPECT_EQ(rig.core.reg(2), CoreRig::data);
  EXPECT_EQ(rig.core.reg(7), 77u);
  rig.core.step();
  EXPECT_EQ(rig.core.cycle(), start + 19);
  EXPECT_EQ(rig.core.exception(), 16u);
  rig.irqs.set(Irq::timer_0, false);
  rig.core.step();
  rig.core.step();
  EXPECT_EQ(rig.core.exception(), 0u);
  EXPECT_EQ(rig.core.step(), 9u);
  EXPECT_EQ(rig.core.reg(7), CoreRig::code + 0x101);
  EXPECT_EQ(rig.core.reg(15), CoreRig::code + 0x102);
}

TEST(CoreTiming, ReturnAndTailChainCostTheirTiming) {
  Timing timing;
  timing.exception_return = 11;
  timing.tail_chain = 6;
  CoreRig rig(timing);
  rig.put(CoreRig::code, {0xbf00, 0xbf00, 0xbf00});
  rig.poke(0xe000'e100, 3);
  rig.irqs.set(Irq::timer_0, true);
  EXPECT_EQ(rig.core.step(), 15u);
  rig.irqs.set(Irq::timer_0, false);
  rig.core.step();
  EXPECT_EQ(rig.core.step(), 11u);
  EXPECT_EQ(rig.core.exception(), 0u);
  rig.irqs.set(Irq::timer_0, true);
  rig.irqs.set(Irq::timer_1, true);
  rig.core.step();
  EXPECT_EQ(rig.core.exception(), 16u);
  rig.irqs.set(Irq::timer_0, false);
  rig.core.step();
  const std::uint32_t sp = rig.core.reg(13);
  EXPECT_EQ(rig.core.step(), 6u);
  EXPECT_EQ(rig.core.exception(), 17u);
  EXPECT_EQ(rig.core.reg(13), sp);
  EXPECT_EQ(rig.core.reg(14), 0xffff'fff9u);
}

TEST(CoreTiming, AListenerGetsEveryCallAndBranchOfARun) {
  CoreRig rig;
  Entries heard;
  rig.core.listen(&heard);
  constexpr std::uint32_t code = CoreRig::code, function = code + 0x20;
  // bl function; blx r3; mov pc, r4: to itself.
  rig.put(code, {0xf000, 0xf80e, 0x4798, 0x46a7});
  rig.put(function, {0xb500, 0xbd00});  // push {lr}; pop {pc}
  rig.put(function + 0x20, {0x4770});   // bx lr
  rig.core.set_reg(3, function + 0x21);
  rig.core.set_reg(4, code + 6);
  rig.core.set_reg(15, code);
  const Cycle from = rig.core.cycle();
  rig.core.run_until(from + 15);
  const std::vector<Entries::Jump> wanted = {{true, function, from + 3},
                                             {false, code + 4, from + 3 + 2 + 4},
                                             {true, function + 0x20, from + 11},
                                             {false, code + 6, from + 13},
                                             {false, code + 6, from + 15}};
  EXPECT_EQ(heard.jumps, wanted);
}

}  // namespace
}  // namespace lamplock::test::core_timing_test
