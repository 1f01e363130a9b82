// Raster engraving on the chip: 0.1 mm pixels in both directions at 300 mm/s and 2 m/s2, power at
// the pin within a step of its place.
#include <fmt/format.h>

#include "tests/board/raster.hpp"

#include <algorithm>

#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/program_sender.hpp"

namespace lamplock::test::raster_test {
namespace {

/// Engraves on a booted board.
void expect_engraved(ChipRig& rig, const Raster& raster, double lead_us, bool lists) {
  ProgramSender sender(rig.board);
  sender.give(raster.program(lists));
  const Picoseconds end = rig.now() + (10 + static_cast<Picoseconds>(raster.rows())) * ps_per_s;
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
  ChipRig rig(raster_machine());
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  expect_engraved(rig, sized_raster(1, 200, 4), 0, false);
}

TEST(ChipRaster, OfListsOfPowersWithALeadOfTheLaserIsTheSame) {
  ChipRig rig(raster_machine(180));
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  expect_engraved(rig, sized_raster(2, 200, 4), 180, true);
}

/// Every pixel has another power, at full speed.
TEST(ChipRaster, OfGreyPixelsKeepsItsSpeed) {
  ChipRig rig(raster_machine());
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  expect_engraved(rig, sized_raster(3, 400, 1), 0, true);
}

/// An e-stop with light on restarts the lattice, at any tick, and LASER PWM with it.
TEST(ChipRaster, IsInItsPlaceAfterAnEStop) {
  std::mt19937_64 random(1);
  for (int i = 0; i < scaled(2); ++i) {
    ChipRig rig(raster_machine());
    ASSERT_NO_FATAL_FAILURE(rig.boot());
    rig.type("G21 G90 G0 X-40\nM3 S700\nG1 X-35 F9000\n");
    while (!rig.board.bus().level(sim::Pin::laser_gate)) rig.run(100 * ps_per_us);
    rig.run(static_cast<Picoseconds>(random() % 20'000) * ps_per_us);
    rig.board.world().schedule(sim::Pin::estop, true, rig.now() + ps_per_us);
    rig.board.world().schedule(sim::Pin::estop, false, rig.now() + 5 * ps_per_ms);
    rig.run(100 * ps_per_ms);
    EXPECT_FALSE(rig.board.world().beam().shone(rig.now() - 90 * ps_per_ms, rig.now()));
    ASSERT_THAT(rig.answer("$X"), testing::HasSubstr("ok"));
    expect_engraved(rig, Raster(random(), 1, std::min(100, scaled(100)), 4), 0, false);
  }
}

/// M4: over a ramp of 20 ms each period of LASER PWM has the power of its speed.
TEST(ChipRaster, PowerInProportionFollowsTheSpeedInEachPeriod) {
  constexpr double accel_mm_s2 = 20'000, feed_mm_s = 400;
  constexpr Picoseconds period = 16 * ps_per_us;
  job::Profile machine = raster_machine();
  job::set_acceleration(machine, accel_mm_s2 / 1000);
  ChipRig rig(machine);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  ProgramSender sender(rig.board);
  sender.give(fmt::format("M4 S1000 F{}\nG1 X20\nM5\nM2\n", 60 * feed_mm_s));
  const Picoseconds end = rig.now() + ps_per_s;
  ASSERT_TRUE(sender.run_until_answered(end) && sender.run_until_idle(end));
  const auto& x = rig.monitor.steps(0);
  const sim::Beam& beam = rig.board.world().beam();
  const auto light = beam.changes();
  int changes = 0;
  const Picoseconds ramp_end = x.front().at + 20 * ps_per_ms;
  for (std::size_t i = 1; i < light.size() && light[i].at < ramp_end; ++i)
    if (light[i].power > light[i - 1].power) ++changes;
  EXPECT_GT(changes, 0.95 * 20 * ps_per_ms / period);
  // The speed from forty steps is that in the middle of their time; both ends are rounded to ticks.
  constexpr std::size_t steps = 40;
  constexpr double mm = steps * 0.005;
  double worst = 0;
  for (std::size_t i = 40; i + steps < x.size() - 40; i += 7) {
    const double seconds = static_cast<double>(x[i + steps].at - x[i].at) * 1e-12;
    const Picoseconds middle = (x[i].at + x[i + steps].at) / 2;
    const double speed = mm / seconds, tick = speed * 1e-6 / seconds;
    // An interval with an end of the ramp is the mean of more than a period.
    if (speed < 0.1 * feed_mm_s || std::abs(feed_mm_s - speed) < accel_mm_s2 * seconds) continue;
    const double power = beam.at(middle).light() * feed_mm_s / 65'535;
    worst = std::max(worst, std::abs(power - speed) - tick);
  }
  // Half a period of the ramp, and a count of the duty.
  std::cout << changes << " changes, off by " << worst << " mm/s\n";
  EXPECT_LE(worst, accel_mm_s2 * 8e-6 + feed_mm_s / 2000);
  EXPECT_GT(worst, 0);
}

}  // namespace
}  // namespace lamplock::test::raster_test
