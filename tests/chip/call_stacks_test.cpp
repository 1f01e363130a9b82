// The cycles of a core by function, as folded stacks and as a table; cycles from the Cortex-M0+
// TRM, 3.3.
#include "sim/chip/profile/call_stacks.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "sim/chip/profile/profile.hpp"
#include "tests/chip/core_rig.hpp"

namespace lamplock::test::call_stacks_test {
namespace {

using sim::chip::CallStacks;
using sim::chip::Cycle;
using sim::chip::ImageSymbol;
using sim::chip::Profile;
using sim::chip::ProfileEntry;
using sim::chip::ShadowStack;

/// main calls f, f calls g.
void put_program(CoreRig& rig) {
  rig.put(CoreRig::code, {0xf000, 0xf806, 0xe7fe});                 // bl f; b .
  rig.put(CoreRig::code + 0x10, {0xb500, 0xf000, 0xf805, 0xbd00});  // push {lr}; bl g; pop {pc}
  rig.put(CoreRig::code + 0x20, {0xbf00, 0x4770});                  // nop; bx lr
  rig.restart();
}

const std::vector<ImageSymbol> symbols{{"main", CoreRig::code, 6, true},
                                       {"f(int; int)", CoreRig::code + 0x10, 0, true},
                                       {"table", CoreRig::code + 0x12, 4, false},
                                       {"g", CoreRig::code + 0x20, 4, true}};

Cycle sum(const std::string& folded) {
  std::istringstream in(folded);
  Cycle total = 0;
  for (std::string line; std::getline(in, line);)
    total += std::stoull(line.substr(line.rfind(' ')));
  return total;
}

TEST(CallStacks, FollowCallsAndReturns) {
  CoreRig rig;
  put_program(rig);
  ShadowStack calls(rig.core, symbols);
  const CallStacks stacks(calls);
  const Cycle begin = rig.core.cycle();
  for (int i = 0; i < 6; ++i) rig.core.step();
  ASSERT_EQ(rig.core.reg(15), CoreRig::code + 4);
  rig.core.step();
  // BL 3, PUSH 1 + 1, POP with the program counter 3 + 1, NOP 1, BX 2, B 2.
  EXPECT_EQ(stacks.folded(),
            "core0;main 5\ncore0;main;f(int: int) 9\ncore0;main;f(int: int);g 3\n");
  EXPECT_EQ(sum(stacks.folded()), rig.core.cycle() - begin);
}

TEST(CallStacks, NameFunctionsWithoutSymbolsByTheirAddress) {
  CoreRig rig;
  put_program(rig);
  ShadowStack calls(rig.core, {});
  const CallStacks stacks(calls);
  for (int i = 0; i < 7; ++i) rig.core.step();
  EXPECT_EQ(stacks.folded(),
            "core0;0x20000000 5\ncore0;0x20000000;0x20000010 9\n"
            "core0;0x20000000;0x20000010;0x20000020 3\n");
}

TEST(CallStacks, PutInterruptsOnTheInterruptedFunction) {
  CoreRig rig;
  put_program(rig);
  ShadowStack calls(rig.core, symbols);
  const CallStacks stacks(calls);
  rig.poke(0xe000'e100, 1u << 5);  // NVIC_ISER: USBCTRL
  rig.irqs.set(sim::chip::Irq::usbctrl, true);
  rig.core.step();
  rig.irqs.set(sim::chip::Irq::usbctrl, false);
  for (int i = 0; i < 8; ++i) rig.core.step();
  const std::string folded = stacks.folded();
  EXPECT_NE(folded.find("core0;main;[USBCTRL];0x2003"), std::string::npos) << folded;
  EXPECT_NE(folded.find(";f(int: int);g "), std::string::npos) << folded;
}

/// Both views of one stack.
struct Views {
  explicit Views(CoreRig& rig) : calls(rig.core, symbols), ways(calls), table(calls) {}
  ProfileEntry entry(const std::string& name) const {
    for (const ProfileEntry& each : table.functions())
      if (each.name == name) return each;
    return {};
  }
  /// Each cycle belongs to a function or to sleep.
  void expect_sums() const {
    Cycle all = table.asleep();
    for (const ProfileEntry& each : table.functions()) all += each.total;
    EXPECT_EQ(all, table.cycles());
    EXPECT_EQ(sum(ways.folded()), table.cycles());
  }
  ShadowStack calls;
  CallStacks ways;
  Profile table;
};

TEST(ShadowStack, AResetOfTheChipEndsItsHandlers) {
  CoreRig rig;
  put_program(rig);
  const Views views(rig);
  rig.poke(0xe000'e100, 1u << 5);  // NVIC_ISER: USBCTRL
  rig.irqs.set(sim::chip::Irq::usbctrl, true);
  rig.core.step();
  ASSERT_NE(rig.core.exception(), 0u);
  rig.irqs.set(sim::chip::Irq::usbctrl, false);
  rig.restart();
  for (int i = 0; i < 7; ++i) rig.core.step();  // f and g are called and have returned
  const Cycle main = views.entry("main").total;
  for (int i = 0; i < 100; ++i) rig.core.step();
  EXPECT_EQ(views.entry("main").total, main + 200) << "B . takes two cycles";
  views.expect_sums();
}

TEST(ShadowStack, ACallBelowTheDeepestFrameLosesNoCycle) {
  CoreRig rig;
  // main: bl f; b .   f: push {lr}; subs r4, #1; beq out; bl f; out: pop {pc}
  rig.put(CoreRig::code, {0xf000, 0xf806, 0xe7fe});
  rig.put(CoreRig::code + 0x10, {0xb500, 0x3c01, 0xd001, 0xf7ff, 0xfffb, 0xbd00});
  rig.restart();
  rig.core.set_reg(4, 300);
  const Views views(rig);
  while (rig.core.reg(15) != CoreRig::code + 4) rig.core.step();
  views.expect_sums();
  EXPECT_EQ(views.entry("f(int; int)").count, 300u);
  // PUSH 2, SUBS 1, BEQ 1 (taken 2), BL 3 (the last makes none), POP with PC 4.
  EXPECT_EQ(views.entry("f(int; int)").total, 300u * (2 + 1 + 1 + 3 + 4) + 1 - 3);
  EXPECT_EQ(views.entry("main").total, 3u);
}

TEST(ShadowStack, SleepThatHasNotEndedCounts) {
  CoreRig rig;
  rig.put(CoreRig::code, {0xbf30});  // wfi
  rig.restart();
  const Views views(rig);
  rig.core.step();
  rig.core.idle_to(rig.core.cycle() + 1000);
  EXPECT_GE(views.table.asleep(), 1000u);
  views.expect_sums();
}

}  // namespace
}  // namespace lamplock::test::call_stacks_test
