#include "sim/chip/system/pwm.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/chip/listeners.hpp"
#include "tests/chip/system_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::pwm_test {
namespace {

using rigs::alternating;

// Pulses, divider, modes of counting, new levels: chip_images/pwm.
class PwmTest : public ::testing::Test {
 protected:
  static std::uint32_t at(unsigned slice, std::uint32_t offset) { return 0x14 * slice + offset; }
  std::uint32_t read(std::uint32_t offset) { return rig_.system.pwm.read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) { rig_.system.pwm.write(offset, value); }
  void connect(unsigned gpio) { rig_.connect(gpio, PinFunction::pwm); }

  rigs::SystemRig rig_;
  rigs::Pads pads_{rig_.gpio};
};

TEST_F(PwmTest, ResetValues) {
  EXPECT_EQ(read(at(3, 0)), 0u);
  EXPECT_EQ(read(at(3, 4)), 0x10u);
  EXPECT_EQ(read(at(7, 0x10)), 0xffffu);
}

TEST_F(PwmTest, ZeroIsNeverAndTopPlusOneAlwaysHigh) {
  connect(0);
  write(at(0, 0x10), 9);
  write(at(0, 0), 1);
  rig_.pass(1000);
  EXPECT_TRUE(pads_.edges[0].empty());
  write(at(0, 0xc), 10);
  rig_.pass(1000);
  EXPECT_EQ(pads_.edges[0].size(), 1u);
  EXPECT_TRUE(pads_.edges[0][0].first);
}

TEST_F(PwmTest, FractionalDividerIsExactOverTime) {
  write(at(0, 4), 2 << 4 | 7);  // 2.4375
  write(at(0, 0), 1);
  rig_.pass(39'000);
  EXPECT_EQ(read(at(0, 8)), 16'000u);
  write(at(1, 4), 0);  // 256
  write(at(1, 0), 1);
  rig_.pass(25'600);
  EXPECT_EQ(read(at(1, 8)), 100u);
}

TEST_F(PwmTest, WrapInterrupt) {
  write(at(4, 0x10), 99);
  write(at(4, 0), 1);
  rig_.pass(250);
  EXPECT_EQ(read(0xa4), 1u << 4) << "latched without an enabled interrupt";
  write(0xa4, 1u << 4);
  write(0xa8, 1u << 4);
  rig_.pass(49);
  EXPECT_FALSE(rig_.line(Irq::pwm_wrap));
  rig_.pass(1);
  EXPECT_TRUE(rig_.line(Irq::pwm_wrap));
  EXPECT_EQ(read(0xb0), 1u << 4);
  write(0xa4, 1u << 4);
  EXPECT_FALSE(rig_.line(Irq::pwm_wrap));
  rig_.pass(100);
  EXPECT_TRUE(rig_.line(Irq::pwm_wrap));
}

TEST_F(PwmTest, EnableRegisterStartsSlicesTogether) {
  write(0xa0, 0x81);
  EXPECT_EQ(read(at(0, 0)), 1u);
  rig_.pass(77);
  EXPECT_EQ(read(at(0, 8)), 77u);
  EXPECT_EQ(read(at(7, 8)), 77u);
  EXPECT_EQ(read(at(1, 8)), 0u);
  write(0xa0, 0);
  rig_.pass(10);
  EXPECT_EQ(read(at(0, 8)), 77u);
}

TEST_F(PwmTest, CountsEdgesOfChannelB) {
  connect(5);  // slice 2, B
  write(at(2, 0), 1 | 2u << 4);
  write(at(3, 0), 1 | 3u << 4);
  connect(23);  // slice 3, B, on its upper pin
  for (int n = 0; n < 10; ++n) {
    for (const unsigned gpio : {5u, 23u}) rig_.drive(gpio, true);
    rig_.pass(5);
    rig_.drive(5, false);
    rig_.pass(5);
  }
  EXPECT_EQ(read(at(2, 8)), 10u);
  EXPECT_EQ(read(at(3, 8)), 0u);
  rig_.drive(23, false);
  EXPECT_EQ(read(at(3, 8)), 1u);
}

TEST_F(PwmTest, PhaseIsAdvancedAndRetarded) {
  write(at(0, 4), 4 << 4);
  write(at(0, 0), 1);
  rig_.pass(40);
  EXPECT_EQ(read(at(0, 8)), 10u);
  write(at(0, 0), 1 | 1u << 7);
  EXPECT_EQ(read(at(0, 8)), 11u);
  EXPECT_EQ(read(at(0, 0)), 1u);
  write(at(0, 0), 1 | 1u << 6);
  rig_.pass(4);
  EXPECT_EQ(read(at(0, 8)), 11u);
  rig_.pass(4);
  EXPECT_EQ(read(at(0, 8)), 12u);
}

TEST_F(PwmTest, ConnectingAPinLateShowsTheRightLevel) {
  write(at(0, 0x10), 99);
  write(at(0, 0xc), 50);
  write(at(0, 0), 1);
  rig_.pass(170);
  connect(0);
  EXPECT_TRUE(pads_.edges[0].empty()) << "count 70";
  rig_.pass(100);
  EXPECT_EQ(pads_.edges[0], alternating(true, {200, 250}));
}

TEST_F(PwmTest, LazyCounterAgreesWithEveryClock) {
  std::mt19937_64 random(11);
  for (int n = 0; n < test::scaled(200); ++n) {
    PwmSlice lazy;
    lazy.write(0x10, static_cast<std::uint32_t>(random() % 40));
    lazy.write(0xc, static_cast<std::uint32_t>(random() % 50) |
                        static_cast<std::uint32_t>(random() % 50) << 16);
    lazy.write(0x4, static_cast<std::uint32_t>(16 + random() % 60));
    lazy.write(0x0, 1 | static_cast<std::uint32_t>(random() % 2) << 1);
    PwmSlice stepped = lazy;
    for (int jump = 0; jump < 20; ++jump) {
      const std::uint64_t clocks = random() % 500;
      const std::uint32_t before = stepped.outputs();
      const Cycle event = stepped.until_event(false);
      for (std::uint64_t clock = 0; clock < clocks; ++clock) {
        stepped.advance(1);
        if (clock + 1 < event) {
          ASSERT_EQ(stepped.outputs(), before) << "the event was not predicted";
        }
      }
      lazy.advance(clocks);
      ASSERT_EQ(lazy.read(8), stepped.read(8));
      ASSERT_EQ(lazy.outputs(), stepped.outputs());
      ASSERT_EQ(lazy.take_wrapped(), stepped.take_wrapped());
    }
  }
}

}  // namespace
}  // namespace lamplock::sim::chip::pwm_test
