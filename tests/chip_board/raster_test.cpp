// Raster engraving on the chip after an e-stop, and the power at the pin over a ramp.
// ticks_test.cpp has its rasters.
#include <fmt/format.h>

#include "tests/board/raster.hpp"

#include <algorithm>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test::raster_test {
namespace {

/// An e-stop with light on restarts the lattice, at any tick, and LASER PWM with it.
TEST(ChipRaster, IsInItsPlaceAfterAnEStop) {
  std::mt19937_64 random(1);
  for (int i = 0; i < scaled(2); ++i) {
    ChipRig rig(raster_machine());
    rig.type("G21 G90 G0 X-40\nM3 S700\nG1 X-35 F9000\n");
    while (!rig.board.bus().level(sim::Pin::laser_gate)) rig.run(100 * ps_per_us);
    rig.run(static_cast<Picoseconds>(random() % 20'000) * ps_per_us);
    rig.press(sim::Pin::estop, rig.now() + ps_per_us, rig.now() + 5 * ps_per_ms);
    rig.run(100 * ps_per_ms);
    EXPECT_FALSE(rig.board.world().beam().shone(rig.now() - 90 * ps_per_ms, rig.now()));
    ASSERT_THAT(rig.answer("$X"), HasSubstr("ok"));
    const Raster raster(random(), 1, std::min(100, scaled(100)), 4);
    const std::size_t errors = rig.user.errors();
    rig.user.give(raster.program());
    ASSERT_TRUE(rig.user.run_until_answered(rig.now() + 11 * ps_per_s));
    ASSERT_TRUE(rig.user.run_until_idle(rig.now() + ps_per_s));
    EXPECT_EQ(rig.user.errors(), errors);
    expect_engraved(raster, rig.monitor, rig.board);
  }
}

/// M4: over a ramp of 20 ms each period of LASER PWM has the power of its speed.
TEST(ChipRaster, PowerInProportionFollowsTheSpeedInEachPeriod) {
  constexpr double accel_mm_s2 = 20'000, feed_mm_s = 400;
  constexpr Picoseconds period = 16 * ps_per_us;
  job::Profile machine = raster_machine();
  job::set_acceleration(machine, accel_mm_s2 / 1000);
  ChipRig rig(machine);
  rig.user.give(fmt::format("M4 S1000 F{}\nG1 X20\nM5\nM2\n", 60 * feed_mm_s));
  const Picoseconds end = rig.now() + ps_per_s;
  ASSERT_TRUE(rig.user.run_until_answered(end) && rig.user.run_until_idle(end));
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
