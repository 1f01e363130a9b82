// Times that docs/safety.md states, measured at the pins of the virtual board and printed.
// tests/chip_board measures those that need the flash image; the page lists both.

#include <random>
#include <string_view>
#include <vector>

#include "tests/board/board_cable.hpp"
#include "tests/board/program_host.hpp"
#include "tests/figure.hpp"

namespace lamplock::test::safety_figures_test {
namespace {

job::Profile burning_profile() {
  job::Profile profile = program_profile();
  job::state_setting(profile, Id::laser_mode, 1, "test");
  job::state_setting(profile, Id::hard_limits, 1, "test");
  return profile;
}

/// The time from which the laser stayed dark.
Picoseconds dark_since(const Rig& rig) {
  Picoseconds at = 0;
  for (const sim::BeamChange& change : rig.board.world().beam().changes())
    if (change.light() == 0) at = change.at;
  return at;
}

/// The longest light after an event while the laser burns, over several moments.
template <class Happens>
Picoseconds max_light(Happens&& happens) {
  std::mt19937_64 random(1);
  Picoseconds longest = 0;
  for (int i = 0; i < 10; ++i) {
    Rig rig(burning_profile());
    ProgramHost host(rig);
    host.send("M3 S500\nG1 X40 F3000\n");
    host.run(150 * ps_per_ms + static_cast<Picoseconds>(random() % (50 * ps_per_ms)));
    const Picoseconds at = rig.now();
    EXPECT_TRUE(rig.board.world().beam().shone(at - 1, at));
    happens(rig, host);
    host.run_ms(300);
    EXPECT_FALSE(rig.board.world().beam().shone(rig.now() - 1, rig.now()));
    longest = std::max(longest, dark_since(rig) - at);
  }
  return longest;
}
Picoseconds max_light_after(sim::Pin pin) {
  return max_light([pin](Rig& rig, ProgramHost&) { rig.set(pin, true); });
}

TEST(SafetyFigures, LightOff) {
  for (const std::uint8_t byte : {std::uint8_t{0x18}, std::uint8_t{0x84}})
    expect_figure(byte == 0x18 ? "light after a reset" : "light after 0x84",
                  max_light([byte](Rig&, ProgramHost& host) { host.send(byte); }), 0, 1);
  expect_figure("light after the door has opened", max_light_after(sim::Pin::door), 0, 2);
  expect_figure("light after a limit switch", max_light_after(sim::Pin::limit_y), 0, 2);
  expect_figure("light after the e-stop", max_light_after(sim::Pin::estop), 0, 0.01);
}

TEST(SafetyFigures, DrivesHoldBeforeTheyStep) {
  job::Profile profile = burning_profile();
  job::state_setting(profile, Id::idle_delay, 50, "test");
  Rig rig(profile);
  const EdgeLog enable(rig.board.bus(), sim::Pin::enable);
  ProgramHost host(rig);
  host.ask("G1 X1 F3000\n");
  ASSERT_TRUE(host.wait_for_rest());
  host.run_ms(200);
  ASSERT_FALSE(rig.board.bus().level(sim::Pin::enable)) << "the drives were not released";
  const std::size_t before = rig.monitor.steps(0).size();
  host.ask("G1 X2\n");
  ASSERT_TRUE(host.wait_for_rest());
  ASSERT_GT(rig.monitor.steps(0).size(), before);
  expect_figure("first step after the drives are enabled",
                rig.monitor.steps(0)[before].at - enable.edges().back().at, 200, 210);
}

/// A job whose host is silent and has no dead man's timeout: the machine waits for points.
TEST(SafetyFigures, AShutterClosesWhereItIsNotUsed) {
  job::Profile profile = lamp_profile();
  job::state_setting(profile, Id::dead_man, 0, "test");
  Rig rig(profile);
  const EdgeLog shutter(rig.board.bus(), sim::Pin::shutter_1);
  BoardCable cable(rig);
  const job::Job job = job::make_job(histogram_walk(3000, 1), profile, {});
  link::JobSender sender(cable, job, session(7));
  while (rig.shots().size() < 5) ASSERT_TRUE(sender.step());
  rig.run(40 * ps_per_s);
  expect_figure("shutter after the last shot", shutter.edges().back().at - rig.shots().back().at,
                1000, 1050);
}

TEST(SafetyFigures, ASilentHostIsNoticed) {
  job::Profile profile = lamp_profile();
  Rig rig(profile);
  BoardCable cable(rig);
  const job::Job job = job::make_job(histogram_walk(600, 1), profile, {});
  link::JobSender sender(cable, job, session(7));
  while (rig.shots().size() < 5) ASSERT_TRUE(sender.step());
  const Picoseconds silent = rig.now();
  while (rig.state() == MachineState::run && rig.now() < silent + 5 * ps_per_s) rig.run(ps_per_ms);
  // Its last frame was sent up to one status period ago.
  expect_figure("hold after the last call of a host", rig.now() - silent, 1800, 2001);
}

/// Time until the machine reports a missing lamp.
Picoseconds no_lamp_after(LampMode mode) {
  sim::LampConfig dark;
  dark.on_after_s = 100;
  Rig rig(lamp_profile(100, mode), dark);
  ProgramHost host(rig);
  const Picoseconds begun = rig.now();
  host.send("M3 S500\nM130 P0\nG1 X0.1 F600\n");
  while (!host.has_said("[MSG:No lamp: LAMP SYNC is missing or not at $901]") &&
         rig.now() < begun + 5 * ps_per_s)
    host.run(ps_per_ms / 4);
  return rig.now() - begun;
}

TEST(SafetyFigures, ADeadLampIsNoticed) {
  expect_figure("no lamp, as slave", no_lamp_after(LampMode::slave), 300, 350);
  expect_figure("no lamp, as master", no_lamp_after(LampMode::master), 300, 350);
}

}  // namespace
}  // namespace lamplock::test::safety_figures_test
