// I2C on its pins (RP2040 datasheet, 4.3.4, 4.3.14 and 2.19.2).
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "sim/chip/serial/i2c.hpp"
#include "tests/chip/dma_system_rig.hpp"

namespace lamplock::sim::chip::i2c_pins_test {
namespace {

constexpr std::uint32_t con = 0x00, tar = 0x04, data_cmd = 0x10, fs_hcnt = 0x1c, fs_lcnt = 0x20,
                        intr_mask = 0x30, raw_intr = 0x34, enable = 0x6c, status = 0x70,
                        rxflr = 0x78, sda_hold = 0x7c, abort_source = 0x80, spklen = 0xa0;
constexpr std::uint32_t do_read = 1u << 8, do_stop = 1u << 9, do_restart = 1u << 10;
constexpr unsigned sda = 4, scl = 5;

/// A device that uses only the two wires.
class PinDevice : public PadListener {
 public:
  explicit PinDevice(Gpio& gpio) : gpio_(gpio) { gpio_.listen(*this); }
  void pad_changed(unsigned pin, bool level, Cycle at) override {
    if (pin == scl) {
      edges.emplace_back(level, at);
      level ? clock_up() : clock_down(at);
    }
    if (pin == sda && (gpio_.pad_levels() >> scl & 1u) != 0 && !pulls_) {
      level ? stop() : start();
    }
  }
  void release_clock(Cycle at) { gpio_.set_external(scl, External::floating, at); }

  std::uint8_t address = 0x42, answer = 0xa7;
  bool acknowledges = true;
  bool stretches = false;  ///< after each byte, until release_clock()
  std::vector<int> seen;   ///< bytes, address included; -1 START, -2 STOP, -3 not acknowledged
  std::vector<std::pair<bool, Cycle>> edges;

 private:
  void start() {
    seen.push_back(-1);
    active_ = true;
    sends_ = false;
    count_ = -1;  // the clock falls first
    byte_ = 0;
  }
  void stop() {
    seen.push_back(-2);
    active_ = false;
  }
  void clock_up() {
    if (!active_ || count_ < 0) return;
    const bool level = (gpio_.pad_levels() >> sda & 1u) != 0;
    if (count_ < 8) byte_ = static_cast<std::uint8_t>(byte_ << 1 | (level ? 1 : 0));
    if (count_ == 8 && sends_ && level) {
      seen.push_back(-3);
      active_ = false;
    }
  }
  void clock_down(Cycle at) {
    pull(false, at);
    if (!active_) return;
    if (++count_ == 9) {
      count_ = 0;
      if (first_ && (byte_ & 1u) != 0) sends_ = true;
      first_ = false;
      byte_ = 0;
    }
    if (seen.back() == -1 && count_ == 0) first_ = true;
    if (count_ == 8 && !sends_) {
      seen.push_back(byte_);
      const bool mine = !first_ || byte_ >> 1 == address;
      pull(mine && acknowledges, at);
      if (stretches) gpio_.set_external(scl, External::low, at);
      if (!mine) active_ = false;
    }
    if (sends_ && count_ < 8) pull((answer >> (7 - count_) & 1) == 0, at);
  }
  void pull(bool low, Cycle at) {
    pulls_ = low;
    gpio_.set_external(sda, low ? External::low : External::floating, at);
  }

  Gpio& gpio_;
  bool active_ = false, sends_ = false, first_ = false, pulls_ = false;
  int count_ = 0;
  std::uint8_t byte_ = 0;
};

class I2cPinsTest : public ::testing::Test {
 protected:
  I2cPinsTest() {
    for (const unsigned gpio : {sda, scl}) {
      rig_.gpio.pads_bank().write(4 + 4 * gpio, 0x5a);  // pull-up
      rig_.gpio.io_bank().write(8 * gpio + 4, 3);
    }
    i2c_.write(enable, 0);
    i2c_.write(con, 0x65);
    i2c_.write(tar, 0x42);
    i2c_.write(fs_hcnt, 86);
    i2c_.write(fs_lcnt, 149);
    i2c_.write(spklen, 7);
    i2c_.write(sda_hold, 40);
    i2c_.write(intr_mask, 0);
    i2c_.write(enable, 1);
    device_.edges.clear();
  }
  bool pad(unsigned gpio) const { return (rig_.gpio.pad_levels() >> gpio & 1u) != 0; }

  static constexpr Cycle high = 86 + 7 + 7, low = 149 + 1, bit = high + low;  // 4.3.14.1
  rigs::DmaSystemRig rig_;
  I2c& i2c_ = rig_.system.i2c0;
  PinDevice device_{rig_.gpio};
};

TEST_F(I2cPinsTest, WriteAndItsWaveform) {
  const Cycle t = rig_.wheel.now();
  i2c_.write(data_cmd, 0x35 | do_stop);
  EXPECT_FALSE(pad(sda)) << "START: SDA falls while SCL is high";
  EXPECT_TRUE(pad(scl));
  rig_.pass(30 * bit);
  EXPECT_EQ(device_.seen, (std::vector<int>{-1, 0x84, 0x35, -2}));
  // SCL falls after the hold of START, has eighteen clocks, and rises for the STOP.
  ASSERT_EQ(device_.edges.size(), 2u * 19);
  for (Cycle n = 0; n < 19; ++n) {
    EXPECT_EQ(device_.edges[2 * n], std::make_pair(false, t + high + n * bit));
    EXPECT_EQ(device_.edges[2 * n + 1], std::make_pair(true, t + high + n * bit + low));
  }
  EXPECT_EQ(i2c_.read(abort_source), 0u);
  EXPECT_TRUE(pad(sda) && pad(scl));
}

// The last byte before the STOP is not acknowledged.
TEST_F(I2cPinsTest, ReadsWithRestart) {
  i2c_.write(data_cmd, 0x10);
  i2c_.write(data_cmd, do_read | do_restart);
  i2c_.write(data_cmd, do_read | do_stop);
  rig_.pass(60 * bit);
  EXPECT_EQ(device_.seen, (std::vector<int>{-1, 0x84, 0x10, -1, 0x85, -3, -2}));
  ASSERT_EQ(i2c_.read(rxflr), 2u);
  EXPECT_EQ(i2c_.read(data_cmd) & 0xffu, 0xa7u);
  EXPECT_EQ(i2c_.read(data_cmd) & 0xffu, 0xa7u);
}

// 4.3.9: the master waits while SCL is low; the high time begins when it is released.
TEST_F(I2cPinsTest, ClockIsStretched) {
  device_.stretches = true;
  const Cycle t = rig_.wheel.now();
  i2c_.write(data_cmd, 0x35 | do_stop);
  rig_.wheel.advance_to(t + high + 8 * bit + low + 1000);
  EXPECT_FALSE(pad(scl));
  EXPECT_EQ(device_.edges.size(), 17u);
  device_.stretches = false;
  const Cycle released = rig_.wheel.now();
  device_.release_clock(released);
  EXPECT_TRUE(pad(scl));
  rig_.pass(high - 1);
  EXPECT_TRUE(pad(scl));
  rig_.pass(1);
  EXPECT_FALSE(pad(scl));
  rig_.pass(30 * bit);
  EXPECT_EQ(device_.seen, (std::vector<int>{-1, 0x84, 0x35, -2}));
  EXPECT_EQ(i2c_.read(abort_source), 0u);
}

TEST_F(I2cPinsTest, WaitsUntilTheBusIsFree) {
  rig_.gpio.set_external(scl, External::low, rig_.wheel.now());
  i2c_.write(data_cmd, 0x35 | do_stop);
  rig_.pass(30 * bit);
  EXPECT_TRUE(device_.seen.empty());
  rig_.gpio.set_external(scl, External::floating, rig_.wheel.now());
  rig_.pass(30 * bit);
  EXPECT_EQ(device_.seen, (std::vector<int>{-1, 0x84, 0x35, -2}));
}

// IC_SDA_HOLD: SDA changes this number of cycles after SCL falls.
TEST_F(I2cPinsTest, DataHoldTime) {
  const Cycle t = rig_.wheel.now();
  i2c_.write(data_cmd, 0x35 | do_stop);  // address 0x42: the first bit is 1
  rig_.wheel.advance_to(t + high + 39);
  EXPECT_FALSE(pad(sda));
  rig_.pass(1);
  EXPECT_TRUE(pad(sda));
}

TEST_F(I2cPinsTest, NothingIsDueOnAFreeBus) {
  i2c_.write(data_cmd, 0x35 | do_stop);
  rig_.pass(100 * bit);
  EXPECT_EQ(i2c_.read(status) & 1u, 0u);
  EXPECT_NE(i2c_.read(raw_intr) & 512u, 0u) << "STOP_DET";
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 1'000'000'000);
}

}  // namespace
}  // namespace lamplock::sim::chip::i2c_pins_test
