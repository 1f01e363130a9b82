// CPU, PIO, DMA and pins of a whole chip share one clock; emulators that run each of them
// separately get this wrong. Images of 252 bytes on the ring oscillator; edges on pins, in cycles
// of clk_sys.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/chip/image/image.hpp"
#include "tests/chip/listeners.hpp"
#include "tests/chip/tiny_image.hpp"

namespace lamplock::sim::chip::one_clock_test {
namespace {

using lamplock::test::leave_reset;
using lamplock::test::Store;
using lamplock::test::tiny_image;

constexpr std::uint32_t pio0 = 0x5020'0000, dma = 0x5000'0000, ram = 0x2000'0000;
/// Out of reset (2.14.3): IO_BANK0, PADS_BANK0, and DMA, PIO0.
constexpr Store leave_reset_too{0x4000'f000, 1u << 2 | 1u << 10};
constexpr Store function(unsigned gpio, std::uint32_t value) {
  return {0x4001'4004 + 8 * gpio, value};
}
constexpr std::uint32_t to_sio = 5, to_pio0 = 6;

/// Runs an image for a while after the ROM has started it.
struct ImageRun {
  explicit ImageRun(const std::vector<std::uint8_t>& image) : pads(chip.gpio()) {
    chip.load(parse_bin(image, "image"), "image");
    chip.power_on();
    chip.run_until(chip.wheel().cycle_at(20 * ps_per_ms));
  }
  Chip chip;
  rigs::Pads pads;
};

/// gpio2 toggles every 3 cycles (STR to SIO 1, B 2; TRM, 3.3), or with a NOP every 4.
std::vector<std::uint16_t> toggle(bool slow) {
  std::vector<std::uint16_t> code{
      0x200d,  // movs r0, #13
      0x0700,  // lsls r0, r0, #28: SIO
      0x2104,  // movs r1, #4
      0x61c1,  // toggle: str r1, [r0, #28], GPIO_OUT_XOR
  };
  if (slow) code.push_back(0xbf00);
  code.push_back(static_cast<std::uint16_t>(slow ? 0xe7fc : 0xe7fd));  // b toggle
  while (code.size() % 2 != 0) code.push_back(0xbf00);
  return code;
}

// A state machine copies gpio2 to gpio3: MOV PINS, PINS in every clock. From pad to pad there are
// two flip-flops (3.5.6.3), the register before the machine, the instruction, and the register
// after it: always 4 clocks, whatever the phase of the CPU's edges (docs/chip-timing.md).
TEST(OneClock, APioFollowsThePinOfTheCpuAfterAConstantTime) {
  for (const bool slow : {false, true}) {
    ImageRun run(tiny_image(toggle(slow), {leave_reset,
                                           leave_reset_too,
                                           function(2, to_sio),
                                           function(3, to_pio0),
                                           {pio0 + 0x48, 0xa000},  // mov pins, pins
                                           {pio0 + 0xcc, 0},       // SM0_EXECCTRL: wrap at 0
                                           {pio0 + 0xdc, 1u << 26 | 3u << 5},
                                           {pio0 + 0xd8, 0xe081},  // set pindirs, 1
                                           {pio0 + 0xdc, 1u << 20 | 3 | 2u << 15},
                                           {pio0, 1},                  // SM0_ENABLE
                                           {0xd000'0024, 1u << 2}}));  // GPIO_OE_SET
    const std::vector<Cycle> cpu = run.pads.cycles(2), pio = run.pads.cycles(3);
    ASSERT_GT(cpu.size(), 1000u);
    for (std::size_t i = 1; i < cpu.size(); ++i)
      ASSERT_EQ(cpu[i] - cpu[i - 1], slow ? 4u : 3u) << i;
    ASSERT_GE(pio.size() + 2, cpu.size());
    for (std::size_t i = 0; i < pio.size(); ++i) ASSERT_EQ(pio[i] - cpu[i], 4u) << i;
  }
}

// The DMA moves at most one word per clock (2.5): 200 words take 200 clocks and the start, while
// the CPU runs; then a second, chained channel signals the end by the override of gpio3 (2.19.6.1).
TEST(OneClock, TheDmaTakesItsClocksWhileTheCpuRuns) {
  constexpr std::uint32_t words = 200;
  const std::uint32_t increments = 1u << 4 | 1u << 5, size = 2u << 2, unpaced = 0x3fu << 15;
  ImageRun run(
      tiny_image(toggle(false), {leave_reset,
                                 leave_reset_too,
                                 function(2, to_sio),
                                 function(3, 0x3205),  // output low, enabled
                                 {ram, 0x3305},        // output high
                                 {0xd000'0024, 1u << 2},
                                 {dma + 0x40, ram},          // channel 1
                                 {dma + 0x44, 0x4001'401c},  // GPIO3_CTRL
                                 {dma + 0x48, 1},
                                 {dma + 0x50, unpaced | 1u << 11 | size | 1},  // AL1_CTRL: no start
                                 {dma + 0x00, ram},                            // channel 0
                                 {dma + 0x04, ram + 0x1000},
                                 {dma + 0x08, words},
                                 {0xd000'001c, 1u << 2},  // gpio2: the CPU is here
                                 {dma + 0x0c, unpaced | 1u << 11 | increments | size | 1}}));
  const std::vector<Cycle> cpu = run.pads.cycles(2), done = run.pads.cycles(3);
  ASSERT_EQ(done.size(), 1u) << "one word by channel 1";
  // LDM 3, CMP 1, B 1 + STR 2: the start is some 10 cycles after the CPU's edge.
  const Cycle took = done[0] - cpu[0];
  EXPECT_GE(took, words);
  EXPECT_LE(took, words + 40);
  std::size_t meanwhile = 0;
  for (const Cycle at : cpu)
    if (at > cpu[0] && at < done[0]) ++meanwhile;
  EXPECT_GT(meanwhile, words / 3 - 20) << "the CPU must run meanwhile";
}

}  // namespace
}  // namespace lamplock::sim::chip::one_clock_test
