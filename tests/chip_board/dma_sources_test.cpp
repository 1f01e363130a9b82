// The DMA of the image never reads flash: flash cannot be read while settings are written, and
// motion continues then.
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

// RP2040 datasheet, 2.5.7 (registers of a channel) and 2.2 (the window of the flash with its
// aliases, which end where the XIP control registers begin).
constexpr std::uint32_t dma_base = 0x5000'0000, channel_stride = 0x40, control = 0x0c, enabled = 1;
constexpr unsigned dma_channels = 12;
constexpr std::uint32_t flash_begin = 0x1000'0000, flash_end = 0x1400'0000;

/// Number of enabled channels; fails the test for each channel whose source is in flash.
unsigned expect_no_flash_source(ChipRig& rig) {
  using sim::chip::Master;
  using sim::chip::Width;
  unsigned count = 0;
  for (unsigned channel = 0; channel < dma_channels; ++channel) {
    const auto read = [&](std::uint32_t offset) {
      return rig.board.chip()
          .bus()
          .read(dma_base + channel * channel_stride + offset, Width::word, Master::dma,
                rig.board.chip().now())
          .value;
    };
    if ((read(control) & enabled) == 0) continue;
    ++count;
    const std::uint32_t source = read(0);
    EXPECT_FALSE(source >= flash_begin && source < flash_end)
        << "channel " << channel << " reads " << std::hex << source;
  }
  return count;
}

TEST(DmaSources, AreNeverInFlash) {
  const job::Profile profile = chip_profile(250);
  ChipRig rig(profile);
  const job::Job job =
      job::make_job(chip_points(static_cast<std::size_t>(scaled(10)), 4), profile, {});
  RunningJob running(rig, job, 1);
  // AXIS of three axes, BITS, its power, TICK, STAMP and the channel that restarts them.
  constexpr unsigned channels_in_use = 8;
  unsigned most = expect_no_flash_source(rig);
  while (running.sender.step() && !testing::Test::HasFailure())
    most = std::max(most, expect_no_flash_source(rig));
  EXPECT_EQ(rig.shots().size(), job.targets.size());
  EXPECT_EQ(most, channels_in_use);
}

}  // namespace
}  // namespace lamplock::test
