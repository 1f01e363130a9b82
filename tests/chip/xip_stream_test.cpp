// Streaming from the flash (RP2040 datasheet, 2.6.3.3) and the DMA requests of the SSI (4.10.13).
// A word takes 8 clocks of address and mode, 4 of wait and 8 of data, each `divider` cycles.
#include <vector>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/pio_dma_clock.hpp"
#include "tests/chip/xip_rig.hpp"

namespace lamplock::test::xip_stream_test {
namespace {

constexpr std::uint32_t stream_addr = control + 0x14, stream_ctr = control + 0x18,
                        stream_fifo = control + 0x1c, auxiliary = 0x5040'0000;
constexpr std::uint32_t empty = 2, full = 4;
constexpr std::uint32_t word_clocks = 8 + 4 + 8;
constexpr Cycle cooldown = 7;  // 2.6.3.3

class XipStreamTest : public XipTest {
 protected:
  XipStreamTest() { reports_.clear(); }
  std::uint32_t read_at(std::uint32_t address, Cycle at) {
    return bus_.read(address, Width::word, Master::core0, at).value;
  }
  std::uint32_t flags(Cycle at) { return read_at(stat, at) & (empty | full); }
  /// Begins a stream; returns the cycle of its begin.
  Cycle stream(std::uint32_t address, std::uint32_t words) {
    put(stream_addr, address);
    const Cycle begun = at_;
    put(stream_ctr, words);
    return begun;
  }
  std::uint32_t miss(std::uint32_t address, Cycle at, Master master = Master::core0) {
    return bus_.read(address, Width::word, master, at).wait;
  }
};

TEST_F(XipStreamTest, WordsTakeTheirTransferAndWaitForRoom) {
  for (const std::uint32_t divider : {2u, 4u}) {
    set_divider(divider);
    const Cycle word = word_clocks * divider;
    const Cycle t = stream(0x102, 5);
    EXPECT_EQ(flags(t + word - 1), empty);
    EXPECT_EQ(flags(t + word), 0u);
    EXPECT_EQ(read_at(stream_addr, t + word), 0x104u) << "the low bits are zero";
    EXPECT_EQ(read_at(stream_ctr, t + word), 4u);
    EXPECT_EQ(flags(t + 2 * word - 1), 0u);
    EXPECT_EQ(flags(t + 2 * word), full) << "two entries";
    EXPECT_EQ(read_at(stream_ctr, t + 10 * word), 3u);
    // With room again, the next word begins.
    EXPECT_EQ(read_at(stream_fifo, t + 10 * word), flash_word(0x100));
    EXPECT_EQ(flags(t + 11 * word - 1), 0u);
    EXPECT_EQ(flags(t + 11 * word), full);
    Cycle at = t + 20 * word;
    for (std::uint32_t n = 1; n < 5; ++n, at += word)
      EXPECT_EQ(read_at(auxiliary, at), flash_word(0x100 + 4 * n));
    EXPECT_EQ(read_at(stream_ctr, at), 0u);
    EXPECT_EQ(flags(at), empty);
    at_ = at + 10;
  }
  EXPECT_TRUE(reports_.empty());
}

TEST_F(XipStreamTest, AMissGoesFirstAndAWordWaitsForTheCooldown) {
  constexpr Cycle word = 2 * word_clocks, line = 2 * line_clocks;
  wait(cached + 0x100);
  at_ += 1000;
  const Cycle t = stream(0x4000, 100);
  EXPECT_EQ(miss(cached + 0x100, t + 5), 0u) << "a hit never waits";
  EXPECT_EQ(miss(cached + 0x200, t + 10), word - 10 + line) << "waits for the word in progress";
  const Cycle resumed = t + word + line + cooldown;
  EXPECT_EQ(flags(resumed + word - 1), 0u);
  EXPECT_EQ(flags(resumed + word), full);
}

TEST_F(XipStreamTest, AMissInTheSameCycleBeginsFirst) {
  constexpr Cycle word = 2 * word_clocks, line = 2 * line_clocks;
  const Cycle t = stream(0x4000, 100);
  EXPECT_EQ(miss(cached + 0x200, t), line);
  EXPECT_EQ(flags(t + line + cooldown + word - 1), empty);
  EXPECT_EQ(flags(t + line + cooldown + word), 0u);
}

TEST_F(XipStreamTest, AMissJustBeforeDelaysTheFirstWord) {
  constexpr Cycle word = 2 * word_clocks, line = 2 * line_clocks;
  put(stream_addr, 0x4000);
  const Cycle begun = at_;
  EXPECT_EQ(miss(cached + 0x300, begun), line);
  at_ = begun + line + 1;
  put(stream_ctr, 1);
  EXPECT_EQ(flags(begun + line + cooldown + word - 1), empty);
  EXPECT_EQ(flags(begun + line + cooldown + word), 0u);
}

// STREAM_CTR: 0 halts and discards what is in flight; the FIFO is for software to drain.
TEST_F(XipStreamTest, ZeroHaltsAndDiscards) {
  constexpr Cycle word = 2 * word_clocks;
  const Cycle t = stream(0x4000, 100);
  at_ = t + word + 10;
  put(stream_ctr, 0);
  EXPECT_EQ(flags(t + 10 * word), 0u) << "the first word";
  EXPECT_EQ(read_at(stream_addr, t + 10 * word), 0x4004u);
  EXPECT_EQ(read_at(stream_fifo, t + 10 * word), flash_word(0x4000));
  EXPECT_TRUE(reports_.empty());
  EXPECT_EQ(read_at(stream_fifo, t + 10 * word), 0u);
  EXPECT_EQ(reports_.count("XIP stream FIFO read while empty"), 1u);
}

TEST_F(XipStreamTest, WaitsWhileTheFlashCannotBeRead) {
  const Cycle t = stream(0x4000, 100);
  at_ = t + 10;
  put(ssi + 8, 0);
  EXPECT_EQ(reports_.count("XIP stream while no flash is mapped"), 1u);
  EXPECT_EQ(flags(t + 1000), empty);
  at_ = t + 1000;
  put(ssi + 8, 1);
  EXPECT_EQ(flags(t + 1000 + 2 * word_clocks), 0u);
  EXPECT_EQ(read_at(stream_fifo, t + 2000), flash_word(0x4000));
}

/// Streaming with a DMA.
class XipDmaTest : public XipStreamTest {
 protected:
  static constexpr std::uint32_t dma = 0x5000'0000, ram = 0x2000'0000;
  XipDmaTest() {
    bus_.map(dma, fabric_.dma());
    xip_.connect(fabric_.dreqs());
  }
  void start(std::uint32_t from, std::uint32_t to, std::uint32_t count, unsigned size, bool up_from,
             bool up_to, Dreq dreq, bool swap = false) {
    put(dma + 0x0, from);
    put(dma + 0x4, to);
    put(dma + 0x8, count);
    put(dma + 0xc, 1u | size << 2 | (up_from ? 1u << 4 : 0) | (up_to ? 1u << 5 : 0) |
                       static_cast<unsigned>(dreq) << 15 | (swap ? 1u << 22 : 0));
  }
  bool busy(Cycle at) { return (read_at(dma + 0xc, at) >> 24 & 1u) != 0; }
  std::uint32_t ram_word(std::uint32_t index) {
    std::uint32_t word = 0;
    std::memcpy(&word, bus_.sram().data() + 4 * index, sizeof word);
    return word;
  }

  IrqLines irqs_;
  Gpio gpio_{wheel_, irqs_, note_};
  PioDmaClock fabric_{wheel_, bus_, gpio_, irqs_, timing_, note_};
};

TEST_F(XipDmaTest, TheDmaTransfersEachWordAtOnce) {
  constexpr std::uint32_t words = 64;
  constexpr Cycle word = 2 * word_clocks;
  start(auxiliary, ram, words, 2, false, true, Dreq::xip_stream);
  const Cycle t = stream(0x8000, words);
  // From the last word: a credit in the next clock, Timing::dma_start, the read, the write.
  EXPECT_TRUE(busy(t + words * word));
  EXPECT_FALSE(busy(t + words * word + 8));
  for (std::uint32_t n = 0; n < words; ++n) EXPECT_EQ(ram_word(n), flash_word(0x8000 + 4 * n)) << n;
  EXPECT_TRUE(reports_.empty());
}

// 2.6.3.3: through the auxiliary slave the DMA avoids stalls of other masters at the flash's port.
TEST_F(XipDmaTest, TheAuxiliarySlaveDoesNotWaitForAMiss) {
  constexpr Cycle line = 2 * line_clocks;
  const Cycle t = stream(0x8000, 2) + 1000;
  EXPECT_EQ(miss(cached + 0x200, t), line);
  EXPECT_EQ(bus_.read(auxiliary, Width::word, Master::dma, t + 10).wait, 0u);
  EXPECT_EQ(bus_.read(stream_fifo, Width::word, Master::dma, t + 10).wait, line + 1 - 10);
}

// As users of the SDK read a block: the SSI sends the number of CTRLR1, the DMA empties its FIFO.
TEST_F(XipDmaTest, TheDmaEmptiesTheSsi) {
  constexpr std::uint32_t words = 64;
  constexpr Cycle frame = 2 * 8;
  put(ssi + 0x08, 0);
  put(ssi + 0x04, words - 1);
  put(ssi + 0x4c, 3);  // DMACR: both
  put(ssi + 0x08, 1);
  EXPECT_EQ(get(ssi + 0x4c), 3u);
  start(ssi + 0x60, ram, words, 2, false, true, Dreq::xip_ssirx, true);
  const Cycle t = at_;
  put(ssi + 0x60, 0x8000u << 8 | 0xa0u);
  const Cycle end = t + 2 * (8 + 4) + words * frame;
  EXPECT_TRUE(busy(end));
  // As above, and the wait states of APB.
  EXPECT_FALSE(busy(end + 12));
  for (std::uint32_t n = 0; n < words; ++n) EXPECT_EQ(ram_word(n), flash_word(0x8000 + 4 * n)) << n;
  EXPECT_EQ(read_at(ssi + 0x34, end + 20) & 0xeu, 0u) << "no overflow, no underflow";
}

TEST_F(XipDmaTest, AThresholdHoldsTheRequestBack) {
  put(ssi + 0x08, 0);
  put(ssi + 0x04, 7);
  put(ssi + 0x4c, 1);
  put(ssi + 0x54, 3);  // DMARDLR: from four entries on
  put(ssi + 0x08, 1);
  start(ssi + 0x60, ram, 8, 2, false, true, Dreq::xip_ssirx, true);
  const Cycle t = at_;
  put(ssi + 0x60, 0x8000u << 8 | 0xa0u);
  const Cycle fourth = t + 2 * (8 + 4) + 4 * 16;
  EXPECT_EQ(read_at(ssi + 0x24, fourth - 1), 3u);
  EXPECT_EQ(read_at(dma + 0x08, fourth - 1), 8u);
  EXPECT_LT(read_at(dma + 0x08, fourth + 12), 8u);
}

TEST_F(XipDmaTest, TheDmaFillsTheSsi) {
  constexpr std::uint32_t bytes = 40;
  put(ssi + 0x08, 0);
  put(ssi, 7u << 16 | 1u << 8);  // one line, eight bits, transmit only
  put(ssi + 0x4c, 2);
  put(ssi + 0x50, 4);  // DMATDLR
  put(ssi + 0x08, 1);
  const Cycle t = at_;
  start(ram, ssi + 0x60, bytes, 0, true, false, Dreq::xip_ssitx);
  const Cycle end = t + bytes * 8 * 2;
  EXPECT_EQ(read_at(ssi + 0x28, end - 20) & 1u, 1u) << "busy";
  EXPECT_FALSE(busy(end));
  EXPECT_EQ(read_at(ssi + 0x28, end + 100) & 5u, 4u) << "all sent";
  EXPECT_EQ(read_at(ssi + 0x34, end + 100) & 2u, 0u) << "no overflow";
}

}  // namespace
}  // namespace lamplock::test::xip_stream_test
