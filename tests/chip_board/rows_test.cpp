// Row jobs on the chip: steps and light equal the virtual board's, at the speed of grey pixels.
#include <fmt/format.h>

#include <iostream>

#include "host/link/simulated_transport.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/board/pixel_rows.hpp"
#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/program_trace.hpp"

namespace lamplock::test {
namespace {

/// Sends rows to a board; returns the trace of its pins.
ProgramTrace burn(sim::Board& board, const PinMonitor& monitor, const Raster& raster) {
  link::SimulatedTransport transport(board);
  wire::JobHeader header;
  RowHost host(transport, PixelLines(raster).lines(), header);
  EXPECT_TRUE(host.run(10 + static_cast<int>(raster.rows())));
  EXPECT_EQ(host.status().starvations, 0u);
  EXPECT_EQ(host.status().first_unfired, host.status().received);
  return trace_of(monitor, board.world().beam(), board.now());
}

TEST(ChipRows, AndLightAreThoseOfTheVirtualBoard) {
  const Raster raster = sized_raster(11, 300, 1);
  const job::Profile machine = raster_machine();
  sim::VirtualBoard board(machine.settings, chip_world(machine));
  const PinMonitor monitor(board.bus(), board.world().lamp());
  board.run_until(ps_per_ms);
  const ProgramTrace ours = burn(board, monitor, raster);
  ChipRig rig(machine);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  const ProgramTrace chips = burn(rig.board, rig.monitor, raster);
  const TraceComparison steps(ours, chips, true);
  EXPECT_EQ(steps.difference(), "");
  EXPECT_GT(steps.steps(), 10'000u);
  EXPECT_EQ(steps.largest_step_error(), 0);
  EXPECT_EQ(steps.largest_gate_error(), 0);
  // A cell of LASER PWM has the power of its middle; a duty has 2000 counts.
  const LightComparison light(ours, chips, steps, 9 * ps_per_us);
  EXPECT_GT(light.samples(), 1000u);
  EXPECT_LE(light.largest_error(), 66);
  EXPECT_NEAR(light.energy(), light.other_energy(), 0.005 * light.energy());
  const Raster::Judgement judgement =
      raster.judge(rig.monitor, rig.board.world().beam(), 0, flicker);
  std::cout << fmt::format("{} steps, at most {} ps apart; light {} of 65535; {:.1f} mm/s\n",
                           steps.steps(), steps.largest_step_error(), light.largest_error(),
                           judgement.slowest_mm_s);
  EXPECT_EQ(judgement.lit_as_wanted, raster.pixels());
  EXPECT_LE(judgement.largest_shift, 1);
  EXPECT_GT(judgement.slowest_mm_s, 0.98 * Raster::speed_mm_s);
  EXPECT_TRUE(rig.shots().empty());
  expect_no_violations(rig);
}

}  // namespace
}  // namespace lamplock::test
