// The PIO assembler against encodings worked out by hand from the datasheet (3.4), field by field.
#include "firmware/boards/rp2040/pio/assembler.hpp"

#include <gtest/gtest.h>

#include "firmware/boards/rp2040/pio/programs.hpp"

namespace lamplock::rp2040::pio::assembler_test {
namespace {

// jmp: 000 delay condition address
static_assert(encode::jump(Jump::always, 0) == 0x0000);
static_assert(encode::jump(Jump::x_zero, 1) == 0x0021);
static_assert(encode::jump(Jump::x_nonzero_decrement, 2) == 0x0042);
static_assert(encode::jump(Jump::y_zero, 3) == 0x0063);
static_assert(encode::jump(Jump::y_nonzero_decrement, 4) == 0x0084);
static_assert(encode::jump(Jump::x_not_y, 5) == 0x00a5);
static_assert(encode::jump(Jump::pin, 31) == 0x00df);
static_assert(encode::jump(Jump::osr_not_empty, 7) == 0x00e7);
// wait: 001 delay polarity source index
static_assert(encode::wait(false, WaitFor::gpio, 25) == 0x2019);
static_assert(encode::wait(true, WaitFor::gpio, 25) == 0x2099);
static_assert(encode::wait(true, WaitFor::pin, 0) == 0x20a0);
static_assert(encode::wait(false, WaitFor::irq, 7) == 0x2047);
// in: 010 delay source count
static_assert(encode::in(InFrom::pins, 1) == 0x4001);
static_assert(encode::in(InFrom::x, 32) == 0x4020);
static_assert(encode::in(InFrom::y, 5) == 0x4045);
static_assert(encode::in(InFrom::null, 8) == 0x4068);
static_assert(encode::in(InFrom::isr, 3) == 0x40c3);
static_assert(encode::in(InFrom::osr, 4) == 0x40e4);
// out: 011 delay destination count
static_assert(encode::out(OutTo::pins, 4) == 0x6004);
static_assert(encode::out(OutTo::x, 16) == 0x6030);
static_assert(encode::out(OutTo::y, 16) == 0x6050);
static_assert(encode::out(OutTo::null, 32) == 0x6060);
static_assert(encode::out(OutTo::pindirs, 1) == 0x6081);
static_assert(encode::out(OutTo::pc, 5) == 0x60a5);
static_assert(encode::out(OutTo::isr, 6) == 0x60c6);
static_assert(encode::out(OutTo::exec, 16) == 0x60f0);
// push: 100 delay 0 iffull block 00000, pull: 100 delay 1 ifempty block 00000
static_assert(encode::push(false, false) == 0x8000);
static_assert(encode::push(false, true) == 0x8020);
static_assert(encode::push(true, true) == 0x8060);
static_assert(encode::pull(false, false) == 0x8080);
static_assert(encode::pull(false, true) == 0x80a0);
static_assert(encode::pull(true, false) == 0x80c0);
// mov: 101 delay destination operation source
static_assert(encode::move(MoveTo::pins, MoveFrom::x) == 0xa001);
static_assert(encode::move(MoveTo::x, MoveFrom::isr, Operation::invert) == 0xa02e);
static_assert(encode::move(MoveTo::y, MoveFrom::status) == 0xa045);
static_assert(encode::move(MoveTo::exec, MoveFrom::osr) == 0xa087);
static_assert(encode::move(MoveTo::pc, MoveFrom::y) == 0xa0a2);
static_assert(encode::move(MoveTo::isr, MoveFrom::null, Operation::invert) == 0xa0cb);
static_assert(encode::move(MoveTo::osr, MoveFrom::pins, Operation::reverse) == 0xa0f0);
// irq: 110 delay 0 clear wait index, relative is bit 4
static_assert(encode::irq(false, false, 0) == 0xc000);
static_assert(encode::irq(false, true, 3) == 0xc023);
static_assert(encode::irq(true, false, 7) == 0xc047);
static_assert(encode::irq(false, false, 1, true) == 0xc011);
// set: 111 delay destination data
static_assert(encode::set(SetTo::pins, 1) == 0xe001);
static_assert(encode::set(SetTo::x, 31) == 0xe03f);
static_assert(encode::set(SetTo::y, 0) == 0xe040);
static_assert(encode::set(SetTo::pindirs, 3) == 0xe083);

consteval Program sides() {
  Assembler a(2, true);
  a.wrap_target();
  const Label loop = a.here();
  a.nop().side(2).delay(3);  // 1 10 11: enable, value, delay
  a.nop().delay(1);
  a.jump(loop).side(0);
  a.wrap();
  return a.finish();
}

TEST(Assembler, OptionalSideSetTakesTheUppermostBitAsEnable) {
  constexpr Program p = sides();
  EXPECT_EQ(p.code[0], 0xa042 | 0x1b << 8);
  EXPECT_EQ(p.code[1], 0xa042 | 0x01 << 8);
  EXPECT_EQ(p.code[2], 0x0000 | 0x10 << 8);
  EXPECT_TRUE(p.side_set_optional);
  EXPECT_EQ(p.side_set_bits, 2);
}

consteval Program forward() {
  Assembler a(1);
  const Label end = a.label();
  a.jump(Jump::pin, end).side(1).delay(15);
  a.set(SetTo::x, 3).side(0);
  a.bind(end);
  a.wrap_target();
  a.wait(true, WaitFor::pin, 2).side(0).delay(2);
  return a.finish();
}

TEST(Assembler, LabelsResolveForwardsAndMoveWithTheProgram) {
  constexpr Program p = forward();
  EXPECT_EQ(p.size, 3);
  EXPECT_EQ(p.wrap_target, 2);
  EXPECT_EQ(p.wrap, 2);
  EXPECT_EQ(p.code[0], 0x00c2 | 0x1f << 8);
  EXPECT_EQ(p.at(0, 10), 0x00cc | 0x1f << 8);
  EXPECT_EQ(p.at(1, 10), p.code[1]);
  EXPECT_EQ(p.code[2], 0x20a2 | 0x02 << 8);
}

TEST(Assembler, TheProgramsMatchTheirDescriptions) {
  // wait 1 gpio 25 [1]; out pins,2; wait 0 gpio 25; set pins,0
  const std::array<std::uint16_t, 4> axis{0x2199, 0x6002, 0x2019, 0xe000};
  ASSERT_EQ(axis_program.size, axis.size());
  for (std::size_t i = 0; i < axis.size(); ++i) EXPECT_EQ(axis_program.code[i], axis[i]) << i;
  // wait 1 gpio 25 [1]; out pins,4; wait 0 gpio 25
  const std::array<std::uint16_t, 3> bits{0x2199, 0x6004, 0x2019};
  ASSERT_EQ(bits_program.size, bits.size());
  for (std::size_t i = 0; i < bits.size(); ++i) EXPECT_EQ(bits_program.code[i], bits[i]) << i;
  // The tick line rises at `mov y, isr side 1`; the last jump waits as long as a fetch.
  const Program& tick = tick_program.program;
  EXPECT_EQ(tick.code[tick_program.high - 1u], 0xa046 | 0x10 << 8);
  EXPECT_EQ(tick.code[tick.size - 2u], 0x0040 | tick_program.next | 0x01 << 8);
  // The end is one instruction that wraps to itself: set pins,0 side 0.
  EXPECT_EQ(tick.code[tick.size - 1u], 0xe000);
  EXPECT_EQ(tick_program.starved, tick.size - 1u);
  EXPECT_EQ(tick.wrap_target, tick.size - 1u);
}

}  // namespace
}  // namespace lamplock::rp2040::pio::assembler_test
