// The e-stop at the worst moments: while the firmware works on what the e-stop stops.
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// Presses the e-stop for some time.
void press(ChipRig& rig, Picoseconds at) { rig.press(sim::Pin::estop, at, at + 100 * ps_per_us); }

/// FIRE reports the result of an edge 2.2 us after it; the firmware reads it slightly later.
TEST(EmergencyStop, BetweenAResultOfTheFireStageAndItsReader) {
  ChipRig rig;
  rig.run(20 * ps_per_ms);
  for (Picoseconds offset = 1800 * ps_per_ns; offset <= 2600 * ps_per_ns;
       offset += 40 * ps_per_ns) {
    SCOPED_TRACE(testing::Message() << "ns after the edge: " << offset / ps_per_ns);
    const sim::Lamp& lamp = rig.board.world().lamp();
    const std::int64_t seen = lamp.flashes();
    while (lamp.flashes() == seen) rig.run(100 * ps_per_us);
    press(rig, lamp.flash_before(rig.now()).at + 2 * ps_per_ms + offset);
    rig.run(5 * ps_per_ms);
    ASSERT_THAT(rig.status(), HasSubstr("<Alarm"));
  }
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
}

}  // namespace
}  // namespace lamplock::test
