// A CoreXY on the virtual board: tool, switches and reports are in X and Y, whatever the motors do
// together. program_golden_test.cpp and program_limits_test.cpp check its programs too.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>

#include "tests/board/exact_programs.hpp"
#include "tests/board/machine_with_switches.hpp"
#include "tests/board/turning_job.hpp"

namespace lamplock::test {
namespace {

job::Profile core_xy(job::Profile profile) {
  profile.settings.set_milli(Id::kinematics, 1000);
  return profile;
}
job::Profile plain_core_xy() { return core_xy(program_profile()); }

/// The motors are at the sum and difference of the axes' steps, even between whole steps.
void expect_motors_at_axes(const Rig& rig) {
  const stepper::TickGenerator& generator = rig.board.controller().runner().generator();
  const stepper::MotionState at = generator.state();
  PerAxis<stepper::AxisRun> axes{};
  for (std::size_t a = 0; a < axes.size(); ++a) axes[a].position_q64 = at.axis[a].position_q64;
  StepPosition motors{};
  for (std::size_t a = 0; a < axes.size(); ++a) motors[a] = axes[a].step();
  for (const AxisPair& pair : generator.kinematics().pairs())
    for (const bool second : {false, true})
      motors[index(pair.motor(second))] =
          motor_run(pair, axes[pair.first], axes[pair.second], second).step();
  EXPECT_EQ(rig.board.world().drives().motors(), motors);
}

/// Compares motor steps, because two motor positions round to the same place in X and Y.
void expect_motors_at(const Rig& rig, const StepPosition& axes) {
  const Kinematics& kinematics = rig.board.controller().runner().generator().kinematics();
  EXPECT_EQ(rig.board.world().drives().motors(), kinematics.motors_of(axes));
}

/// X and Y of a status report, mm.
std::array<double, 2> reported_xy(ProgramHost& host) {
  std::array<double, 2> xy{};
  const std::string status = host.status();
  const std::size_t at = status.find("MPos:");
  EXPECT_NE(at, std::string::npos) << status;
  if (at == std::string::npos) return xy;
  EXPECT_EQ(std::sscanf(status.c_str() + at, "MPos:%lf,%lf", &xy[0], &xy[1]), 2) << status;
  return xy;
}

/// The report has half the sum and half the difference of the motors' turns, to the last digit.
void expect_reported_at_motors(const Rig& rig, ProgramHost& host) {
  constexpr double steps_per_mm = 200, last_digit_mm = 0.001;
  const StepPosition motors = rig.board.world().drives().motors();
  const std::array<double, 2> xy = reported_xy(host);
  EXPECT_NEAR(xy[0], (motors[0] + motors[1]) / 2.0 / steps_per_mm, 0.51 * last_digit_mm);
  EXPECT_NEAR(xy[1], (motors[0] - motors[1]) / 2.0 / steps_per_mm, 0.51 * last_digit_mm);
}

std::string random_move(std::mt19937_64& random) {
  const auto mm = [&random] { return std::uniform_real_distribution<double>(-20, 20)(random); };
  return fmt::format("{} X{:.3f} Y{:.3f} Z{:.3f} F6000\n", random() % 4 == 0 ? "G0" : "G1", mm(),
                     mm(), mm());
}

/// Along X both motors turn the same way, along Y they turn opposite ways.
TEST(CoreXy, MotorsMakeTheSumAndTheDifference) {
  const job::Profile profile = plain_core_xy();
  Rig rig(profile);
  ProgramHost host(rig);
  const auto expect_motors = [&](const char* line, const StepPosition& motors) {
    ASSERT_TRUE(host.stream(line));
    host.run_ms(5);
    EXPECT_EQ(rig.board.world().drives().motors(), motors) << line;
  };
  expect_motors("G0 X10\n", {2000, 2000, 0, 0});
  expect_motors("G0 Y1\n", {2200, 1800, 0, 0});
  expect_motors("G1 X-1 Y-2 Z3 F1000\n", {-600, 200, 600, 0});
}

/// The same program on both machines: each motor steps at the ticks of the sum or the difference.
TEST(CoreXy, ReachesThePositionsOfACartesianMachine) {
  std::mt19937_64 random(1);
  for (int program = 0; program < scaled(20); ++program) {
    const job::Profile profile = plain_core_xy();
    Rig rig(profile);
    ProgramHost host(rig);
    ExactProgram exact(static_cast<unsigned>(program + 5000));
    Rig cartesian(program_profile());
    ProgramHost cartesian_host(cartesian);
    for (int part = 0; part < 3; ++part) {
      std::string text;
      for (int i = 0; i < 8; ++i) text += exact.lines();
      ASSERT_EQ(host.stream(text), cartesian_host.stream(text)) << text;
      host.run_ms(5);
      cartesian_host.run_ms(5);
      ASSERT_EQ(host.answers(), cartesian_host.answers()) << text;
      ASSERT_EQ(rig.board.world().drives().position(), cartesian.board.world().drives().position())
          << text;
      ASSERT_EQ(host.position(), rig.board.world().drives().position());
      expect_motors_at(rig, host.position());
    }
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  }
}

/// Points on the beat, in every join mode.
TEST(CoreXy, ShootsEveryPointAtItsPlace) {
  for (const JoinMode mode : {JoinMode::free, JoinMode::start_stop, JoinMode::path}) {
    const job::Profile profile = core_xy(lamp_profile());
    const job::Job job =
        job_for(wild_points(static_cast<std::size_t>(scaled(60)), 3), profile, mode);
    Rig rig(profile);
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  }
}

/// The lag of the slower drive applies to both; loads are at their places all the same.
TEST(CoreXy, LagsOfBothDrivesAreThoseOfTheSlower) {
  job::Profile profile = core_xy(lamp_profile());
  set_lag(profile, {700, 400, 100});
  sim::WorldConfig world = world_for(profile);
  world.drives.lag_us[1] = world.drives.lag_us[0];
  Rig rig(profile.settings, world);
  const job::Job job = job_for(wild_points(30, 5), profile, JoinMode::free);
  ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
}

/// After an immediate stop motors keep their steps, and the next program ends at its place.
TEST(CoreXy, KeepsItsPositionAfterAnImmediateStop) {
  std::mt19937_64 random(2);
  int odd = 0;
  for (int round = 0; round < scaled(30); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    Rig rig(plain_core_xy());
    ProgramHost host(rig);
    std::string text;
    for (int i = 0; i < 5; ++i) text += random_move(random);
    host.send(text);
    host.run_ms(static_cast<double>(random() % 1500) + 0.137 * static_cast<double>(random() % 7));
    rig.set(sim::Pin::estop, true);
    host.run_ms(20);
    const sim::Drives& drives = rig.board.world().drives();
    const StepPosition stood = drives.motors();
    odd += (stood[0] + stood[1]) & 1;
    EXPECT_EQ(host.position(), drives.position());
    rig.set(sim::Pin::estop, false);
    host.run_ms(100);
    EXPECT_THAT(host.ask("$X\n"), Contains("ok"));
    host.run_ms(20);
    EXPECT_EQ(drives.motors(), stood);
    ASSERT_TRUE(host.stream("G90 G1 X1 Y2 Z3 F3000\n"));
    host.run_ms(5);
    expect_motors_at(rig, {200, 400, 600, 0});
    EXPECT_EQ(drives.total_faults(), 0u);
  }
  EXPECT_GT(odd, 0);
}

/// The same for a job of points that begins between steps.
TEST(CoreXy, JobsBeginBetweenSteps) {
  std::mt19937_64 random(3);
  int odd = 0;
  constexpr int enough_for_odd_ones = 6;
  for (int round = 0; round < std::max(scaled(12), enough_for_odd_ones); ++round) {
    const job::Profile profile = core_xy(lamp_profile());
    Rig rig(profile);
    ProgramHost host(rig);
    host.send(random_move(random));
    host.run_ms(static_cast<double>(20 + random() % 200));
    rig.set(sim::Pin::estop, true);
    host.run_ms(20);
    const StepPosition stood = rig.board.world().drives().motors();
    odd += (stood[0] + stood[1]) & 1;
    rig.set(sim::Pin::estop, false);
    host.run_ms(100);
    ASSERT_THAT(host.ask("$X\n"), Contains("ok"));
    const job::Job job = job_for(wild_points(8, random()), profile, JoinMode::free);
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    rig.run(10 * ps_per_ms);
    expect_motors_at(rig, job.targets.back().steps);
  }
  EXPECT_GT(odd, 0);
}

/// After any abort the report gives the motors' tool position, which may be between two steps of X
/// and Y; the next line continues from there.
TEST(CoreXy, ReportsHalfStepsAfterAnAbort) {
  std::mt19937_64 random(7);
  int odd = 0;
  constexpr int enough_for_odd_ones = 12;
  for (int round = 0; round < std::max(scaled(24), enough_for_odd_ones); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    Rig rig(plain_core_xy());
    ProgramHost host(rig);
    for (int i = 0; i < 4; ++i) {
      const bool jogs = random() % 3 == 0;
      if (jogs)
        host.send(fmt::format("$J=G91 X{} Y{} F6000\n", 3 + random() % 9, 3 + random() % 9));
      else
        host.send(random_move(random) + random_move(random));
      host.run_ms(static_cast<double>(10 + random() % 300));
      const bool held = !jogs && random() % 2 == 0;
      host.send(jogs ? "\x85" : held ? "!" : "\x18");
      host.run_ms(2000);
      expect_reported_at_motors(rig, host);
      if (held) host.send("\x18");
      host.run_ms(100);
      host.ask("$X\n");
      ASSERT_TRUE(host.wait_for_rest());
      host.run_ms(5);
      expect_reported_at_motors(rig, host);
      const StepPosition motors = rig.board.world().drives().motors();
      odd += (motors[0] + motors[1]) & 1;
    }
    ASSERT_TRUE(host.stream("G90 G1 X-1 Y2 Z3 F3000\n"));
    host.run_ms(5);
    expect_motors_at(rig, {-200, 400, 600, 0});
    expect_reported_at_motors(rig, host);
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  }
  EXPECT_GT(odd, 0);
}

/// Either axis alone turns both motors; the switches belong to X and Y.
TEST(CoreXy, HomesByAxes) {
  std::mt19937_64 random(6);
  for (int round = 0; round < scaled(12); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    const SwitchPlan plan = random_switches(random, 100);
    MachineWithSwitches m(core_xy(homing_profile(plan.lower_ends)), plan);
    ASSERT_THAT(m.home(), Contains("ok"));
    expect_homed(m, plan);
    const StepPosition at = m.host.position(), loads = m.loads();
    ASSERT_THAT(m.host.ask("G0 X0 Y0\nG4 P0\n", 10), ElementsAre("ok", "ok"));
    EXPECT_EQ(m.loads()[0] - loads[0], -at[0]);
    EXPECT_EQ(m.loads()[1] - loads[1], -at[1]);
    EXPECT_EQ(m.rig.board.world().drives().total_faults(), 0u);
  }
}

TEST(CoreXy, OneAxisHomesAlone) {
  const SwitchPlan plan{.start = {500, 700, 0, 0}};
  MachineWithSwitches m(core_xy(homing_profile()), plan);
  EXPECT_THAT(m.home("$HY\n"), ElementsAre("ok"));
  EXPECT_EQ(m.loads()[0], 500);
  EXPECT_NEAR(m.loads()[1], plan.switches[1] - pull_off_steps, 1);
}

TEST(CoreXy, AHardLimitStopsBothMotors) {
  MachineWithSwitches m(core_xy(homing_profile()), {});
  ASSERT_THAT(m.home(), ElementsAre("ok"));
  EXPECT_THAT(m.host.ask("$20=0\nG1 X20 Y60 F6000\n", 3), Contains("ok").Times(2));
  ASSERT_TRUE(m.wait_for([&] { return m.host.has_said("ALARM:1"); }));
  EXPECT_NEAR(m.loads()[1], 12'000, 2);
  const StepPosition stood = m.loads();
  m.host.run_ms(100);
  EXPECT_EQ(m.loads(), stood);
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(m.host.position()[index(a)], stood[index(a)] + SwitchPlan{}.offset(a), 1);
}

/// The probe reports the tool's place at the moment of contact, on a slanting path.
TEST(CoreXy, ProbesAtItsPlace) {
  sim::WireConfig probe{.pin = sim::Pin::probe,
                        .contacts = {sim::ContactConfig::above(0, 1234)},
                        .normally_closed = false};
  MachineWithSwitches m(plain_core_xy(), {}, {probe});
  const auto said = m.host.ask("G38.2 X10 Y5 F600\n", 5);
  EXPECT_THAT(said, Contains("ok"));
  EXPECT_THAT(said, Contains(StartsWith("[PRB:6.17")));
  EXPECT_THAT(said, Contains(HasSubstr(",3.0")));
  ASSERT_TRUE(m.host.wait_for_rest());
  m.host.run_ms(5);
  expect_motors_at_axes(m.rig);
  ASSERT_THAT(m.host.ask("G0 X0 Y0\nG4 P0\n", 3), ElementsAre("ok", "ok"));
  EXPECT_EQ(m.loads(), StepPosition{});
}

/// Steps in opposite directions keep the drive's minimum interval.
TEST(CoreXy, DrivesHaveTheirTimesWhereMotorsTurn) {
  job::Profile profile = core_xy(lamp_profile());
  PerAxis<settings::PulseMode> modes{};
  set_pulses(profile.settings, modes, 0, 0, 9000, 7000);
  Rig rig(profile);
  StepLog log(profile.settings, rig.board.bus());
  const job::Job job =
      job_for(wild_points(static_cast<std::size_t>(scaled(100)), 9), profile, JoinMode::free);
  ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
  EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
  EXPECT_GT(log.reversals(0).size(), static_cast<std::size_t>(scaled(100)) / 10);
}

/// CoreXY takes effect at the next start; combinations that are impossible are refused.
TEST(CoreXy, SettingsThatDoNotGoTogetherAreRefused) {
  Rig rig(plain_core_xy());
  ProgramHost host(rig);
  for (const char* line : {"$101=150\n", "$966=1\n", "$966=2\n"})
    EXPECT_THAT(host.ask(line), ElementsAre(HasSubstr("contradicts other settings"), "error:52"));
  EXPECT_THAT(
      host.ask("$111=240000\n"),
      ElementsAre("[MSG:$110 and $111 together at most 240000.000 mm/min with $0 and $1077]",
                  "error:12"));
  EXPECT_THAT(host.ask("$966=3\n$111=60000\n$965=0\n"), Each("ok"));
  // Until then the machine is Cartesian.
  ASSERT_TRUE(host.stream("G0 X1\n"));
  host.run_ms(5);
  EXPECT_EQ(rig.board.world().drives().motors(), (StepPosition{200, 200, 0, 0}));
  EXPECT_THAT(host.ask("$111=240000\n"),
              ElementsAre("[MSG:$111 contradicts other settings]", "error:52"));
}

}  // namespace
}  // namespace lamplock::test
