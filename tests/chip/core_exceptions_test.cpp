// Exceptions of the core against the ARMv6-M Architecture Reference Manual, B1.5: entry, return,
// priorities, chains, sleep, faults and lock-up; NVIC, SCB and SysTick registers.
#include <gtest/gtest.h>

#include <vector>

#include "tests/chip/core_rig.hpp"

namespace lamplock::test::core_exceptions_test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

constexpr std::uint32_t iser = 0xe000'e100, icer = 0xe000'e180, ispr = 0xe000'e200,
                        icpr = 0xe000'e280, ipr = 0xe000'e400, icsr = 0xe000'ed04,
                        aircr = 0xe000'ed0c, scr = 0xe000'ed10, shpr2 = 0xe000'ed1c,
                        shpr3 = 0xe000'ed20, syst_csr = 0xe000'e010, syst_rvr = 0xe000'e014,
                        syst_cvr = 0xe000'e018;
constexpr std::uint32_t thumb = 1u << 24;

class CoreExceptions : public testing::Test {
 protected:
  CoreExceptions() {
    for (std::uint32_t i = 0; i < 64; ++i) rig_.put(CoreRig::code + 2 * i, {0xbf00});
  }
  void raise(unsigned line, bool level = true) { rig_.irqs.set(static_cast<Irq>(line), level); }
  /// Enables line 0 and enters its handler.
  void enter() {
    rig_.poke(iser, 1);
    raise(0);
    core_.step();
  }
  /// Lowers a line and returns from its handler.
  void leave(unsigned line) {
    raise(line, false);
    steps(2);
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) core_.step();
  }
  void run_at(std::uint32_t address, std::initializer_list<unsigned> code) {
    rig_.put(address, code);
    core_.set_reg(15, address);
  }
  CoreRig rig_;
  Core& core_ = rig_.core;
};

TEST_F(CoreExceptions, ResetTakesStackAndEntryFromTheTable) {
  EXPECT_EQ(core_.reg(13), CoreRig::stack);
  EXPECT_EQ(core_.reg(15), CoreRig::code);
  EXPECT_EQ(core_.xpsr() & thumb, thumb);
  EXPECT_FALSE(core_.primask());
  EXPECT_EQ(core_.control(), 0u);
}

TEST_F(CoreExceptions, EntryPushesTheFrame) {
  for (unsigned i = 0; i < 13; ++i) core_.set_reg(i, 0x100 + i);
  core_.set_reg(14, 0xabcd'ef01);
  core_.set_xpsr(thumb | (5u << 29));
  enter();
  const std::uint32_t frame = CoreRig::stack - 32;
  EXPECT_EQ(core_.reg(13), frame);
  const std::vector<std::uint32_t> wanted = {0x100, 0x101,       0x102,         0x103,
                                             0x10c, 0xabcd'ef01, CoreRig::code, thumb | (5u << 29)};
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(rig_.word(frame + 4 * i), wanted[i]) << i;
  EXPECT_EQ(core_.reg(14), 0xffff'fff9u);
  EXPECT_EQ(core_.reg(15), CoreRig::handler_of(16));
  EXPECT_EQ(core_.exception(), 16u);
  raise(0, false);
  for (unsigned i = 0; i < 4; ++i) core_.set_reg(i, 0);
  steps(2);
  EXPECT_EQ(core_.exception(), 0u);
  EXPECT_EQ(core_.reg(13), CoreRig::stack);
  EXPECT_EQ(core_.reg(14), 0xabcd'ef01u);
  EXPECT_EQ(core_.reg(3), 0x103u);
  EXPECT_EQ(core_.xpsr(), thumb | (5u << 29));
}

TEST_F(CoreExceptions, FrameIsAlignedToEightBytesAndPutBack) {
  for (const std::uint32_t sp : {CoreRig::stack - 4, CoreRig::stack - 8}) {
    rig_.restart();
    core_.set_reg(13, sp);
    enter();
    EXPECT_EQ(core_.reg(13) & 7, 0u);
    EXPECT_EQ((rig_.word(core_.reg(13) + 28) >> 9) & 1, (sp & 4) != 0 ? 1u : 0u);
    leave(0);
    EXPECT_EQ(core_.reg(13), sp);
  }
}

TEST_F(CoreExceptions, ProcessStackIsUsedAndRestored) {
  core_.set_psp(CoreRig::data + 0x200);
  run_at(CoreRig::code, {0xf381, 0x8814, 0xbf00});  // msr control, r1
  core_.set_reg(1, 2);
  core_.step();
  EXPECT_EQ(core_.reg(13), CoreRig::data + 0x200);
  EXPECT_EQ(core_.msp(), CoreRig::stack);
  enter();
  EXPECT_EQ(core_.reg(14), 0xffff'fffdu);
  EXPECT_EQ(core_.reg(13), CoreRig::stack);
  EXPECT_EQ(core_.psp(), CoreRig::data + 0x200 - 32);
  EXPECT_EQ(core_.control(), 0u);
  leave(0);
  EXPECT_EQ(core_.reg(13), CoreRig::data + 0x200);
  EXPECT_EQ(core_.control(), 2u);
}

TEST_F(CoreExceptions, HigherPriorityPreemptsAndEqualDoesNot) {
  rig_.poke(iser, 7);
  rig_.poke(ipr, 0x0040'80c0);  // lines 0, 1, 2: priorities 3, 2, 1
  raise(0);
  core_.step();
  EXPECT_EQ(core_.exception(), 16u);
  raise(1);
  core_.step();
  EXPECT_EQ(core_.exception(), 17u);
  EXPECT_EQ(core_.reg(14), 0xffff'fff1u);
  rig_.poke(ipr, 0x0080'80c0);  // line 2 as line 1 now
  raise(2);
  core_.step();
  EXPECT_EQ(core_.exception(), 17u);
  raise(1, false);
  raise(0, false);
  core_.step();  // bx lr chains to line 2
  EXPECT_EQ(core_.exception(), 18u);
  leave(2);
  EXPECT_EQ(core_.exception(), 16u);
  steps(2);
  EXPECT_EQ(core_.exception(), 0u);
  EXPECT_EQ(core_.reg(13), CoreRig::stack);
}

TEST_F(CoreExceptions, OfEqualPrioritiesTheLowestNumberGoesFirst) {
  rig_.poke(iser, 0xffff'ffff);
  raise(9);
  raise(4);
  core_.step();
  EXPECT_EQ(core_.exception(), 20u);
}

TEST_F(CoreExceptions, LateArrivalTakesThePlaceOfTheFirst) {
  for (Cycle delay = 1; delay < 15; ++delay) {
    rig_.restart();
    rig_.poke(iser, 3);
    rig_.poke(ipr, 0x0000'00c0);
    Alarm alarm(rig_.wheel);
    const Cycle start = core_.cycle();
    raise(0);
    alarm.at(start + delay, [&] { raise(1); });
    core_.step();
    EXPECT_EQ(core_.exception(), 17u) << delay;
    EXPECT_LE(core_.cycle() - (start + delay), 15u);
    EXPECT_GE(core_.cycle() - start, 15u);
    EXPECT_EQ(core_.reg(14), 0xffff'fff9u);
    leave(1);
    EXPECT_EQ(core_.exception(), 16u);  // chained
    leave(0);
    EXPECT_EQ(core_.exception(), 0u);
    EXPECT_EQ(core_.reg(13), CoreRig::stack);
  }
}

TEST_F(CoreExceptions, AnExceptionDuringTheReturnIsChained) {
  rig_.poke(iser, 3);
  raise(0);
  core_.step();
  raise(0, false);
  core_.step();
  Alarm alarm(rig_.wheel);
  const Cycle when = core_.cycle() + 5;
  alarm.at(when, [&] { raise(1); });
  const std::uint32_t sp = core_.reg(13);
  core_.step();
  EXPECT_EQ(core_.exception(), 17u);
  EXPECT_EQ(core_.reg(13), sp);
  EXPECT_LE(core_.cycle() - when, 15u);
}

TEST_F(CoreExceptions, PrimaskHoldsBackButNotFaultsAndNmi) {
  rig_.poke(iser, 1);
  core_.set_primask(true);
  raise(0);
  steps(3);
  EXPECT_EQ(core_.exception(), 0u);
  core_.set_nmi_mask(1u << 1);
  raise(1);
  core_.step();
  EXPECT_EQ(core_.exception(), 2u);
  steps(2);
  EXPECT_EQ(core_.exception(), 0u);
  run_at(CoreRig::code, {0xde00});
  core_.step();
  EXPECT_EQ(core_.exception(), 3u);
  core_.set_reg(15, CoreRig::handler_of(3));
  rig_.put_word(core_.reg(13) + 24, CoreRig::code + 2);
  steps(2);
  run_at(CoreRig::code + 2, {0xb662, 0xbf00});  // cpsie i
  core_.step();
  EXPECT_EQ(core_.exception(), 0u);
  core_.step();
  EXPECT_EQ(core_.exception(), 16u);
}

TEST_F(CoreExceptions, LevelPendsAgainAfterTheHandlerWhileItLasts) {
  enter();
  EXPECT_EQ(rig_.peek(ispr), 0u);  // active, not pending
  core_.step();
  core_.step();  // bx lr
  EXPECT_EQ(core_.exception(), 16u);
  leave(0);
  EXPECT_EQ(core_.exception(), 0u);
}

TEST_F(CoreExceptions, RisingAgainWhileActivePendsAndPendingOutlivesTheLine) {
  enter();
  raise(0, false);
  EXPECT_EQ(rig_.peek(ispr), 0u);
  raise(0);
  EXPECT_EQ(rig_.peek(ispr), 1u);
  raise(0, false);
  EXPECT_EQ(rig_.peek(ispr), 1u);
  rig_.poke(icpr, 1);
  EXPECT_EQ(rig_.peek(ispr), 0u);
}

TEST_F(CoreExceptions, ClearingPendingOfAHighLineDoesNotLast) {
  raise(3);
  EXPECT_EQ(rig_.peek(ispr), 8u);
  rig_.poke(icpr, 8);
  EXPECT_EQ(rig_.peek(ispr), 8u);
  EXPECT_EQ(rig_.peek(icsr) & (1u << 22), 1u << 22);
  raise(3, false);
  rig_.poke(icpr, 8);
  EXPECT_EQ(rig_.peek(ispr), 0u);
}

TEST_F(CoreExceptions, SoftwarePendsAnyOfThe32) {
  rig_.poke(iser, 1u << 31);
  EXPECT_EQ(rig_.peek(iser), 1u << 31);
  rig_.poke(ispr, 1u << 31);
  core_.step();
  EXPECT_EQ(core_.exception(), 47u);
  rig_.poke(icer, 1u << 31);
  EXPECT_EQ(rig_.peek(iser), 0u);
}

TEST_F(CoreExceptions, SupervisorCallPendsvAndSystick) {
  run_at(CoreRig::code, {0xdf05});
  core_.step();
  EXPECT_EQ(core_.exception(), 11u);
  EXPECT_EQ(rig_.word(core_.reg(13) + 24), CoreRig::code + 2);
  steps(2);
  rig_.poke(shpr3, 0xc000'0000);  // SysTick 3, PendSV 0
  rig_.poke(icsr, (1u << 26) | (1u << 28));
  core_.step();
  EXPECT_EQ(core_.exception(), 14u);
  EXPECT_EQ((rig_.peek(icsr) >> 12) & 0x3f, 15u);
  steps(2);
  EXPECT_EQ(core_.exception(), 15u);
}

TEST_F(CoreExceptions, SupervisorCallThatCannotBeTakenIsAHardFault) {
  core_.set_primask(true);
  run_at(CoreRig::code, {0xdf05});
  core_.step();
  EXPECT_EQ(core_.exception(), 3u);
  EXPECT_EQ(rig_.word(core_.reg(13) + 24), CoreRig::code);
  rig_.restart();
  rig_.poke(shpr2, 0x8000'0000);
  rig_.poke(iser, 1);
  rig_.poke(ipr, 0x80);
  raise(0);
  core_.step();
  run_at(CoreRig::handler_of(16), {0xdf05});
  core_.step();
  EXPECT_EQ(core_.exception(), 3u);
}

// --- Faults
// -----------------------------------------------------------------------------------------

struct Fault {
  const char* what;
  std::vector<unsigned> code;
  std::uint32_t r0, r1;
};

TEST_F(CoreExceptions, EveryFaultIsAHardFaultThatNamesTheInstruction) {
  constexpr std::uint32_t data = CoreRig::data;
  const std::vector<Fault> faults = {
      {"ldr unaligned 1", {0x6804}, data + 1, 0},
      {"ldr unaligned 2", {0x6804}, data + 2, 0},
      {"ldrh unaligned", {0x8804}, data + 1, 0},
      {"ldrsh unaligned", {0x5e44}, data, 1},
      {"str unaligned", {0x6004}, data + 2, 0},
      {"strh unaligned", {0x8004}, data + 3, 0},
      {"ldm unaligned", {0xc810}, data + 2, 0},
      {"stm unaligned", {0xc010}, data + 1, 0},
      {"ldr unmapped", {0x6804}, 0x3000'0000, 0},
      {"str unmapped", {0x6004}, 0x2004'2000, 0},
      {"ldrb unmapped", {0x7804}, 0x5800'0000, 0},
      {"ldr vendor space", {0x6804}, 0xe010'0000, 0},
      {"ldrh system register", {0x8804}, 0xe000'ed00, 0},
      {"strb system register", {0x7004}, 0xe000'e100, 0},
      {"bkpt", {0xbe00}, 0, 0},
      {"udf", {0xde00}, 0, 0},
      {"udf.w", {0xf7f0, 0xa000}, 0, 0},
      {"cbz", {0xb100}, 0, 0},
      {"it", {0xbf08}, 0, 0},
      {"ldr.w", {0xf8d0, 0x1000}, 0, 0},
      {"mrs basepri", {0xf3ef, 0x8011}, 0, 0},
      {"msr faultmask", {0xf380, 0x8813}, 0, 0},
  };
  for (const Fault& fault : faults) {
    rig_.restart();
    std::uint32_t at = CoreRig::code;
    for (const unsigned half : fault.code) {
      rig_.put(at, {half});
      at += 2;
    }
    core_.set_reg(0, fault.r0);
    core_.set_reg(1, fault.r1);
    core_.step();
    EXPECT_EQ(core_.exception(), 3u) << fault.what;
    EXPECT_EQ(rig_.word(CoreRig::stack - 8), CoreRig::code) << fault.what;
    EXPECT_EQ(core_.reg(0), fault.r0) << fault.what;
  }
}

TEST_F(CoreExceptions, BranchesToInvalidAddressesFaultThere) {
  struct Case {
    std::uint32_t target, pc, t;
  };
  for (const unsigned branch : {0x4700u, 0x4780u})                              // bx r0, blx r0
    for (const Case& c : {Case{CoreRig::code + 0x40, CoreRig::code + 0x40, 0},  // ARM state
                          Case{0x3000'0001, 0x3000'0000, 1},                    // unmapped
                          Case{0x5020'0001, 0x5020'0000, 1},                    // execute-never
                          Case{0xffff'fff9, 0xffff'fff8, 1}}) {                 // not in a handler
      rig_.restart();
      run_at(CoreRig::code, {branch});
      core_.set_reg(0, c.target);
      core_.step();
      EXPECT_EQ(core_.exception(), 0u);
      core_.step();
      EXPECT_EQ(core_.exception(), 3u) << std::hex << c.target;
      EXPECT_EQ(rig_.word(CoreRig::stack - 8), c.pc);
      EXPECT_EQ(rig_.word(CoreRig::stack - 4) >> 24 & 1, c.t);
    }
}

TEST_F(CoreExceptions, FaultInHardFaultOrNmiLocksUpUntilReset) {
  for (const bool nmi : {false, true}) {
    rig_.restart();
    if (nmi)
      rig_.poke(icsr, 1u << 31);
    else
      run_at(CoreRig::code, {0xde00});
    core_.step();
    ASSERT_EQ(core_.exception(), nmi ? 2u : 3u);
    run_at(CoreRig::handler_of(core_.exception()), {0xde00});
    core_.step();
    EXPECT_TRUE(core_.locked_up());
    EXPECT_EQ(core_.step(), 0u);
    const Cycle cycle = core_.cycle();
    core_.run_until(cycle + 1000);
    EXPECT_EQ(core_.cycle(), cycle + 1000);
    EXPECT_TRUE(core_.locked_up());
    rig_.put(CoreRig::handler_of(2), {0xbf00, 0x4770});
    rig_.put(CoreRig::handler_of(3), {0xbf00, 0x4770});
  }
  rig_.restart();
  EXPECT_FALSE(core_.locked_up());
}

TEST_F(CoreExceptions, StackThatFaultsOnEntryIsAHardFaultThenLockUp) {
  core_.set_reg(13, 0x3000'0100);
  enter();
  EXPECT_EQ(core_.exception(), 3u);
  run_at(CoreRig::handler_of(3), {0xde00});
  core_.step();
  EXPECT_TRUE(core_.locked_up());
  rig_.put(CoreRig::handler_of(3), {0xbf00, 0x4770});
}

TEST_F(CoreExceptions, BadExcReturnFaults) {
  for (const std::uint32_t value : {0xffff'fff1u, 0xffff'fff5u, 0xffff'ff99u, 0xf000'0009u}) {
    rig_.restart();
    raise(0, false);
    enter();
    ASSERT_EQ(core_.exception(), 16u);
    core_.set_reg(14, value);
    steps(2);
    EXPECT_EQ(core_.exception(), 3u) << std::hex << value;
  }
}

TEST_F(CoreExceptions, ReturnToThreadFromANestedHandlerFaults) {
  rig_.poke(iser, 3);
  rig_.poke(ipr, 0x0000'00c0);
  raise(0);
  core_.step();
  raise(1);
  core_.step();
  ASSERT_EQ(core_.exception(), 17u);
  core_.set_reg(14, 0xffff'fff9);
  steps(2);
  EXPECT_EQ(core_.exception(), 3u);
}

TEST_F(CoreExceptions, FrameOfTheWrongModeFaultsOnReturn) {
  enter();
  raise(0, false);
  rig_.put_word(core_.reg(13) + 28, thumb | 16);  // claims to return to a handler
  steps(2);
  EXPECT_EQ(core_.exception(), 3u);
}

TEST_F(CoreExceptions, UnprivilegedCodeIsKeptOut) {
  core_.set_control(1);
  run_at(CoreRig::code, {0xb672, 0xf3ef, 0x8108, 0xf380, 0x8810, 0xf380, 0x8808, 0x6804});
  core_.set_reg(0, 0xe000'ed00);
  core_.step();  // cpsid i: ignored
  EXPECT_FALSE(core_.primask());
  core_.set_reg(1, 5);
  core_.step();  // mrs r1, msp reads zero
  EXPECT_EQ(core_.reg(1), 0u);
  core_.step();  // msr primask: ignored
  EXPECT_FALSE(core_.primask());
  core_.step();  // msr msp: ignored
  EXPECT_EQ(core_.msp(), CoreRig::stack);
  core_.step();  // ldr of CPUID
  EXPECT_EQ(core_.exception(), 3u);
}

// --- Sleep
// ------------------------------------------------------------------------------------------

TEST_F(CoreExceptions, WfiSleepsUntilAnInterruptAndRunsItsHandler) {
  run_at(CoreRig::code, {0xbf30, 0x2401});
  rig_.poke(iser, 1);
  core_.set_reg(15, CoreRig::code);
  Alarm alarm(rig_.wheel);
  const Cycle when = core_.cycle() + 1000;
  alarm.at(when, [&] { raise(0); });
  core_.step();
  EXPECT_TRUE(core_.sleeping());
  EXPECT_EQ(core_.step(), 0u);
  core_.idle_to(when + 500);
  EXPECT_EQ(core_.cycle(), when);
  EXPECT_FALSE(core_.sleeping());
  core_.step();
  EXPECT_EQ(core_.exception(), 16u);
  EXPECT_EQ(core_.cycle(), when + 15);
  raise(0, false);
  steps(3);
  EXPECT_EQ(core_.reg(4), 1u);
}

TEST_F(CoreExceptions, WfiUnderPrimaskWakesWithoutHandler) {
  run_at(CoreRig::code, {0xbf30, 0x2401});
  rig_.poke(iser, 1);
  core_.set_primask(true);
  core_.step();
  EXPECT_TRUE(core_.sleeping());
  raise(1);  // not enabled
  core_.idle_to(core_.cycle() + 10);
  EXPECT_TRUE(core_.sleeping());
  raise(0);
  core_.idle_to(core_.cycle() + 10);
  EXPECT_FALSE(core_.sleeping());
  core_.step();
  EXPECT_EQ(core_.reg(4), 1u);
  EXPECT_EQ(core_.exception(), 0u);
}

TEST_F(CoreExceptions, WfeEndsWithAnEventOfTheOtherCore) {
  run_at(CoreRig::code, {0xbf20, 0xbf40, 0xbf20, 0x2401});
  int events = 0;
  core_.on_event = [&] { ++events; };
  core_.step();
  EXPECT_TRUE(core_.sleeping());
  core_.send_event();
  EXPECT_FALSE(core_.sleeping());
  core_.step();  // sev
  EXPECT_EQ(events, 1);
  core_.step();  // wfe: takes the event, no sleep
  EXPECT_FALSE(core_.sleeping());
  core_.step();
  EXPECT_EQ(core_.reg(4), 1u);
}

TEST_F(CoreExceptions, SevOnPendWakesWfeForADisabledLine) {
  run_at(CoreRig::code, {0xbf20, 0x2401});
  core_.step();
  raise(5);
  core_.idle_to(core_.cycle() + 5);
  EXPECT_TRUE(core_.sleeping());
  raise(5, false);
  rig_.restart();
  rig_.poke(scr, 1u << 4);
  rig_.poke(icpr, 0xffff'ffff);
  core_.set_reg(15, CoreRig::code);
  core_.step();
  EXPECT_TRUE(core_.sleeping());
  raise(5);
  core_.idle_to(core_.cycle() + 5);
  EXPECT_FALSE(core_.sleeping());
}

TEST_F(CoreExceptions, SleepOnExit) {
  rig_.poke(iser, 1);
  rig_.poke(scr, 1u << 1);
  raise(0);
  core_.step();
  leave(0);
  EXPECT_EQ(core_.exception(), 0u);
  EXPECT_TRUE(core_.sleeping());
  raise(0);
  core_.idle_to(core_.cycle() + 5);
  core_.step();
  EXPECT_EQ(core_.exception(), 16u);
}

// --- SysTick, registers, native functions
// --------------------------------------------------------------

// Compares the count that is calculated on demand with a clocked counter.
TEST_F(CoreExceptions, SystickIsACounter) {
  std::uint32_t model = 0;
  const std::uint32_t reload = 6;
  rig_.poke(syst_rvr, reload);
  rig_.poke(syst_cvr, 0);
  rig_.poke(syst_csr, 5);
  Cycle at = core_.cycle() - 2;
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t value = rig_.peek(syst_cvr);
    const Cycle looked = core_.cycle() - 2;
    for (; at < looked; ++at) model = model == 0 ? reload : model - 1;
    EXPECT_EQ(value, model) << i;
    core_.set_reg(15, CoreRig::code);
    steps(i % 5);
  }
}

TEST_F(CoreExceptions, SystemRegisters) {
  EXPECT_EQ(rig_.peek(0xe000'ed00), 0x410c'c601u);
  EXPECT_EQ(rig_.peek(0xe000'ed14), 0x208u);
  EXPECT_EQ(rig_.peek(0xe000'ed90), 0x800u);
  rig_.poke(ipr + 4, 0xffff'ffff);
  EXPECT_EQ(rig_.peek(ipr + 4), 0xc0c0'c0c0u);
  rig_.poke(0xe000'ed08, 0x2000'01ff);
  EXPECT_EQ(rig_.peek(0xe000'ed08), 0x2000'0100u);
  int resets = 0;
  core_.on_reset_request = [&] { ++resets; };
  rig_.poke(aircr, 4);
  EXPECT_EQ(resets, 0);  // no key
  rig_.poke(aircr, 0x05fa'0004);
  EXPECT_EQ(resets, 1);
  EXPECT_TRUE(rig_.reports.empty());
  rig_.poke(0xe000'eda4, 1);
  ASSERT_EQ(rig_.reports.size(), 1u);
  EXPECT_EQ(rig_.reports[0], "PPB register at 0xe000eda4");
}

TEST_F(CoreExceptions, NativeFunctionRunsAndReturnsToLr) {
  std::vector<std::uint32_t> calls;
  int again = 3;
  core_.add_native(0x100, 0x100, [&](Core& c, std::uint32_t address) {
    calls.push_back(address);
    c.set_reg(0, c.reg(0) + 1);
    return Core::Native{10, Core::Then::returns};
  });
  core_.add_native(0x200, 0x2fe, [&](Core&, std::uint32_t address) {
    calls.push_back(address);
    return Core::Native{100, --again == 0 ? Core::Then::returns : Core::Then::again};
  });
  rig_.put(0x180, {0xbf00, 0x4770});                        // ROM code between them
  run_at(CoreRig::code, {0x4788, 0x4790, 0x4798, 0x2401});  // blx r1; blx r2; blx r3
  core_.set_reg(0, 41);
  core_.set_reg(1, 0x101);
  core_.set_reg(2, 0x181);
  core_.set_reg(3, 0x211);
  core_.step();
  EXPECT_EQ(core_.step(), 12u);
  EXPECT_EQ(core_.reg(0), 42u);
  EXPECT_EQ(core_.reg(15), CoreRig::code + 2);
  steps(3);
  EXPECT_EQ(core_.reg(15), CoreRig::code + 4);
  steps(4);
  EXPECT_EQ(core_.reg(15), CoreRig::code + 6);
  EXPECT_EQ(calls, (std::vector<std::uint32_t>{0x100, 0x210, 0x210, 0x210}));
}

TEST_F(CoreExceptions, RunUntilStopsOnRequest) {
  run_at(CoreRig::code, {0xe7fe});
  Alarm alarm(rig_.wheel);
  alarm.at(500, [&] { core_.request_stop(); });
  core_.run_until(10'000);
  EXPECT_LT(core_.cycle(), 510u);
  core_.run_until(10'000);
  EXPECT_GE(core_.cycle(), 10'000u);
}

// A run proceeds from event to event, but it must see the effects of each instruction.
TEST_F(CoreExceptions, ExceptionsThatAnInstructionPendsOrUnmasksPrecedeTheNextInARun) {
  core_.set_reg(0, ispr);
  core_.set_reg(1, 1);
  rig_.poke(iser, 1);
  struct Case {
    const char* what;
    bool masked;
    unsigned code;
    Cycle cycles;
  };
  for (const Case& each : {Case{"str r1, [r0] to ISPR", false, 0x6001, 2},
                           Case{"cpsie i with an interrupt pending", true, 0xb662, 1}}) {
    SCOPED_TRACE(each.what);
    rig_.poke(icpr, 1);
    core_.set_primask(each.masked);
    if (each.masked) rig_.poke(ispr, 1);
    core_.set_reg(2, 0);
    run_at(CoreRig::code, {each.code, 0x2201, 0x2201});  // then movs r2, #1
    core_.run_until(core_.cycle() + each.cycles + 1);
    EXPECT_EQ(core_.exception(), 16u);
    EXPECT_EQ(core_.reg(2), 0u);
    EXPECT_EQ(rig_.word(core_.reg(13) + 24), CoreRig::code + 2);
    steps(2);  // nop, bx lr
    EXPECT_EQ(core_.exception(), 0u);
  }
}

}  // namespace
}  // namespace lamplock::test::core_exceptions_test
