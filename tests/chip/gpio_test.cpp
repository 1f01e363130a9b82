#include "sim/chip/gpio/gpio.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "sim/chip/sio/sio.hpp"

namespace lamplock::sim::chip::gpio_test {
namespace {

struct Watcher : PadListener {
  void pad_changed(unsigned gpio, bool level, Cycle at) override {
    changes.emplace_back(gpio, level, at);
  }
  std::vector<std::tuple<unsigned, bool, Cycle>> changes;
};

class GpioTest : public ::testing::Test {
 protected:
  static std::uint32_t control(unsigned gpio) { return 8 * gpio + 4; }
  std::uint32_t status(unsigned gpio) { return gpio_.io_bank().read(8 * gpio); }
  void io(std::uint32_t offset, std::uint32_t value) { gpio_.io_bank().write(offset, value); }
  void pad(unsigned gpio, std::uint32_t value) { gpio_.pads_bank().write(4 + 4 * gpio, value); }
  bool line(int core) const {
    return (irqs_.levels(core) >> static_cast<unsigned>(Irq::io_bank0) & 1u) != 0;
  }
  bool level(unsigned gpio) const { return (gpio_.pad_levels() >> gpio & 1u) != 0; }
  bool input(unsigned gpio) const { return (gpio_.inputs() >> gpio & 1u) != 0; }

  std::vector<std::string> reports_;
  TimeWheel wheel_;
  IrqLines irqs_;
  Gpio gpio_{wheel_, irqs_, [this](const std::string& what) { reports_.push_back(what); }};
};

TEST_F(GpioTest, AfterResetPinsArePulledDownAndNothingIsDriven) {
  EXPECT_EQ(gpio_.pad_levels(), 0u);
  EXPECT_EQ(gpio_.io_bank().peek(control(7)), 0x1fu);
  EXPECT_EQ(gpio_.pads_bank().peek(4), 0x56u);
  EXPECT_EQ(gpio_.pads_bank().peek(0x7c), 0xdau);
  EXPECT_EQ(gpio_.pads_bank().peek(0x80), 0x5au);
  gpio_.drive(PinFunction::sio, ~0u, ~0u, 5);
  EXPECT_EQ(gpio_.pad_levels(), 0u);
}

TEST_F(GpioTest, OnlyTheSelectedFunctionDrivesThePin) {
  Watcher watcher;
  gpio_.listen(watcher);
  io(control(3), 6);
  gpio_.drive(PinFunction::pio1, 1u << 3, 1u << 3, 10);
  EXPECT_TRUE(watcher.changes.empty());
  gpio_.drive(PinFunction::pio0, 1u << 3, 1u << 3, 20);
  gpio_.drive(PinFunction::pio0, 1u << 3 | 1u << 4, 1u << 3, 30);
  gpio_.drive(PinFunction::pio0, 0, 1u << 3, 40);
  using Change = std::tuple<unsigned, bool, Cycle>;
  EXPECT_EQ(watcher.changes, (std::vector<Change>{{3, true, 20}, {3, false, 40}}));
}

// The other overrides: chip_images/gpio.
TEST_F(GpioTest, OverridesForceAPinWithoutAFunction) {
  io(control(2), 31 | 3u << 8 | 3u << 12);  // high and enabled
  EXPECT_TRUE(level(2));
  io(control(2), 31 | 1u << 16);  // input inverted
  EXPECT_FALSE(level(2));
  EXPECT_TRUE(input(2));
  io(control(2), 31 | 2u << 16);
  EXPECT_FALSE(input(2));
}

TEST_F(GpioTest, StatusShowsEveryStage) {
  io(control(9), 5 | 1u << 8 | 1u << 12 | 1u << 16 | 1u << 28);
  gpio_.drive(PinFunction::sio, 1u << 9, 0, 0);
  // Output 1 -> 0, enable 0 -> 1, so the pad is low; input and interrupt input are inverted.
  EXPECT_EQ(status(9), 1u << 8 | 1u << 13 | 1u << 19 | 1u << 26);
  gpio_.drive(PinFunction::sio, 0, 0, 0);
  EXPECT_EQ(status(9), 1u << 9 | 1u << 13 | 1u << 17 | 1u << 24);
}

TEST_F(GpioTest, BothPullsKeepTheLevel) {
  pad(5, 0x4c);
  gpio_.set_external(5, External::high, 10);
  gpio_.set_external(5, External::floating, 20);
  EXPECT_TRUE(level(5));
  gpio_.set_external(5, External::low, 30);
  gpio_.set_external(5, External::floating, 40);
  EXPECT_FALSE(level(5));
  pad(5, 0x44);
  EXPECT_FALSE(level(5));
}

TEST_F(GpioTest, DrivingAgainstTheOutsideIsReportedOnce) {
  io(control(6), 5);
  gpio_.set_external(6, External::high, 0);
  gpio_.drive(PinFunction::sio, 0, 1u << 6, 0);
  gpio_.drive(PinFunction::sio, 1u << 6, 1u << 6, 1);
  gpio_.drive(PinFunction::sio, 0, 1u << 6, 2);
  EXPECT_EQ(reports_.size(), 1u);
  EXPECT_FALSE(level(6));
}

// An open-drain bus: if one pin pulls low, all are low; otherwise one pull-up raises all.
TEST_F(GpioTest, JoinedPinsHaveOneLevel) {
  for (const unsigned gpio : {2u, 3u}) io(control(gpio), 5);
  pad(2, 0x5a);  // pull-up; the others have none
  pad(3, 0x52);
  pad(9, 0x52);
  gpio_.join(2, 3, 0);
  gpio_.join(9, 3, 0);
  EXPECT_TRUE(level(2) && level(3) && level(9));
  EXPECT_EQ(gpio_.driven() & 0x20cu, 0u);
  gpio_.drive(PinFunction::sio, 0, 1u << 3, 10);
  EXPECT_FALSE(level(2) || level(3) || level(9));
  EXPECT_EQ(gpio_.driven() & 0x20cu, 0x20cu);
  gpio_.drive(PinFunction::sio, 0, 1u << 2 | 1u << 3, 11);
  gpio_.drive(PinFunction::sio, 0, 1u << 2, 12);
  EXPECT_FALSE(level(3)) << "the other one still pulls";
  gpio_.drive(PinFunction::sio, 0, 0, 13);
  EXPECT_TRUE(level(2) && level(3) && level(9));
  gpio_.set_external(9, External::low, 14);
  EXPECT_FALSE(input(2) || input(3));
  EXPECT_TRUE(reports_.empty());
  gpio_.drive(PinFunction::sio, 1u << 2, 1u << 2, 15);
  EXPECT_FALSE(level(2)) << "a low wins";
  EXPECT_EQ(reports_.size(), 2u) << "one of each end";
}

TEST_F(GpioTest, EdgeInterruptComesThroughTheSynchroniserToItsCoreOnly) {
  io(0x100 + 4, 8u << (4 * 4));  // PROC0_INTE1: GPIO12 edge high
  wheel_.advance_to(100);
  gpio_.set_external(12, External::high, 100);
  wheel_.advance_to(101);
  EXPECT_FALSE(line(0));
  wheel_.advance_to(102);
  EXPECT_TRUE(line(0));
  EXPECT_FALSE(line(1));
  gpio_.set_external(12, External::low, 102);
  wheel_.advance_to(110);
  EXPECT_TRUE(line(0)) << "an edge is latched";
  EXPECT_EQ(gpio_.io_bank().read(0xf0 + 4) >> 16 & 15u, 0xdu);  // low, both edges
  EXPECT_EQ(gpio_.io_bank().read(0x120 + 4), 8u << 16);
  io(0xf0 + 4, 8u << 16);
  EXPECT_FALSE(line(0));
  EXPECT_EQ(gpio_.io_bank().read(0xf0 + 4) >> 16 & 15u, 0x5u);
}

TEST_F(GpioTest, EdgesOfPinsWithoutAnInterruptAreLatchedToo) {
  gpio_.set_external(0, External::high, 10);
  gpio_.set_external(0, External::low, 11);
  wheel_.advance_to(12);
  EXPECT_EQ(gpio_.io_bank().read(0xf0) & 15u, 0xau) << "rise seen, fall still in the synchroniser";
  wheel_.advance_to(13);
  EXPECT_EQ(gpio_.io_bank().read(0xf0) & 15u, 0xdu);
  io(0x130, 4);  // PROC1_INTE0: GPIO0 edge low
  EXPECT_TRUE(line(1));
}

TEST_F(GpioTest, OnlyTheEdgesOfInterruptRegistersAreClearedByOnes) {
  EXPECT_EQ(gpio_.io_bank().write_clear_bits(0x0f0), 0xcccc'ccccu);
  EXPECT_EQ(gpio_.io_bank().write_clear_bits(0x0fc), 0xcccc'ccccu);
  EXPECT_EQ(gpio_.io_bank().write_clear_bits(0x100), 0u);
  EXPECT_EQ(gpio_.io_bank().write_clear_bits(control(29)), 0u);
}

TEST_F(GpioTest, LevelInterruptFollowsThePinAndForceNeedsNoEnable) {
  io(0x100, 2);  // GPIO0 level high
  gpio_.set_external(0, External::high, 10);
  wheel_.advance_to(12);
  EXPECT_TRUE(line(0));
  gpio_.set_external(0, External::low, 20);
  wheel_.advance_to(22);
  EXPECT_FALSE(line(0));
  io(0x110 + 12, 1u << 20);  // PROC0_INTF3: GPIO29
  EXPECT_TRUE(line(0));
  EXPECT_EQ(gpio_.io_bank().read(0x120 + 12), 1u << 20);
}

TEST_F(GpioTest, PastInputsAreStoredForSynchronisers) {
  gpio_.set_external(0, External::high, 10);
  gpio_.set_external(1, External::high, 11);
  gpio_.set_external(0, External::low, 12);
  EXPECT_EQ(gpio_.inputs_at(9), 0u);
  EXPECT_EQ(gpio_.inputs_at(10), 1u);
  EXPECT_EQ(gpio_.inputs_at(11), 3u);
  EXPECT_EQ(gpio_.inputs_at(12), 2u);
  EXPECT_EQ(gpio_.inputs_at(50), 2u);
}

/// A source that lags and drives its pin only when it is updated.
struct Late : InputListener {
  explicit Late(Gpio& pins) : gpio(pins) {}
  void inputs_changed(Cycle) override {}
  void catch_up(Cycle at) override {
    if (at >= due) gpio.drive(PinFunction::pio0, 1, 1, due);
  }
  Gpio& gpio;
  Cycle due = 50;
};

TEST_F(GpioTest, SourcesAreUpdatedBeforeTheirPinsAreReconnected) {
  io(control(0), 6);
  gpio_.drive(PinFunction::pio0, 0, 1, 0);
  Late late(gpio_);
  gpio_.listen(late);
  Watcher watcher;
  gpio_.listen(watcher);
  wheel_.advance_to(60);
  io(control(0), 6 | 2u << 8);  // low from cycle 60 on
  ASSERT_EQ(watcher.changes.size(), 2u);
  EXPECT_EQ(watcher.changes[0], std::make_tuple(0u, true, Cycle{50}));
  EXPECT_EQ(watcher.changes[1], std::make_tuple(0u, false, Cycle{60}));
}

TEST_F(GpioTest, APeekAtARegisterShowsThePresent) {
  Sio sio{wheel_, gpio_, irqs_, [] { return 2u; }, {}};
  io(control(0), 6);
  gpio_.drive(PinFunction::pio0, 0, 1, 0);
  Late late(gpio_);
  gpio_.listen(late);
  wheel_.advance_to(60);
  EXPECT_NE(gpio_.io_bank().peek(0) & 1u << 9, 0u) << "OUTTOPAD";
  EXPECT_NE(gpio_.io_bank().peek(0xf0) & 8u, 0u) << "EDGE_HIGH";
  EXPECT_EQ(sio.core(0).peek(4), 1u) << "GPIO_IN";
}

TEST_F(GpioTest, ResetOfTheBankDisconnectsEverything) {
  io(control(0), 5);
  gpio_.drive(PinFunction::sio, 1, 1, 0);
  io(0x100, 8);
  EXPECT_TRUE(level(0));
  gpio_.io_bank().reset();
  EXPECT_FALSE(level(0));
  EXPECT_EQ(gpio_.io_bank().peek(0x100), 0u);
  EXPECT_EQ(gpio_.io_bank().peek(0xf0) & 0xcu, 0u);
  EXPECT_EQ(gpio_.selected(PinFunction::sio), 0u);
}

}  // namespace
}  // namespace lamplock::sim::chip::gpio_test
