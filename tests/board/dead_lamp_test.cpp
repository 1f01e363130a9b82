// A lamp that does not flash: the machine comes to rest, dark, and reports the reason. As slave it
// resumes by itself when the lamp is back, as master only on a resume.

#include "tests/board/program_host.hpp"

namespace lamplock::test::dead_lamp_test {
namespace {

constexpr std::string_view message = "[MSG:No lamp: LAMP SYNC is missing or not at $901]";
constexpr std::string_view points = "M3 S500\nM130 P0\nG1 F600\nX1\nX0\nX1\nX0\nX1\nX0\n";
/// 32 beats at 100 Hz, as many again until the loss of the lock is detected, and braking.
constexpr Picoseconds known_within = 700 * ps_per_ms;

sim::LampConfig dark_for(double seconds) {
  sim::LampConfig lamp;
  lamp.on_after_s = seconds;
  return lamp;
}

TEST(DeadLamp, AsMasterTheMachineHoldsAndReportsWhy) {
  Rig rig(lamp_profile(100, LampMode::master), dark_for(20));
  ProgramHost host(rig);
  host.send(points);
  host.run(known_within);
  EXPECT_EQ(rig.state(), MachineState::hold);
  EXPECT_EQ(rig.status().hold_reason, HoldReason::lamp);
  EXPECT_TRUE(host.has_said(message));
  const Picoseconds held = rig.now();
  host.run(5 * ps_per_s);
  EXPECT_FALSE(rig.monitor.stepped(held, rig.now()));
  EXPECT_EQ(rig.monitor.fired(0, rig.now()), 0u);
  // Resumed without a lamp it holds again; with a lamp it continues.
  host.send("~");
  host.run(known_within);
  EXPECT_EQ(rig.state(), MachineState::hold);
  host.run(20 * ps_per_s);
  EXPECT_EQ(rig.state(), MachineState::hold);
  host.send("~");
  EXPECT_TRUE(host.wait_for_rest(10));
  EXPECT_EQ(rig.shots().size(), 6u);
  expect_sound(rig, rig.board.controller().values());
}

TEST(DeadLamp, AsSlaveTheMachineWaitsAndReportsWhy) {
  Rig rig(lamp_profile(100), dark_for(5));
  ProgramHost host(rig);
  host.send(points);
  host.run(known_within);
  EXPECT_TRUE(host.has_said(message));
  EXPECT_EQ(rig.state(), MachineState::run);
  EXPECT_FALSE(rig.monitor.stepped(0, rig.now()));
  EXPECT_TRUE(host.wait_for_rest(10));
  EXPECT_EQ(rig.shots().size(), 6u);
  EXPECT_EQ(std::count(host.said().begin(), host.said().end(), message), 1);
}

}  // namespace
}  // namespace lamplock::test::dead_lamp_test
