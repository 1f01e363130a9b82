// Raster engraving on the chip: 0.1 mm pixels in both directions at 300 mm/s and 2 m/s2, power at
// the pin within a step of its place.
#include "tests/board/raster.hpp"

#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/program_sender.hpp"

namespace lamplock::test {
namespace {

void expect_engraved(const Raster& raster, double lead_us, bool lists) {
  ChipRig rig(raster_machine(lead_us));
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  ProgramSender sender(rig.board);
  sender.give(raster.program(lists));
  const Picoseconds end = rig.now() + 10 * ps_per_s;
  ASSERT_TRUE(sender.run_until_answered(end));
  ASSERT_TRUE(sender.run_until_idle(end));
  EXPECT_EQ(sender.errors(), 0u);
  const Raster::Judgement judgement = raster.judge(rig.monitor, rig.board.world().beam(),
                                                   static_cast<Picoseconds>(lead_us * ps_per_us));
  std::cout << fmt::format(
      "{} changes of light, at most {:.2f} steps from their places; {:.1f} mm/s\n",
      judgement.changes, judgement.largest_shift, judgement.slowest_mm_s);
  EXPECT_EQ(judgement.lit_as_wanted, raster.pixels());
  EXPECT_LE(judgement.largest_shift, 1);
  EXPECT_GT(judgement.changes, raster.pixels() / 10);
  EXPECT_GT(judgement.slowest_mm_s, 0.98 * Raster::speed_mm_s);
  EXPECT_FALSE(rig.board.bus().level(sim::Pin::laser_gate));
  expect_no_violations(rig);
}

TEST(ChipRaster, LightChangesAtTheEdgesOfPixels) {
  expect_engraved(Raster(1, 2, scaled(200), 4), 0, false);
}

TEST(ChipRaster, OfListsOfPowersWithALeadOfTheLaserIsTheSame) {
  expect_engraved(Raster(2, 2, scaled(200), 4), 180, true);
}

}  // namespace
}  // namespace lamplock::test
