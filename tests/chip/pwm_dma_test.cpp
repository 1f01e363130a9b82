// Wraps of the PWM as requests to the DMA, and counting in the modes of a slice (RP2040 datasheet,
// 4.5.2 and 2.5.3.1).
#include <gtest/gtest.h>

#include <cstring>
#include <utility>
#include <vector>

#include "tests/chip/dma_system_rig.hpp"
#include "tests/chip/listeners.hpp"

namespace lamplock::sim::chip::pwm_dma_test {
namespace {

constexpr std::uint32_t pwm_base = 0x4005'0000;
constexpr std::uint32_t csr = 0x0, div = 0x4, ctr = 0x8, cc = 0xc, top = 0x10, intr = 0xa4;
constexpr std::uint32_t at(unsigned slice, std::uint32_t offset) { return 0x14 * slice + offset; }

class PwmDmaTest : public ::testing::Test {
 protected:
  Pwm& pwm_ = rig_.system.pwm;
  std::uint32_t read(unsigned slice, std::uint32_t offset) { return pwm_.read(at(slice, offset)); }
  void write(unsigned slice, std::uint32_t offset, std::uint32_t value) {
    pwm_.write(at(slice, offset), value);
  }
  void connect(unsigned gpio) { rig_.connect(gpio, PinFunction::pwm); }
  void pulse(unsigned gpio, unsigned times) {
    for (unsigned n = 0; n < 2 * times; ++n) {
      rig_.drive(gpio, n % 2 == 0);
      rig_.pass(3);
    }
  }
  void put(const std::vector<std::uint32_t>& words) {
    std::memcpy(rig_.bus.sram().data(), words.data(), 4 * words.size());
  }
  rigs::DmaSystemRig rig_;
  rigs::Pads pads_{rig_.gpio};
  const rigs::EdgeList& edges_ = pads_.edges[6];
};

// A table of duties, one for each period: a new CC applies from the next wrap.
TEST_F(PwmDmaTest, EachWrapTakesTheNextDuty) {
  put({20, 30, 40, 50});
  connect(6);
  write(3, top, 99);
  write(3, cc, 10);
  rig_.start_dma(2, rig_.ram, pwm_base + at(3, cc), 4, 2, true, false,
                 static_cast<Dreq>(static_cast<unsigned>(Dreq::pwm_wrap0) + 3));
  pads_.clear();
  const Cycle t = rig_.wheel.now();
  write(3, csr, 1);
  rig_.pass(650);
  rigs::EdgeList expected;
  // Period 1 begins with the wrap that fetches 20, which is used from period 2 on.
  const std::vector<Cycle> duties{10, 10, 20, 30, 40, 50, 50};
  for (Cycle n = 0; n < duties.size(); ++n) {
    if (n != 0) expected.emplace_back(true, t + 100 * n);
    if (100 * n + duties[n] <= 650) expected.emplace_back(false, t + 100 * n + duties[n]);
  }
  EXPECT_EQ(edges_, expected);
  EXPECT_FALSE(rig_.dma_busy(2));
}

TEST_F(PwmDmaTest, WrapsBeforeTheChannelAreNotCounted) {
  put({1, 2, 3, 4, 5, 6, 7, 8});
  write(0, top, 99);
  write(0, csr, 1);
  rig_.pass(1050);
  rig_.start_dma(0, rig_.ram, rig_.ram + 0x100, 8, 2, true, true, Dreq::pwm_wrap0);
  rig_.pass(40);
  EXPECT_TRUE(rig_.dma_busy(0));
  rig_.pass(700);
  EXPECT_TRUE(rig_.dma_busy(0));
  rig_.pass(100);
  EXPECT_FALSE(rig_.dma_busy(0));
  EXPECT_GT(rig_.wheel.next(), rig_.wheel.now() + 100'000) << "no event is due afterwards";
}

// 4.5.2.5: the divider divides the counted events: 3.5 edges per count.
TEST_F(PwmDmaTest, EdgesAreDivided) {
  connect(7);  // slice 3, channel B
  write(3, div, 3 << 4 | 8);
  write(3, csr, 1 | 2u << 4);
  pulse(7, 35);
  EXPECT_EQ(read(3, ctr), 10u);
  write(3, csr, 1 | 3u << 4);  // falling
  pulse(7, 7);
  EXPECT_EQ(read(3, ctr), 12u);
}

// Edges wrap at TOP like clocks, raise the interrupt and request the DMA.
TEST_F(PwmDmaTest, EdgesWrap) {
  put({0xabcd});
  connect(7);
  write(3, top, 4);
  write(3, csr, 1 | 2u << 4);
  rig_.start_dma(0, rig_.ram, rig_.ram + 0x100, 1, 2, true, true,
                 static_cast<Dreq>(static_cast<unsigned>(Dreq::pwm_wrap0) + 3));
  pulse(7, 4);
  EXPECT_EQ(read(3, ctr), 4u);
  EXPECT_EQ(pwm_.read(intr), 0u);
  pulse(7, 1);
  EXPECT_EQ(read(3, ctr), 0u);
  EXPECT_EQ(pwm_.read(intr), 1u << 3);
  rig_.pass(20);
  EXPECT_FALSE(rig_.dma_busy(0));
}

// In these modes pin B is an input; A is still an output, high until the CCth edge.
TEST_F(PwmDmaTest, ChannelAComparesTheCountOfEdges) {
  connect(6);
  connect(7);
  write(3, top, 4);
  write(3, cc, 2);
  write(3, csr, 1 | 2u << 4);
  pads_.clear();
  pulse(7, 5);
  ASSERT_EQ(edges_.size(), 2u);
  EXPECT_FALSE(edges_[0].first);
  EXPECT_EQ(edges_[1].second - edges_[0].second, 3u * 6);
  EXPECT_TRUE(rig_.reports.empty()) << "no other source drives pin 7";
}

// 4.5.2.6: period (TOP + 1) x 2 x DIV; one wrap, at the bottom, in each.
TEST_F(PwmDmaTest, PhaseCorrectPeriodAndWrap) {
  write(1, top, 9);
  write(1, div, 2 << 4 | 8);
  write(1, csr, 3);
  const Cycle t = rig_.wheel.now();
  for (Cycle n = 1; n <= 5; ++n) {
    rig_.wheel.advance_to(t + 50 * n - 1);
    EXPECT_EQ(pwm_.read(intr), 0u) << n;
    rig_.wheel.advance_to(t + 50 * n);
    EXPECT_EQ(pwm_.read(intr), 2u) << n;
    pwm_.write(intr, 2);
  }
}

}  // namespace
}  // namespace lamplock::sim::chip::pwm_dma_test
