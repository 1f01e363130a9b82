// A limit switch actuated by the motion of the machine, on the virtual board.
#include <gmock/gmock.h>

#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

using testing::Contains;
using testing::StartsWith;

job::Profile guarded() {
  job::Profile profile = lamp_profile(100, settings::LampMode::free_beat);
  profile.settings.set_milli(Id::hard_limits, 1000);
  return profile;
}

TEST(SwitchOnBoard, StopsTheMachineAtTheStepThatActuatedIt) {
  // 5 um steps at 100 mm/s: one in 50 us, five in one round of the main loop.
  const job::Profile profile = guarded();
  for (int run = 0; run < scaled(20); ++run) {
    const std::int32_t place = 1500 + 37 * run % 2300;
    sim::WorldConfig world = world_for(profile);
    sim::ContactConfig contact = sim::ContactConfig::above(0, place);
    contact.bounce = {.make_us = 500, .break_us = 500};
    world.switches = {{.pin = sim::Pin::limit_x, .contacts = {contact}}};
    Rig rig(profile.settings, world);
    ProgramHost host(rig);
    host.send("G1 X20 F6000\n");
    host.run_ms(500);
    EXPECT_THAT(host.said(), Contains(StartsWith("ALARM:1")));
    EXPECT_EQ(rig.board.world().drives().position()[0], place);
    EXPECT_TRUE(rig.board.bus().level(sim::Pin::limit_x));
  }
}

TEST(SwitchOnBoard, ChangesNothingUntilItIsReached) {
  const auto steps = [](const std::vector<sim::WireConfig>& switches) {
    const job::Profile profile = guarded();
    sim::WorldConfig world = world_for(profile);
    world.switches = switches;
    Rig rig(profile.settings, world);
    ProgramHost host(rig);
    EXPECT_TRUE(host.stream("G1 X4 F6000\nG1 Y3 F4000\nG2 X0 Y0 I-2 J-1\nG0 X9.995\nG0 X0\n"));
    std::vector<std::pair<sim::Picoseconds, std::int32_t>> result;
    for (const PinMonitor::Step& step : rig.monitor.steps(0))
      result.emplace_back(step.at, step.position);
    return result;
  };
  const auto free = steps({});
  EXPECT_GT(free.size(), 3900u);
  EXPECT_EQ(free,
            steps({{.pin = sim::Pin::limit_x, .contacts = {sim::ContactConfig::above(0, 2000)}}}));
}

}  // namespace
}  // namespace lamplock::test
