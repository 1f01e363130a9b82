// The DMA by the rules of the RP2040 datasheet, 2.5.
#include <cstring>
#include <random>

#include "tests/chip/pio_rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::test::pio::dma_test {
namespace {

inline constexpr std::uint32_t intr_dma = 0x400, inte0 = 0x404, intf0 = 0x408, ints0 = 0x40c,
                               timer0 = 0x420, multi = 0x430, sniff_ctrl = 0x434,
                               sniff_data = 0x438, levels = 0x440, chan_abort = 0x444,
                               n_channels = 0x448;
constexpr std::uint32_t ch(unsigned channel, std::uint32_t reg) { return 0x40 * channel + reg; }

/// CTRL of a channel.
struct Control {
  unsigned size = 2, chain = 0, ring = 0;
  bool read = true, write = true;
  unsigned treq = 0x3f;
  bool ring_write = false, quiet = false, high = false, swap = false, sniff = false, enable = true;
  constexpr std::uint32_t word() const {
    return (enable ? 1u : 0u) | (high ? 2u : 0u) | size << 2 | (read ? 16u : 0u) |
           (write ? 32u : 0u) | ring << 6 | (ring_write ? 1u << 10 : 0u) | chain << 11 |
           treq << 15 | (quiet ? 1u << 21 : 0u) | (swap ? 1u << 22 : 0u) | (sniff ? 1u << 23 : 0u);
  }
};

struct DmaTest : testing::Test {
  Rig rig;
  /// Sets a channel up and starts it.
  void start(unsigned channel, std::uint32_t from, std::uint32_t to, std::uint32_t count,
             const Control& control) {
    prepare(channel, from, to, count, control);
    rig.dma(multi, 1u << channel);
  }
  void prepare(unsigned channel, std::uint32_t from, std::uint32_t to, std::uint32_t count,
               const Control& control) {
    rig.dma(ch(channel, 0x00), from);
    rig.dma(ch(channel, 0x04), to);
    rig.dma(ch(channel, 0x08), count);
    rig.dma(ch(channel, 0x10), control.word());
  }
  bool busy(unsigned channel) { return (rig.read_dma(ch(channel, 0x10)) >> 24 & 1u) != 0; }
  std::uint32_t word(std::uint32_t offset) {
    std::uint32_t value;
    std::memcpy(&value, rig.bus.sram().data() + offset, 4);
    return value;
  }
  void fill(std::uint32_t offset, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) rig.write(ram + offset + 4 * i, 0x1000'0000u + i);
  }
  void text(std::uint32_t offset, std::string_view bytes) {
    std::memcpy(rig.bus.sram().data() + offset, bytes.data(), bytes.size());
  }
};

TEST_F(DmaTest, OneTransferAClockAfterTheStart) {
  fill(0, 10);
  const Cycle at = rig.now();
  start(0, ram, ram + 0x100, 10, {});
  // Reads in start + dma_start .. + 9, writes one later.
  rig.run_to(at + rig.timing.dma_start + 9);
  EXPECT_TRUE(busy(0));
  EXPECT_EQ(rig.read_dma(ch(0, 0x08)), 1u);
  rig.run(1);
  EXPECT_FALSE(busy(0));
  for (unsigned i = 0; i < 10; ++i) EXPECT_EQ(word(0x100 + 4 * i), 0x1000'0000u + i);
  EXPECT_EQ(rig.read_dma(intr_dma), 1u);
  EXPECT_EQ(rig.read_dma(ch(0, 0x00)), ram + 40);
  EXPECT_EQ(rig.read_dma(ch(0, 0x04)), ram + 0x100 + 40);
  EXPECT_EQ(rig.read_dma(ch(0, 0x804 - 0x000)), 10u);  // DBG_TCR
  // Triggered again it continues from there with the same count.
  rig.dma(multi, 1);
  EXPECT_EQ(rig.read_dma(ch(0, 0x08)), 10u);
}

TEST_F(DmaTest, SizesAndByteSwap) {
  text(0, "\x01\x02\x03\x04\x05\x06\x07\x08");
  start(0, ram, ram + 0x100, 8, {.size = 0, .swap = true});
  start(1, ram, ram + 0x110, 4, {.size = 1, .chain = 1, .swap = true});
  start(2, ram, ram + 0x120, 2, {.size = 2, .chain = 2, .swap = true});
  rig.run(40);
  EXPECT_EQ(word(0x100), 0x04030201u);
  EXPECT_EQ(word(0x110), 0x03040102u);
  EXPECT_EQ(word(0x120), 0x01020304u);
  EXPECT_EQ(word(0x124), 0x05060708u);
}

TEST_F(DmaTest, EveryLayoutTriggersByItsLastRegister) {
  fill(0, 4);
  // The four registers in the order of the layout; the last one starts the channel.
  struct Layout {
    std::uint32_t read, write, count, control, last;
  };
  for (const Layout& l :
       {Layout{0x00, 0x04, 0x08, 0x0c, 0x0c}, Layout{0x14, 0x18, 0x1c, 0x10, 0x1c},
        Layout{0x28, 0x2c, 0x24, 0x20, 0x2c}, Layout{0x3c, 0x34, 0x38, 0x30, 0x3c}}) {
    Rig other;
    other.write(ram, 77);
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> writes = {
        {l.read, ram},
        {l.write, ram + 0x100},
        {l.count, 1},
        {l.control, Control{.chain = 5}.word()}};
    for (const auto& [reg, value] : writes)
      if (reg != l.last) other.dma(ch(5, reg), value);
    other.run(20);
    EXPECT_EQ(other.read(ram + 0x100), 0u);
    for (const auto& [reg, value] : writes)
      if (reg == l.last) other.dma(ch(5, reg), value);
    other.run(20);
    EXPECT_EQ(other.read(ram + 0x100), 77u);
  }
}

TEST_F(DmaTest, ChainStartsTheNextAndControlBlocksWork) {
  // Channel 0 writes (count, read) pairs into channel 1's layout 3, which chains back to it: a
  // gather.
  fill(0x400, 32);
  const std::uint32_t blocks[] = {2, ram + 0x400, 3, ram + 0x440, 0, 0};
  for (unsigned i = 0; i < 6; ++i) rig.write(ram + 4 * i, blocks[i]);
  prepare(1, 0, ram + 0x800, 0, {.chain = 0, .quiet = true});
  prepare(0, ram, dma_base + ch(1, 0x38), 2, {.chain = 0, .ring = 3, .ring_write = true});
  rig.dma(multi, 1);
  rig.run(200);
  EXPECT_FALSE(busy(0));
  EXPECT_FALSE(busy(1));
  const std::uint32_t wanted[] = {0, 1, 16, 17, 18};
  for (unsigned i = 0; i < 5; ++i) EXPECT_EQ(word(0x800 + 4 * i), 0x1000'0000u + wanted[i]);
  EXPECT_EQ(rig.read_dma(intr_dma), 3u);  // 0 at each end; 1 only at the null trigger
}

TEST_F(DmaTest, DisabledIgnoresTriggersAndPausesWhileBusy) {
  fill(0, 100);
  start(3, ram, ram + 0x400, 100, {.chain = 3, .enable = false});
  EXPECT_FALSE(busy(3));
  start(3, ram, ram + 0x400, 100, {.chain = 3});
  rig.run(20);
  rig.dma(ch(3, 0x10), Control{.chain = 3, .enable = false}.word());
  rig.run(10);
  const std::uint32_t left = rig.read_dma(ch(3, 0x08));
  rig.run(1000);
  EXPECT_TRUE(busy(3));
  EXPECT_EQ(rig.read_dma(ch(3, 0x08)), left);
  rig.dma(ch(3, 0x10), Control{.chain = 3}.word());
  rig.run(200);
  EXPECT_FALSE(busy(3));
  EXPECT_EQ(word(0x400 + 4 * 99), 0x1000'0063u);
}

TEST_F(DmaTest, AbortEndsASequence) {
  start(2, ram, ram + 0x400, 1'000'000, {.write = false});
  rig.run(50);
  rig.dma(chan_abort, 1u << 2);
  EXPECT_EQ(rig.read_dma(chan_abort), 1u << 2);  // one read is not written yet
  rig.run(5);
  EXPECT_EQ(rig.read_dma(chan_abort), 0u);
  EXPECT_FALSE(busy(2));
  EXPECT_EQ(rig.read_dma(ch(2, 0x08)), 0u);
  EXPECT_EQ(rig.read_dma(levels), 0u);
  EXPECT_EQ(rig.read_dma(intr_dma), 1u << 2);  // RP2040-E13
}

TEST_F(DmaTest, BusErrorsHaltAndInterrupt) {
  start(0, 0x3000'0000, ram, 5, {.quiet = true});
  rig.run(20);
  EXPECT_EQ(rig.read_dma(ch(0, 0x10)) >> 29, 0b110u);
  EXPECT_FALSE(busy(0));
  EXPECT_EQ(rig.read_dma(intr_dma), 1u);
  rig.dma(ch(0, 0x10), Control{}.word() | 1u << 30);
  EXPECT_EQ(rig.read_dma(ch(0, 0x10)) >> 29, 0u);
  start(1, ram, 0x3000'0000, 5, {.chain = 1});
  rig.run(20);
  EXPECT_EQ(rig.read_dma(ch(1, 0x10)) >> 29, 0b101u);
}

TEST_F(DmaTest, InterruptRegisters) {
  const auto line = [&](Irq which) {
    return (rig.irqs.levels() >> static_cast<unsigned>(which) & 1u) != 0;
  };
  rig.dma(inte0, 1u << 4);
  rig.dma(inte0 + 0x10, 1u << 5);
  start(4, ram, ram, 1, {.chain = 4});
  rig.run(10);
  EXPECT_TRUE(line(Irq::dma_0));
  EXPECT_FALSE(line(Irq::dma_1));
  EXPECT_EQ(rig.read_dma(ints0), 1u << 4);
  rig.dma(ints0, 1u << 4);
  EXPECT_FALSE(line(Irq::dma_0));
  rig.dma(intf0 + 0x10, 1);
  EXPECT_TRUE(line(Irq::dma_1));
  EXPECT_EQ(rig.read_dma(ints0 + 0x10), 1u);
  EXPECT_EQ(rig.read_dma(n_channels), 12u);
}

// A set alias on INTS acknowledges only the written bits, not all pending ones.
TEST_F(DmaTest, AliasesClearOnlyTheWrittenBitsOfInterruptRegisters) {
  rig.dma(inte0, 3);
  for (const unsigned channel : {0u, 1u}) start(channel, ram, ram + 0x100, 1, {.chain = channel});
  rig.run(10);
  ASSERT_EQ(rig.read_dma(ints0), 3u);
  rig.dma(0x2000 + ints0, 1);  // set
  EXPECT_EQ(rig.read_dma(ints0), 2u);
  rig.dma(0x3000 + intr_dma, 2);  // clear
  EXPECT_EQ(rig.read_dma(intr_dma), 0u);
}

TEST_F(DmaTest, ErrorsSurviveAChangeOfOtherBitsOfControl) {
  start(0, 0x3000'0000, ram, 4, {});
  rig.run(10);
  ASSERT_NE(rig.read_dma(ch(0, 0x10)) & 1u << 30, 0u);
  rig.dma(0x3000 + ch(0, 0x10), 1);  // clears EN
  EXPECT_EQ(rig.read_dma(ch(0, 0x10)) & (1u << 30 | 1u), 1u << 30);
  rig.dma(0x2000 + ch(0, 0x10), 1u << 30);
  EXPECT_EQ(rig.read_dma(ch(0, 0x10)) & 1u << 30, 0u);
}

TEST_F(DmaTest, PacingTimerSpreadsTransfers) {
  // 3/100: 30 transfers in 1000 clocks, whatever the phase.
  rig.dma(timer0 + 4, 3u << 16 | 100);
  start(0, ram, ram + 0x100, 1000, {.write = false, .treq = 0x3c});
  rig.run(100);
  const std::uint32_t before = rig.read_dma(ch(0, 0x08));
  rig.run(10'000);
  EXPECT_EQ(before - rig.read_dma(ch(0, 0x08)), 300u);
}

TEST_F(DmaTest, PwmWrapIsOneTransferEach) {
  start(0, ram, ram + 0x100, 1000, {.write = false, .treq = 26});
  for (int i = 0; i < 7; ++i) {
    rig.run(13);
    rig.fabric.dreqs().pwm_wrap(2);
    rig.fabric.dreqs().pwm_wrap(3);
  }
  rig.run(20);
  EXPECT_EQ(rig.read_dma(ch(0, 0x08)), 993u);
}

TEST_F(DmaTest, LevelOfAnotherBlockGivesThatManyTransfers) {
  start(0, ram, ram + 0x100, 1000, {.write = false, .treq = 21});  // UART0 RX
  rig.run(50);
  EXPECT_EQ(rig.read_dma(ch(0, 0x08)), 1000u);
  rig.fabric.dreqs().set_level(Dreq::uart0_rx, 1);
  rig.run(2);
  rig.fabric.dreqs().set_level(Dreq::uart0_rx, 0);
  rig.run(50);
  EXPECT_EQ(rig.read_dma(ch(0, 0x08)), 999u);
}

TEST_F(DmaTest, HighPriorityPrecedesEachOtherChannel) {
  // Reads from bank 0, writes to bank 1 (2.6.2): they do not meet.
  for (unsigned i = 0; i < 4; ++i)
    prepare(i, ram, ram + 0x104 + 16 * i, 100'000,
            {.chain = i, .read = false, .write = false, .high = i == 1});
  rig.dma(multi, 0xf);
  rig.run(6000);
  const auto done = [&](unsigned i) {
    return static_cast<double>(100'000 - rig.read_dma(ch(i, 0x08)));
  };
  EXPECT_NEAR(done(1), 3000, 10);
  EXPECT_NEAR(done(0), 1000, 10);
  EXPECT_NEAR(done(2), 1000, 10);
  EXPECT_NEAR(done(3), 1000, 10);
}

TEST_F(DmaTest, SnifferMatchesKnownChecksums) {
  // Check values of "123456789" in the catalogue of parametrised CRC algorithms.
  text(0, "123456789");
  struct Case {
    std::uint32_t calculation, seed, output, wanted;
  };
  const std::uint32_t reversed = 1u << 10, inverted = 1u << 11;
  for (const Case& c : {Case{1, ~0u, reversed | inverted, 0xcbf4'3926u},  // CRC-32
                        Case{0, ~0u, inverted, 0xfc89'1918u},             // CRC-32/BZIP2
                        Case{2, 0xffff, 0, 0x29b1u},                      // CRC-16/CCITT-FALSE
                        Case{2, 0, 0, 0x31c3u},                           // CRC-16/XMODEM
                        Case{3, 0, reversed, 0x2189u << 16},              // CRC-16/KERMIT
                        Case{0xf, 0, 0, 477}, Case{0xe, 0, 0, 1}}) {
    rig.dma(sniff_ctrl, 1u | 6u << 1 | c.calculation << 5 | c.output);
    rig.dma(sniff_data, c.seed);
    start(6, ram, ram + 0x100, 9, {.size = 0, .chain = 6, .sniff = true});
    rig.run(30);
    EXPECT_EQ(rig.read_dma(sniff_data), c.wanted) << c.calculation;
  }
}

TEST_F(DmaTest, SnifferOverWordsIsSnifferOverBytes) {
  text(0, "abcdefghijklmnop");
  std::uint32_t results[2];
  for (unsigned words = 0; words < 2; ++words) {
    rig.dma(sniff_ctrl, 1u | 1u << 5);
    rig.dma(sniff_data, ~0u);
    start(0, ram, ram + 0x100, words != 0 ? 4 : 16, {.size = words != 0 ? 2u : 0u, .sniff = true});
    rig.run(40);
    results[words] = rig.read_dma(sniff_data);
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(DmaTest, PioIsFedWithoutAGapAndNeverOverrun) {
  fill(0, 64);
  rig.connect(0, 1);
  rig.machine(0, {out(pins, 32, 3)}, Pins{.out_base = 0, .out_count = 1}, 0, 0,
              both_right | 1u << 17);
  start(0, ram, pio_base[0] + txf, 64, {.write = false, .treq = 0});
  rig.run(30);
  EXPECT_EQ(rig.read_pio(flevel), 4u);
  EXPECT_EQ(rig.read_dma(ch(0, 0x800)), 0u);
  const Cycle first = rig.start(1);
  rig.run(400);
  EXPECT_EQ(rig.read_pio(fdebug) >> 16 & 1u, 0u);
  const auto edges = rig.edges_of(0, first);
  ASSERT_EQ(edges.size(), 63u);  // words alternate in bit 0
  for (std::size_t i = 1; i < edges.size(); ++i) EXPECT_EQ(edges[i] - edges[i - 1], 4);
}

// Memory -> TX -> machine -> RX -> memory through both blocks, with machines that are stopped,
// slowed and started at random: every word arrives once and in order.
TEST(DmaProperty, DeliversExactlyOnceUnderRandomStalls) {
  std::mt19937_64 random(5);
  for (int round = 0; round < scaled(60); ++round) {
    Rig rig;
    const unsigned words = 200;
    for (unsigned i = 0; i < words; ++i) rig.write(ram + 4 * i, i * 0x9e37'79b9u);
    const bool automatic = random() % 2 != 0;
    for (unsigned block = 0; block < 2; ++block)
      if (automatic)
        rig.machine(1, {out(x, 32), in(x, 32)}, Pins{}, 0, block, both_right | 3u << 16);
      else
        rig.machine(1, {pull(), mov(isr, osr), push()}, Pins{}, 0, block);
    struct Hop {
      std::uint32_t from, to;
      unsigned treq;
      bool read, write;
    };
    const Hop hops[] = {{ram, pio_base[0] + txf + 4, 1, true, false},
                        {pio_base[0] + rxf + 4, ram + 0x1000, 5, false, true},
                        {ram, pio_base[1] + txf + 4, 9, true, false},
                        {pio_base[1] + rxf + 4, ram + 0x2000, 13, false, true}};
    for (unsigned i = 0; i < 4; ++i) {
      rig.dma(ch(i, 0x00), hops[i].from);
      rig.dma(ch(i, 0x04), hops[i].to);
      rig.dma(ch(i, 0x08), words);
      rig.dma(
          ch(i, 0x0c),
          Control{.chain = i, .read = hops[i].read, .write = hops[i].write, .treq = hops[i].treq}
              .word());
    }
    for (int step = 0; step < 3000 && (rig.read_dma(intr_dma) & 0xau) != 0xau; ++step) {
      const auto below = [&random](std::uint32_t n) {
        return static_cast<std::uint32_t>(random() % n);
      };
      const unsigned block = below(2);
      if (below(3) != 0) rig.pio(sm(1, clkdiv), (1 + below(6)) << 16 | below(256) << 8, block);
      rig.pio(ctrl, random() % 3 != 0 ? 2 : 0, block);
      if (random() % 5 == 0) {
        const unsigned i = below(4);
        const auto control = Control{.chain = i,
                                     .read = hops[i].read,
                                     .write = hops[i].write,
                                     .treq = hops[i].treq,
                                     .enable = random() % 2 != 0};
        rig.dma(ch(i, 0x10), control.word());
      }
      rig.run(1 + random() % 60);
    }
    ASSERT_EQ(rig.read_dma(intr_dma) & 0xau, 0xau);
    for (unsigned i = 0; i < words; ++i) {
      ASSERT_EQ(rig.read(ram + 0x1000 + 4 * i), i * 0x9e37'79b9u);
      ASSERT_EQ(rig.read(ram + 0x2000 + 4 * i), i * 0x9e37'79b9u);
    }
    for (unsigned block = 0; block < 2; ++block)
      EXPECT_EQ(rig.read_pio(fdebug, block) & 0x00ff'ff00u, 0u);  // no overflow, no underflow
  }
}

}  // namespace
}  // namespace lamplock::test::pio::dma_test
