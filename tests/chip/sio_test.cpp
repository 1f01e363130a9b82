#include "sim/chip/sio/sio.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/chip/system_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::sio_test {
namespace {

class SioTest : public ::testing::Test {
 protected:
  std::uint32_t read(int core, std::uint32_t offset) { return rig_.sio.core(core).read(offset); }
  void write(int core, std::uint32_t offset, std::uint32_t value) {
    rig_.sio.core(core).write(offset, value);
  }
  rigs::SystemRig rig_;
};

TEST_F(SioTest, EachCoreReadsItsNumber) {
  EXPECT_EQ(read(0, 0), 0u);
  EXPECT_EQ(read(1, 0), 1u);
}

TEST_F(SioTest, OutputsAreSetClearedAndToggledByBothCores) {
  rig_.gpio.io_bank().write(8 * 3 + 4, 5);
  rig_.gpio.io_bank().write(8 * 4 + 4, 5);
  write(0, 0x24, 0x18);  // OE_SET
  write(0, 0x14, 0x08);  // OUT_SET
  EXPECT_EQ(rig_.gpio.pad_levels(), 0x08u);
  write(1, 0x1c, 0x18);  // OUT_XOR
  EXPECT_EQ(rig_.gpio.pad_levels(), 0x10u);
  write(1, 0x18, 0x10);  // OUT_CLR
  EXPECT_EQ(rig_.gpio.pad_levels(), 0u);
  write(0, 0x10, 0xffffffff);
  EXPECT_EQ(read(0, 0x10), 0x3fffffffu);
  EXPECT_EQ(rig_.gpio.pad_levels(), 0x18u);
  write(0, 0x28, 0x08);
  EXPECT_EQ(read(1, 0x20), 0x10u);
  EXPECT_EQ(rig_.gpio.pad_levels(), 0x10u);
}

TEST_F(SioTest, InputsArriveTwoCyclesLateUnlessBypassed) {
  rig_.wheel.advance_to(100);
  rig_.gpio.set_external(7, External::high, 100);
  rig_.gpio.set_external(8, External::high, 100);
  rig_.system.syscfg.write(0x0c, 1u << 8);
  EXPECT_EQ(read(0, 4), 1u << 8);
  rig_.wheel.advance_to(101);
  EXPECT_EQ(read(0, 4), 1u << 8);
  rig_.wheel.advance_to(102);
  EXPECT_EQ(read(0, 4), 3u << 7);
  EXPECT_EQ(read(0, 8), 2u);
}

/// A source that lags and drives its pin only when it is updated.
struct Late : InputListener {
  explicit Late(Gpio& pins) : gpio(pins) {}
  void inputs_changed(Cycle) override {}
  void catch_up(Cycle at) override {
    if (at >= 50) gpio.drive(PinFunction::pio0, 1, 1, 50);
  }
  Gpio& gpio;
};

TEST_F(SioTest, APeekAtTheInputsShowsThePresent) {
  rig_.gpio.io_bank().write(4, 6);
  Late late(rig_.gpio);
  rig_.gpio.listen(late);
  rig_.wheel.advance_to(60);
  EXPECT_EQ(rig_.sio.core(0).peek(4), 1u);
}

TEST_F(SioTest, MailboxHoldsEightWordsAndRaisesInterrupts) {
  EXPECT_EQ(read(0, 0x50), 2u);
  for (std::uint32_t word = 0; word < 8; ++word) write(0, 0x54, word);
  EXPECT_EQ(read(0, 0x50), 0u);
  EXPECT_EQ(read(1, 0x50), 3u);
  EXPECT_FALSE(rig_.line(Irq::sio_proc0));
  EXPECT_TRUE(rig_.line(Irq::sio_proc1));
  write(0, 0x54, 99);  // full: lost
  EXPECT_EQ(read(0, 0x50), 4u);
  EXPECT_TRUE(rig_.line(Irq::sio_proc0));
  write(0, 0x50, 0xff);
  EXPECT_FALSE(rig_.line(Irq::sio_proc0));
  for (std::uint32_t word = 0; word < 8; ++word) EXPECT_EQ(read(1, 0x58), word);
  EXPECT_FALSE(rig_.line(Irq::sio_proc1));
  read(1, 0x58);  // empty
  EXPECT_EQ(read(1, 0x50), 0xau);
  EXPECT_TRUE(rig_.line(Irq::sio_proc1));
  write(1, 0x50, 8);
  EXPECT_EQ(read(1, 0x50), 2u);
}

TEST_F(SioTest, SpinLockIsClaimedByOneReader) {
  EXPECT_EQ(read(0, 0x100 + 4 * 31), 1u << 31);
  EXPECT_EQ(read(1, 0x100 + 4 * 31), 0u);
  EXPECT_EQ(read(0, 0x100), 1u);
  EXPECT_EQ(read(1, 0x5c), 1u << 31 | 1u);
  write(1, 0x100 + 4 * 31, 0);
  EXPECT_EQ(read(1, 0x100 + 4 * 31), 1u << 31);
}

TEST_F(SioTest, DividerTakesEightCycles) {
  rig_.wheel.advance_to(50);
  EXPECT_EQ(read(0, 0x78), 1u);
  write(0, 0x60, 100);
  write(0, 0x64, 7);
  rig_.pass(7);
  EXPECT_EQ(read(0, 0x78), 2u);
  rig_.pass(1);
  EXPECT_EQ(read(0, 0x78), 3u);
  EXPECT_EQ(read(0, 0x74), 2u);
  EXPECT_EQ(read(0, 0x78), 3u);
  EXPECT_EQ(read(0, 0x70), 14u);
  EXPECT_EQ(read(0, 0x78), 1u) << "reading the quotient clears DIRTY";
  EXPECT_TRUE(rig_.reports.empty());
  EXPECT_EQ(read(1, 0x70), 0u) << "the other core has its own";
  write(0, 0x64, 3);
  read(0, 0x70);
  EXPECT_EQ(rig_.reports.size(), 1u) << "read too early";
}

TEST_F(SioTest, WritingAResultEndsADivision) {
  write(0, 0x60, 1);
  write(0, 0x70, 5);
  write(0, 0x74, 6);
  EXPECT_EQ(read(0, 0x78), 3u);
  EXPECT_EQ(read(0, 0x74), 6u);
  EXPECT_EQ(read(0, 0x70), 5u);
}

TEST_F(SioTest, DivisionFollowsTheDocumentedRules) {
  struct Case {
    bool is_signed;
    std::uint32_t dividend, divisor, quotient, remainder;
  };
  const std::vector<Case> cases{
      {false, 7, 0, 0xffffffff, 7},
      {true, 7, 0, 0xffffffff, 7},
      {true, 0u - 7, 0, 1, 0u - 7},
      {true, 0x80000000, 0xffffffff, 0x80000000, 0},
      {false, 0x80000000, 0xffffffff, 0, 0x80000000},
      {true, 0u - 7, 2, 0u - 3, 0u - 1},
      {true, 7, 0u - 2, 0u - 3, 1},
  };
  for (const Case& one : cases) {
    write(0, one.is_signed ? 0x68 : 0x60, one.dividend);
    write(0, one.is_signed ? 0x6c : 0x64, one.divisor);
    rig_.pass(8);
    EXPECT_EQ(read(0, 0x74), one.remainder) << one.dividend << "/" << one.divisor;
    EXPECT_EQ(read(0, 0x70), one.quotient) << one.dividend << "/" << one.divisor;
  }
  std::mt19937_64 random(7);
  for (int n = 0; n < test::scaled(2000); ++n) {
    const auto p = static_cast<std::uint32_t>(random() >> (random() % 32));
    const auto q = static_cast<std::uint32_t>(random() >> (random() % 63)) | 1u;
    write(0, 0x68, p);
    write(0, 0x6c, q);
    rig_.pass(8);
    const std::int64_t wide_p = static_cast<std::int32_t>(p);
    const std::int64_t wide_q = static_cast<std::int32_t>(q);
    ASSERT_EQ(read(0, 0x70), static_cast<std::uint32_t>(wide_p / wide_q));
    ASSERT_EQ(read(0, 0x74), static_cast<std::uint32_t>(wide_p % wide_q));
  }
}

constexpr std::uint32_t lane(unsigned shift, unsigned lsb, unsigned msb) {
  return shift | lsb << 5 | msb << 10;
}

TEST_F(SioTest, InterpolatorShiftsMasksAndAdds) {
  write(0, 0x80, 0x12345678);
  write(0, 0x88, 0x1000);
  write(0, 0xac, lane(8, 4, 11));
  EXPECT_EQ(read(0, 0xa0), 0x1000u + (0x123456u & 0xff0u));
  EXPECT_EQ(read(0, 0xb4), 0x123456u & 0xff0u);
  EXPECT_NE(read(0, 0xac) & 1u << 23, 0u) << "bits above the mask are set";
  write(0, 0x80, 0x00080000);
  write(0, 0xac, lane(8, 4, 11) | 1u << 15);
  EXPECT_EQ(read(0, 0xa0), 0x1000u + 0xfffff800u) << "sign extended from bit 11";
  write(0, 0xac, lane(8, 4, 11) | 1u << 18);
  EXPECT_EQ(read(0, 0xa0), 0x1000u + 0x00080000u) << "ADD_RAW";
  EXPECT_EQ(read(0, 0xa8), 0x800u) << "ADD_RAW does not affect the full result";
  write(0, 0xac, lane(0, 0, 31) | 2u << 19);
  write(0, 0x80, 4);
  EXPECT_EQ(read(0, 0xa0), 0x20001004u) << "FORCE_MSB";
  EXPECT_EQ(read(1, 0xa0), 0u);
}

TEST_F(SioTest, InterpolatorPopAccumulates) {
  write(0, 0xac, lane(0, 0, 31));
  write(0, 0xb0, lane(0, 0, 31));
  write(0, 0x88, 3);
  write(0, 0x8c, 5);
  EXPECT_EQ(read(0, 0x94), 3u);
  EXPECT_EQ(read(0, 0x94), 6u);
  EXPECT_EQ(read(0, 0x84), 10u);
  write(0, 0xb4, 100);  // ACCUM0_ADD
  EXPECT_EQ(read(0, 0x80), 106u);
  write(0, 0xac, lane(0, 0, 31) | 1u << 17);  // CROSS_RESULT
  read(0, 0x94);
  EXPECT_EQ(read(0, 0x80), 15u);
  write(0, 0xbc, 0x80007fff);
  EXPECT_EQ(read(0, 0x88), 0x7fffu);
  EXPECT_EQ(read(0, 0x8c), 0x8000u);
}

TEST_F(SioTest, InterpolatorBlendsAndClamps) {
  write(0, 0xac, 1u << 21 | lane(0, 0, 31));  // BLEND
  write(0, 0xb0, lane(0, 0, 31) | 1u << 15);
  write(0, 0x88, 0u - 1000);
  write(0, 0x8c, 1000);
  for (const std::uint32_t alpha : {0u, 64u, 128u, 255u}) {
    write(0, 0x84, alpha);
    EXPECT_EQ(static_cast<std::int32_t>(read(0, 0xa4)),
              -1000 + static_cast<std::int32_t>(2000 * alpha / 256));
    EXPECT_EQ(read(0, 0xa0), alpha);
  }
  write(0, 0xec, 1u << 22 | lane(0, 0, 31) | 1u << 15);  // CLAMP, signed
  write(0, 0xc8, 0u - 5);
  write(0, 0xcc, 5);
  for (const int value : {-100, -5, -1, 0, 5, 100}) {
    write(0, 0xc0, static_cast<std::uint32_t>(value));
    EXPECT_EQ(static_cast<std::int32_t>(read(0, 0xe0)), std::clamp(value, -5, 5));
  }
  write(0, 0xec, ~0u);
  EXPECT_EQ(read(0, 0xec) & 1u << 21, 0u) << "no blend mode in INTERP1";
}

}  // namespace
}  // namespace lamplock::sim::chip::sio_test
