// Homing on the virtual board: the machine's position afterwards against the loads' positions;
// switches that bounce, are engaged from the start, never open or are missing; and interruptions.
#include <fmt/format.h>

#include <random>

#include "tests/board/machine_with_switches.hpp"

namespace lamplock::test::homing_test {
namespace {

constexpr std::uint8_t reset_byte = 0x18;

TEST(Homing, FindsTheSwitchesAndThePosition) {
  const SwitchPlan plan{.start = {300, -2000, 5000, 0}};
  MachineWithSwitches m(homing_profile(), plan);
  EXPECT_THAT(m.host.status(), StartsWith("<Alarm|"));
  EXPECT_THAT(m.host.ask("G0 X1\n"), ElementsAre("error:9"));
  EXPECT_THAT(m.home(), ElementsAre("ok"));
  EXPECT_THAT(m.host.status(), StartsWith("<Idle|MPos:49.000,49.000,49.000|"));
  expect_homed(m, plan);
  EXPECT_THAT(m.host.ask("G0 X-49 Y1\nG4 P0\n", 5), ElementsAre("ok", "ok"));
  EXPECT_EQ(m.loads()[0], -49 * 200 - plan.offset(0));
}

TEST(Homing, ReportsItselfAndTheSwitches) {
  MachineWithSwitches m(homing_profile(), {});
  m.host.send("$H\n");
  ASSERT_TRUE(m.wait_for_motion());
  EXPECT_THAT(m.host.status(), StartsWith("<Home|"));
  ASSERT_TRUE(m.wait_for([&] { return m.switches().engaged(sim::Pin::limit_z); }));
  EXPECT_THAT(m.host.status(), HasSubstr("|Pn:Z"));
  m.host.send("G1 X0 F600\n");  // waits for homing, as every line does
  ASSERT_TRUE(m.wait_for([&] { return m.host.answers().size() == 2; }));
  EXPECT_THAT(m.host.answers(), ElementsAre("ok", "ok"));
}

/// Z first, then X and Y together, as $44 and $45 say.
TEST(Homing, AxesHomeInTheirPhases) {
  MachineWithSwitches m(homing_profile(), {});
  m.host.send("$H\n");
  ASSERT_TRUE(m.wait_for([&] { return m.switches().engaged(sim::Pin::limit_z); }));
  EXPECT_EQ(m.loads()[0], 0);
  EXPECT_EQ(m.loads()[1], 0);
  ASSERT_TRUE(m.wait_for([&] { return m.switches().engaged(sim::Pin::limit_x); }));
  EXPECT_GT(m.loads()[1], 10'000);
  EXPECT_LT(m.loads()[2], 12'000);
}

TEST(Homing, OneAxisAlone) {
  const SwitchPlan plan;
  MachineWithSwitches m(homing_profile(), plan);
  EXPECT_THAT(m.home("$HY\n"), ElementsAre("ok"));
  expect_homed(m, plan, 2);
  EXPECT_EQ(m.loads()[0], 0);
  EXPECT_EQ(m.loads()[2], 0);
  EXPECT_THAT(m.host.ask("$HQ\n$HA\n"), ElementsAre("error:3", "error:5"));
}

TEST(Homing, IsRefusedWithoutHomingSwitches) {
  job::Profile profile = homing_profile();
  profile.settings.set_milli(Id::homing, 0);
  MachineWithSwitches m(profile, {});
  EXPECT_THAT(m.host.ask("$H\n"), ElementsAre("error:5"));
  EXPECT_THAT(m.host.status(), StartsWith("<Idle|"));
}

/// From any position, with switches at either end and any bounce, the error is at most a step.
TEST(Homing, AnywhereWithBouncingSwitches) {
  std::mt19937_64 random(7);
  for (int round = 0; round < scaled(12); ++round) {
    const SwitchPlan plan = random_switches(random, 100);
    job::Profile profile = homing_profile(plan.lower_ends);
    profile.settings.set_milli(Id::homing_passes, static_cast<int>(1 + random() % 3) * 1000);
    SCOPED_TRACE(fmt::format("round {}", round));
    MachineWithSwitches m(profile, plan);
    ASSERT_THAT(m.home(), Contains("ok"));
    expect_homed(m, plan);
  }
}

/// The switch is passed by at most the braking distance and the motion handed out, so the machine
/// does not hit it. A feed override applies to programs only.
TEST(Homing, BrakesAfterTheSwitch) {
  constexpr std::uint8_t feed_plus_10 = 0x91, feed_minus_10 = 0x92;
  for (const auto& [byte, times] :
       {std::pair{feed_plus_10, 0}, {feed_plus_10, 10}, {feed_minus_10, 5}}) {
    const SwitchPlan plan;
    MachineWithSwitches m(homing_profile(), plan);
    for (int i = 0; i < times; ++i) m.host.send(byte);
    m.host.send("$HX\n");
    std::int32_t highest = 0;
    ASSERT_TRUE(m.wait_for([&] {
      highest = std::max(highest, m.loads()[0]);
      return !m.host.answers().empty();
    }));
    // From 100 mm/s at 2 m/s2: 5 ms until it reacts, then 2.5 mm to brake.
    EXPECT_GT(highest, plan.switches[0] + 450) << times;
    EXPECT_LT(highest, plan.switches[0] + 500 + 100 + 10) << times;
  }
}

/// A job of points is refused at every moment of homing, also while the machine rests and waits.
TEST(Homing, NoJobStartsDuringHoming) {
  const job::Profile profile = homing_profile();
  const job::Job job = job_for({{0, 0, 0}}, profile, JoinMode::free);
  MachineWithSwitches m(profile, {});
  m.host.send("$H\n");
  m.host.run_ms(1);
  int asked = 0;
  for (; m.host.answers().empty() && asked < 100'000; ++asked) {
    ASSERT_EQ(m.rig.board.controller().on_begin(job::header_from(job, 0)), Result::busy);
    m.host.run_ms(1);
  }
  EXPECT_GT(asked, 100);
  EXPECT_THAT(m.host.answers(), ElementsAre("ok"));
  expect_homed(m, {});
}

TEST(HomingFaults, NoSwitchWithinReach) {
  SwitchPlan plan;
  plan.switches[0] = 200'000;
  MachineWithSwitches m(homing_profile(), plan);
  EXPECT_THAT(m.home("$HX\n"), ElementsAre("ALARM:9", "error:9"));
  EXPECT_EQ(m.loads()[0], 150 * 200);  // one and a half times the travel
  EXPECT_THAT(m.host.ask("$X\nG0 X1\n"), Contains("ok").Times(2));
}

TEST(HomingFaults, ABrokenWireNeverOpens) {
  MachineWithSwitches m(homing_profile(), {});
  m.switches().break_wire(sim::Pin::limit_x, m.rig.now());
  m.host.run_ms(1);
  EXPECT_THAT(m.host.ask("$HX\n", 10), ElementsAre("ALARM:8", "error:9"));
  EXPECT_EQ(m.loads()[0], -200);  // one pull-off
}

TEST(HomingFaults, AContactThatIsBridgedIsNotFound) {
  SwitchPlan plan;
  sim::WireConfig wire = limit_switch(0, plan);
  wire.contacts[0].bridged_from = 0;
  MachineWithSwitches m(homing_profile(), plan, {wire});
  EXPECT_THAT(m.home("$HX\n"), ElementsAre("ALARM:9", "error:9"));
}

TEST(HomingFaults, DoorResetAndEstopAtAnyMoment) {
  std::mt19937_64 random(3);
  for (int round = 0; round < scaled(30); ++round) {
    MachineWithSwitches m(homing_profile(), {});
    m.host.send("$H\n");
    m.host.run_ms(static_cast<double>(random() % 2500));
    if (!m.host.answers().empty()) continue;
    const int what = round % 3;
    SCOPED_TRACE(fmt::format("round {} what {}", round, what));
    expect_homing_ends(m, what);
  }
}

std::size_t steps_made(const Rig& rig) {
  std::size_t steps = 0;
  for (int axis = 0; axis < 3; ++axis) steps += rig.monitor.steps(axis).size();
  return steps;
}

/// As in grbl: the alarm, then the banner, once the machine is at rest. Waiting lines and an
/// incomplete line are dropped without an answer; homing again works.
TEST(HomingFaults, AResetDropsWaitingLinesAndIsReportedOnce) {
  std::mt19937_64 random(17);
  job::Profile profile = homing_profile();
  profile.settings.set_milli(Id::laser_mode, 1000);
  int resets = 0, while_moving = 0;
  for (int round = 0; round < scaled(40); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    const SwitchPlan plan{.start = {300, -2000, 5000, 0}};
    MachineWithSwitches m(profile, plan);
    m.host.send(random() % 3 == 0 ? "$HY\n" : "$H\n");
    m.host.send("M3 S1000\nG1 X20 F6000\n$100=160\nM8\nG0 X-");
    m.host.run(static_cast<Picoseconds>(random() % 2'500'000) * ps_per_us);
    if (!m.host.answers().empty()) continue;  // homing had ended
    ++resets;
    const std::size_t before = steps_made(m.rig);
    m.host.send(reset_byte);
    if (random() % 2 == 0) m.host.send(reset_byte);
    m.host.run_ms(100);  // 100 mm/s at 2 m/s2 brakes in 50 ms
    const StepPosition stood = m.loads();
    if (steps_made(m.rig) != before) ++while_moving;
    m.host.run_ms(400);
    EXPECT_EQ(m.loads(), stood);
    EXPECT_THAT(m.host.said(),
                ElementsAre("ALARM:6", "Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"));
    EXPECT_THAT(m.host.status(), StartsWith("<Alarm|"));
    EXPECT_EQ(m.rig.board.world().beam().openings(), 0u);
    EXPECT_FALSE(m.rig.board.bus().level(sim::Pin::air));
    EXPECT_EQ(m.rig.board.world().drives().total_faults(), 0u);
    EXPECT_THAT(m.host.ask("$X\n"), ElementsAre("[MSG:Caution: Unlocked]", "ok"));
    EXPECT_THAT(m.host.status(), StartsWith("<Idle|"));
    EXPECT_EQ(m.loads(), stood);
    // Beyond a switch by more than a pull-off, homing fails with ALARM:8 but ends nearer than
    // before.
    const int most = 4;
    for (int i = 0; i < most && m.home().back() != "ok"; ++i) {
    }
    EXPECT_EQ(m.host.answers().back(), "ok");
    expect_homed(m, plan);
    EXPECT_EQ(m.rig.board.controller().values().milli(Id::steps_per_mm_x),
              profile.settings.milli(Id::steps_per_mm_x));
  }
  EXPECT_GT(while_moving, 0);
  EXPECT_TRUE(resets > while_moving || scaled(40) < 40) << "no reset while homing rested";
}

/// An e-stop or a door while it still brakes from a reset: one alarm, and the banner all the same.
TEST(HomingFaults, AnEStopAfterAResetIsReportedAndTheResetToo) {
  std::mt19937_64 random(19);
  for (int round = 0; round < scaled(12); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    MachineWithSwitches m(homing_profile(), {});
    m.host.send("$HX\n");
    ASSERT_TRUE(m.wait_for([&] { return m.loads()[0] > 2000; }));
    m.host.send(reset_byte);
    const bool estop = round % 2 == 0;
    const auto later = static_cast<Picoseconds>(2000 + random() % 28'000) * ps_per_us;
    m.rig.board.world().schedule(estop ? sim::Pin::estop : sim::Pin::door, true,
                                 m.rig.now() + later);
    m.host.run_ms(300);
    EXPECT_THAT(m.host.answers(), IsEmpty());
    std::vector<std::string> alarms, banners;
    for (const std::string& line : m.host.said()) {
      if (line.starts_with("ALARM:")) alarms.push_back(line);
      if (line.starts_with("Grbl")) banners.push_back(line);
    }
    EXPECT_THAT(alarms, ElementsAre(estop ? "ALARM:10" : "ALARM:6"));
    EXPECT_EQ(banners.size(), 1u);
  }
}

TEST(HomingFaults, AnEngagedSwitchIsAnAlarmAgainAfterHoming) {
  MachineWithSwitches m(homing_profile(), {});
  ASSERT_THAT(m.home(), ElementsAre("ok"));
  EXPECT_THAT(m.host.ask("$20=0\nG0 X60\n", 3), Contains("ok").Times(2));
  ASSERT_TRUE(m.wait_for([&] { return m.host.has_said("ALARM:1"); }));
  EXPECT_NEAR(m.loads()[0], 12'000, 2);  // stopped at once
}

}  // namespace
}  // namespace lamplock::test::homing_test
