#include "sim/chip/sio/sio.hpp"

#include <gtest/gtest.h>

#include <random>

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

// Divisors of zero and overflow: chip_images/divider.
TEST_F(SioTest, DividesAsThisComputerDoes) {
  std::mt19937_64 random(7);
  for (int n = 0; n < test::scaled(2000); ++n) {
    const auto p = static_cast<std::uint32_t>(random() >> (random() % 32));
    const auto q = static_cast<std::uint32_t>(random() >> (random() % 63)) | 1u;
    const bool is_signed = n % 4 != 0;
    write(0, is_signed ? 0x68 : 0x60, p);
    write(0, is_signed ? 0x6c : 0x64, q);
    rig_.pass(8);
    const std::int64_t wide_p = is_signed ? static_cast<std::int32_t>(p) : std::int64_t{p};
    const std::int64_t wide_q = is_signed ? static_cast<std::int32_t>(q) : std::int64_t{q};
    ASSERT_EQ(read(0, 0x70), static_cast<std::uint32_t>(wide_p / wide_q));
    ASSERT_EQ(read(0, 0x74), static_cast<std::uint32_t>(wide_p % wide_q));
  }
}

constexpr std::uint32_t lane(unsigned shift, unsigned lsb, unsigned msb) {
  return shift | lsb << 5 | msb << 10;
}

// The other properties of the interpolators: chip_images/divider.
TEST_F(SioTest, AddRawDoesNotAffectTheFullResultAndBlendIsOfTheFirstInterpolator) {
  write(0, 0x80, 0x00080000);
  write(0, 0x88, 0x1000);
  write(0, 0xac, lane(8, 4, 11) | 1u << 18);  // ADD_RAW
  EXPECT_EQ(read(0, 0xa0), 0x1000u + 0x00080000u);
  EXPECT_EQ(read(0, 0xa8), 0x800u);
  EXPECT_EQ(read(0, 0xb4), 0x800u);
  EXPECT_EQ(read(1, 0xa0), 0u) << "each core has its own";
  write(0, 0xec, ~0u);
  EXPECT_EQ(read(0, 0xec) & 1u << 21, 0u);
}

}  // namespace
}  // namespace lamplock::sim::chip::sio_test
