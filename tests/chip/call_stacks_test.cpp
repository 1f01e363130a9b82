// Folded stacks of a core, with cycles from the Cortex-M0+ TRM, 3.3.
#include "sim/chip/profile/call_stacks.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/chip/core_rig.hpp"

namespace lamplock::test {
namespace {

using sim::chip::CallStacks;
using sim::chip::Cycle;
using sim::chip::ImageSymbol;

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
  CallStacks stacks(rig.core, symbols);
  rig.core.listen(&stacks);
  const Cycle begin = rig.core.cycle();
  for (int i = 0; i < 6; ++i) rig.core.step();
  ASSERT_EQ(rig.core.reg(15), CoreRig::code + 4);
  rig.core.step();
  // BL 3, PUSH 1 + 1, POP with the program counter 3 + 1, NOP 1, BX 2, B 2.
  EXPECT_EQ(stacks.folded(),
            "core0;main 5\ncore0;main;f(int: int) 9\ncore0;main;f(int: int);g 3\n");
  EXPECT_EQ(sum(stacks.folded()), rig.core.cycle() - begin);
  rig.core.listen(nullptr);
}

TEST(CallStacks, NameFunctionsWithoutSymbolsByTheirAddress) {
  CoreRig rig;
  put_program(rig);
  CallStacks stacks(rig.core, {});
  rig.core.listen(&stacks);
  for (int i = 0; i < 7; ++i) rig.core.step();
  EXPECT_EQ(stacks.folded(),
            "core0;0x20000000 5\ncore0;0x20000000;0x20000010 9\n"
            "core0;0x20000000;0x20000010;0x20000020 3\n");
  rig.core.listen(nullptr);
}

TEST(CallStacks, PutInterruptsOnWhatTheyInterrupt) {
  CoreRig rig;
  put_program(rig);
  CallStacks stacks(rig.core, symbols);
  rig.core.listen(&stacks);
  rig.poke(0xe000'e100, 1u << 5);  // NVIC_ISER: USBCTRL
  rig.irqs.set(sim::chip::Irq::usbctrl, true);
  rig.core.step();
  rig.irqs.set(sim::chip::Irq::usbctrl, false);
  for (int i = 0; i < 8; ++i) rig.core.step();
  const std::string folded = stacks.folded();
  EXPECT_NE(folded.find("core0;main;[USBCTRL];0x2003"), std::string::npos) << folded;
  EXPECT_NE(folded.find(";f(int: int);g "), std::string::npos) << folded;
  rig.core.listen(nullptr);
}

}  // namespace
}  // namespace lamplock::test
