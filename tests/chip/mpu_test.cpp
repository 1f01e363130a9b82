// The MPU of a core against the ARMv6-M Architecture Reference Manual, B3.5: permissions of
// regions, which region decides, and accesses that the unit does not check.
#include <gtest/gtest.h>

#include "tests/chip/core_rig.hpp"

namespace lamplock::test::mpu_test {
namespace {

using namespace sim::chip;  // NOLINT(google-build-using-namespace)

constexpr std::uint32_t mpu_ctrl = 0xe000'ed94, mpu_rnr = 0xe000'ed98, mpu_rbar = 0xe000'ed9c,
                        mpu_rasr = 0xe000'eda0;
constexpr std::uint32_t on = 1, in_faults = 2, background = 4, valid = 1u << 4;
constexpr std::uint32_t never_execute = 1u << 28;
constexpr unsigned hard_fault = 3;
constexpr unsigned load_r0 = 0x6803, store_r0 = 0x6003;  // ldr, str r3, [r0]

/// RASR: 2^(bits) bytes.
constexpr std::uint32_t region(unsigned bits, unsigned permissions, std::uint32_t more = 0) {
  return (bits - 1) << 1 | permissions << 24 | more | 1u;
}

class MpuTest : public testing::Test {
 protected:
  MpuTest() {
    rig_.put(code, {load_r0, store_r0});
    rig_.put_word(CoreRig::data, 5);
    permit_the_rig();
  }
  void permit_the_rig() {
    set(7, CoreRig::handlers & ~0xffffu, region(16, 3));  // handlers, vectors, stack: any mode
    set(6, CoreRig::stack - 0x100, region(8, 3));
    set(5, CoreRig::vectors, region(13, 3));
    set(0, code, region(8, 3));
  }
  void set(unsigned number, std::uint32_t base, std::uint32_t attributes) {
    rig_.poke(mpu_rbar, base | valid | number);
    rig_.poke(mpu_rasr, attributes);
  }
  void enable(std::uint32_t control) { rig_.poke(mpu_ctrl, control); }
  /// One instruction at `pc`: true if it does not end in a HardFault.
  bool runs(std::uint32_t pc, bool privileged, std::uint32_t r0 = CoreRig::data) {
    Core& core = rig_.core;
    core.set_control(privileged ? 0 : 1);
    core.set_reg(0, r0);
    core.set_reg(13, CoreRig::stack);
    core.set_reg(15, pc);
    core.step();
    const bool good = core.exception() == 0 && !core.locked_up();
    if (!good) {
      EXPECT_EQ(core.exception(), hard_fault);
      core.step();  // nop
      core.step();  // bx lr
    }
    EXPECT_EQ(core.exception(), 0u);
    return good;
  }
  bool loads(bool privileged, std::uint32_t at = CoreRig::data) {
    return runs(code, privileged, at);
  }
  bool stores(bool privileged, std::uint32_t at = CoreRig::data) {
    return runs(code + 2, privileged, at);
  }

  static constexpr std::uint32_t code = 0x2001'0000;
  CoreRig rig_;
};

TEST_F(MpuTest, RegistersAreThoseOfTheManual) {
  rig_.poke(mpu_rnr, 2);
  rig_.poke(mpu_rbar, 0x2000'01ff & ~valid);
  EXPECT_EQ(rig_.peek(mpu_rbar), 0x2000'0102u) << "without VALID the number of RNR holds";
  rig_.poke(mpu_rbar, 0x2000'0300 | valid | 4);
  EXPECT_EQ(rig_.peek(mpu_rnr), 4u);
  rig_.poke(mpu_rasr, ~0u);
  EXPECT_EQ(rig_.peek(mpu_rasr), 0x1707'ff3fu);
  rig_.poke(mpu_rasr, 0);
  EXPECT_EQ(rig_.peek(0xe000'ed90), 0x800u) << "eight regions";
  EXPECT_TRUE(rig_.reports.empty());
}

// B3.5.8, the table of AP.
TEST_F(MpuTest, PermissionsOfPrivilegedAndUnprivilegedCode) {
  enable(on);
  struct Row {
    unsigned permissions;
    bool load, store, unprivileged_load, unprivileged_store;
  };
  for (const Row& row : {Row{0, false, false, false, false}, Row{1, true, true, false, false},
                         Row{2, true, true, true, false}, Row{3, true, true, true, true},
                         Row{5, true, false, false, false}, Row{6, true, false, true, false},
                         Row{7, true, false, true, false}}) {
    set(1, CoreRig::data, region(8, row.permissions));
    EXPECT_EQ(loads(true), row.load) << row.permissions;
    EXPECT_EQ(stores(true), row.store) << row.permissions;
    EXPECT_EQ(loads(false), row.unprivileged_load) << row.permissions;
    EXPECT_EQ(stores(false), row.unprivileged_store) << row.permissions;
    rig_.core.set_control(0);
  }
}

TEST_F(MpuTest, WithoutARegionOnlyPrivilegedCodeHasTheBackground) {
  EXPECT_TRUE(loads(false)) << "off";
  rig_.core.set_control(0);
  enable(on);
  EXPECT_FALSE(loads(true));
  enable(on | background);
  EXPECT_TRUE(loads(true));
  EXPECT_FALSE(loads(false));
}

TEST_F(MpuTest, TheHighestRegionDecidesAndPartsMayBeDisabled) {
  enable(on);
  set(1, CoreRig::data, region(12, 3));
  set(2, CoreRig::data, region(11, 6, 1u << (8 + 2)));  // parts of 256 bytes, not the third
  EXPECT_FALSE(stores(true, CoreRig::data));
  EXPECT_FALSE(stores(true, CoreRig::data + 0x1fc));
  EXPECT_TRUE(stores(true, CoreRig::data + 0x200));
  EXPECT_TRUE(stores(true, CoreRig::data + 0x2fc));
  EXPECT_FALSE(stores(true, CoreRig::data + 0x300));
  EXPECT_TRUE(stores(true, CoreRig::data + 0x800)) << "the larger region beyond it";
}

TEST_F(MpuTest, FetchesMustBePermittedToo) {
  enable(on | background);
  EXPECT_TRUE(loads(true, code));
  set(0, code, region(8, 3, never_execute));
  EXPECT_FALSE(loads(true, code));
  set(0, code, region(8, 1));
  EXPECT_TRUE(loads(true, code));
  EXPECT_FALSE(loads(false, code));
  rig_.core.set_control(0);
  // A guard after code that runs into it.
  set(0, code, region(8, 3));
  set(1, code + 0x100, region(8, 0));
  rig_.put(code + 0xfe, {0xbf00, 0xbf00});
  EXPECT_TRUE(runs(code + 0xfe, true));
  rig_.core.step();
  EXPECT_EQ(rig_.core.exception(), hard_fault);
}

// B3.5.1: in HardFault the unit is off unless HFNMIENA is set; vectors are always read.
TEST_F(MpuTest, HandlersOfFaultsAreNotChecked) {
  rig_.put(CoreRig::handler_of(hard_fault), {store_r0, 0xbf00});
  set(5, CoreRig::vectors, 0);
  enable(on);
  const auto fault = [&] {
    Core& core = rig_.core;
    core.set_reg(0, CoreRig::data);
    core.set_reg(13, CoreRig::stack);
    core.set_reg(15, code);
    core.step();
    EXPECT_EQ(core.exception(), hard_fault);
    core.step();
    return !core.locked_up();
  };
  EXPECT_TRUE(fault());
  rig_.restart();
  for (const unsigned number : {0u, 6u, 7u})
    set(number,
        number == 0   ? code
        : number == 6 ? CoreRig::stack - 0x100
                      : CoreRig::handlers,
        region(number == 7 ? 16 : 8, 3));
  enable(on | in_faults);
  EXPECT_FALSE(fault());
}

TEST_F(MpuTest, AStackGuardStopsAnOverflow) {
  set(1, CoreRig::data, region(8, 0));
  enable(on | background);
  Core& core = rig_.core;
  rig_.put(code, {0xb5ff});  // push {r0-r7, lr}: 36 bytes
  core.set_reg(13, CoreRig::data + 0x100 + 36);
  core.set_reg(15, code);
  core.step();
  EXPECT_EQ(core.exception(), 0u);
  EXPECT_EQ(core.reg(13), CoreRig::data + 0x100);
  core.set_reg(13, CoreRig::data + 0x100 + 32);
  core.set_reg(15, code);
  core.step();
  EXPECT_TRUE(core.locked_up() || core.exception() == hard_fault);
}

TEST_F(MpuTest, ThePrivatePeripheralsAreNotChecked) {
  enable(on);
  EXPECT_TRUE(loads(true, 0xe000'ed00));
  EXPECT_FALSE(loads(false, 0xe000'ed00)) << "for privileged code only, with or without it";
}

TEST_F(MpuTest, EveryAccessOfARunIsChecked) {
  Core& core = rig_.core;
  constexpr unsigned nop = 0xbf00;
  // str, ldr; stm, ldm r0!, {r1, r2}; push, pop {r1, r2}: the second instruction of a fetched word
  for (const unsigned access : {0x6001u, 0x6801u, 0xc006u, 0xc806u, 0xb406u, 0xbc06u})
    for (const bool permitted : {true, false}) {
      SCOPED_TRACE(testing::Message() << std::hex << access << " permitted " << permitted);
      rig_.restart();
      permit_the_rig();
      set(1, CoreRig::data, region(8, permitted ? 3 : 0));
      enable(on);
      rig_.put(code, {nop, access, nop, nop});
      core.set_reg(0, CoreRig::data);
      core.set_reg(13, CoreRig::data + 0x80);
      core.set_reg(15, code);
      core.run_until(core.cycle() + 10);
      EXPECT_NE(core.locked_up() || core.exception() == hard_fault, permitted);
    }
}

}  // namespace
}  // namespace lamplock::test::mpu_test
