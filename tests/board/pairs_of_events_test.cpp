// Two or three events close together during any activity: a key while it brakes for another key, a
// reset after a hold of a probe, a door on the way back from parking. In any order, every axis
// keeps its limits; after a reset, an unlock and a jog the machine makes only the jog, in the dark.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "tests/board/machine_with_switches.hpp"
#include "tests/judges/motion_judge.hpp"

namespace lamplock::test::pairs_of_events_test {
namespace {

enum class Machine { plain, jerk, core_xy, gantry };

constexpr int side = Kinematics::gang_motor;

/// Activities of the machine that take seconds.
constexpr std::array<std::string_view, 5> activities{
    "M3 S1000\nG1 X20 Y5 Z-1 F3000\nG2 X20 Y-5 J-5 I0\nG1 X0 Y0 Z0\nG4 P0.1\nG1 X9\n",
    "$J=G91 X40 Y10 F6000\n$J=G91 X5 F6000\n",
    "M3 S500\nG1 X2 F3000\nG38.3 Z-20 X10 F1500\nG1 X8 F1000\n", "$H\n",
    "M62 P0\nG1 X10 F6000\nM3 S800\nG1 X-40 Y30 F6000\nM63 P0\nG0 X0 Y0\n"};
constexpr std::size_t homing = 3;

class Events {
 public:
  Events(std::uint64_t seed, Machine kind) : random_(seed), profile_(profile_of(kind)) {
    SwitchPlan plan;
    plan.switches = {7000, 7000, 7000, 7000};  // inside the work space
    plan.bounce = {.make_us = 300, .break_us = 300};
    std::vector<sim::WireConfig> more;
    if (kind == Machine::gantry) {
      plan.start[side] = 160;
      plan.switches[side] = plan.switches[1];
      more.push_back(limit_switch(side, plan));
    }
    machine_ = std::make_unique<MachineWithSwitches>(profile_, plan, std::move(more));
    activity_ = random_() % activities.size();
    judge_ = std::make_unique<MotionJudge>(machine_->rig.board, judged(kind), true);
    if (activity_ == homing) judge_->expect_homing();
    machine_->host.ask("$X\n");
  }

  void run() {
    machine_->host.send(activities[activity_]);
    run_ms(700);
    for (std::uint64_t n = 2 + random_() % 2; n > 0; --n) {
      make();
      run_ms(random_() % 3 == 0 ? 400 : 60);
    }
    ASSERT_EQ(judge_->fault(), "") << events_;
    comes_to_rest();
    ASSERT_EQ(judge_->fault(), "") << events_;
    jogs_in_the_dark();
    ASSERT_EQ(judge_->fault(), "") << events_;
  }

 private:
  static job::Profile profile_of(Machine kind) {
    job::Profile profile = homing_profile();
    settings::Values& s = profile.settings;
    s.set_milli(Id::laser_mode, 1000);
    s.set_milli(Id::hard_limits, 0);  // a switch may bounce while the machine leaves it
    s.set_milli(Id::parking, 1000);
    s.set_milli(Id::parking_fast, 6'000'000);
    if (kind == Machine::jerk)
      for (int a = 0; a < 3; ++a) s.set_milli(settings::for_axis(Id::jerk_x, a), 50'000);
    if (kind == Machine::core_xy) s.set_milli(Id::kinematics, 1000);
    if (kind == Machine::gantry) s.set_milli(Id::ganged_axis, 2000);
    return profile;
  }
  /// Limits for both sides of a gantry; homing may go to its switches.
  settings::Values judged(Machine kind) const {
    settings::Values values = profile_.settings;
    if (activity_ == homing) values.set_milli(Id::soft_limits, 0);
    if (kind == Machine::gantry) values.set_milli(Id::axes, 4000);
    return values;
  }
  void run_ms(double most) {
    machine_->host.run_ms(std::uniform_real_distribution<>(0, most)(random_));
  }
  void set(sim::Pin pin, bool level) {
    sim::World& world = machine_->rig.board.world();
    world.schedule(pin, level, machine_->rig.board.now());
  }
  void make() {
    static constexpr std::array<std::uint8_t, 7> bytes{'!', '~', 0x18, 0x84, 0x85, 0x91, '!'};
    const std::uint64_t which = random_() % (bytes.size() + 4);
    events_ += fmt::format("{} at {:.3f} ms; ", which,
                           static_cast<double>(machine_->rig.board.now()) * 1e-9);
    if (which < bytes.size()) return machine_->host.send(bytes[which]);
    if (which < bytes.size() + 2) return set(sim::Pin::door, which == bytes.size());
    set(sim::Pin::probe, which == bytes.size() + 2);
  }

  void comes_to_rest() {
    set(sim::Pin::door, false);
    set(sim::Pin::probe, false);
    machine_->host.run_ms(1);
    machine_->host.run_ms(300);  // until an earlier reset has been answered
    const std::size_t before = banners();
    machine_->host.send(std::uint8_t{0x18});
    reset_ = machine_->rig.board.now();
    ASSERT_TRUE(machine_->wait_for([&] { return banners() != before; })) << events_;
    EXPECT_LT(machine_->rig.board.now() - reset_, 1000 * ps_per_ms) << events_;
    machine_->host.ask("$X\n");
    ASSERT_EQ(machine_->rig.state(), MachineState::idle) << events_;
  }
  std::size_t banners() const {
    const auto& said = machine_->host.said();
    return static_cast<std::size_t>(
        std::count_if(said.begin(), said.end(),
                      [](const std::string& line) { return line.starts_with("Grbl"); }));
  }
  /// X, Y and Z in half steps: the motors of a CoreXY may hold the tool between two steps.
  StepPosition half_steps() const {
    const StepPosition motors = machine_->rig.board.world().drives().motors();
    if (profile_.settings.whole(Id::kinematics) == 0)
      return {2 * motors[0], 2 * motors[1], 2 * motors[2], 0};
    return {motors[0] + motors[1], motors[0] - motors[1], 2 * motors[2], 0};
  }
  void jogs_in_the_dark() {
    MachineWithSwitches& m = *machine_;
    m.host.run_ms(10);
    const StepPosition before = half_steps();
    const std::int32_t side_before = m.loads()[side];
    ASSERT_THAT(m.host.ask("$J=G91 G21 X-0.5 F600\n", 2), testing::ElementsAre("ok")) << events_;
    m.host.run_ms(300);
    const StepPosition after = half_steps();
    // A move from a half step ends on a whole one.
    EXPECT_NEAR(after[0], before[0] - 2 * 100, std::abs(before[0] % 2)) << events_;
    EXPECT_NEAR(after[1], before[1], std::abs(before[1] % 2)) << events_;
    EXPECT_EQ(after[2], before[2]) << events_;
    EXPECT_EQ(m.loads()[side], side_before) << events_;
    ASSERT_THAT(m.host.ask("G90 G1 Y0 F6000\n", 2), testing::ElementsAre("ok")) << events_;
    set(sim::Pin::probe, true);  // no longer watched
    m.host.run_ms(2000);
    EXPECT_EQ(m.host.position()[1], 0) << events_;
    EXPECT_FALSE(m.rig.board.world().beam().shone(reset_ + ps_per_ms, m.rig.board.now()))
        << events_;
  }

  std::mt19937_64 random_;
  job::Profile profile_;
  std::unique_ptr<MachineWithSwitches> machine_;
  std::unique_ptr<MotionJudge> judge_;
  std::size_t activity_ = 0;
  sim::Picoseconds reset_ = 0;
  std::string events_;
};

class PairsOfEvents : public testing::TestWithParam<Machine> {};

TEST_P(PairsOfEvents, LimitsAreKeptAndNoStateRemains) {
  for (int i = 0; i < scaled(150); ++i) {
    SCOPED_TRACE(fmt::format("round {}", i));
    const auto seed = static_cast<std::uint64_t>(i) * 4 + static_cast<std::uint64_t>(GetParam());
    Events(seed, GetParam()).run();
    if (testing::Test::HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(OfAMachine, PairsOfEvents,
                         testing::Values(Machine::plain, Machine::jerk, Machine::core_xy,
                                         Machine::gantry));

// The same events, one test each.

job::Profile laser_profile() {
  job::Profile profile = lamp_profile(100, settings::LampMode::free_beat);
  profile.settings.set_milli(Id::laser_mode, 1000);
  return profile;
}

/// A plate that the tool touches at Z -3 and below.
sim::WireConfig plate() {
  return {.pin = sim::Pin::probe,
          .contacts = {sim::ContactConfig::below(2, -600)},
          .normally_closed = false};
}
MachineWithSwitches machine_with_plate(const job::Profile& profile) {
  return MachineWithSwitches(profile, {.switches = {100'000, 100'000, 100'000, 100'000}},
                             {plate()});
}

TEST(Events, AResetWhileAJogBrakesStartsNothing) {
  for (const std::uint8_t first : {std::uint8_t{0x85}, std::uint8_t{'!'}}) {
    Rig rig(laser_profile());
    const MotionJudge judge(rig.board, laser_profile().settings, true);
    ProgramHost host(rig);
    host.send("$J=G91 X40 F6000\n");
    host.run_ms(300);
    host.send(first);
    host.run_ms(15);
    const StepPosition at = host.position();
    host.send(std::uint8_t{0x18});
    host.run_ms(500);
    EXPECT_LT(host.position()[0] - at[0], 500);  // 100 mm/s and 2 m/s2 are 2.5 mm
    EXPECT_EQ(judge.fault(), "");
  }
}

TEST(Events, AResetAfterAHeldProbeEndsItsWatch) {
  MachineWithSwitches m = machine_with_plate(laser_profile());
  m.host.send("G38.2 Z-10 F600\n");
  m.host.run_ms(100);
  m.host.send("!");
  m.host.run_ms(200);
  m.host.send(std::uint8_t{0x18});
  m.host.run_ms(200);
  m.host.ask("$X\n");
  ASSERT_TRUE(m.host.stream("G1 X5 Z-6 F3000\nG1 X10\nG1 Z0\n"));
  EXPECT_EQ(m.loads()[0], 2000);
  EXPECT_EQ(m.rig.monitor.steps(2).back().position, m.loads()[2]);
  EXPECT_EQ(m.loads()[2], 0);
  long lowest = 0;
  for (const PinMonitor::Step& step : m.rig.monitor.steps(2))
    lowest = std::min<long>(lowest, step.position);
  EXPECT_EQ(lowest, -1200);
}

/// Parking lifts the tool off the plate, which does not end the probe.
TEST(Events, ADoorDuringAProbeParksAndThenTheProbeResumes) {
  job::Profile profile = laser_profile();
  profile.settings.set_milli(Id::parking, 1000);
  profile.settings.set_milli(Id::parking_fast, 6'000'000);
  MachineWithSwitches m = machine_with_plate(profile);
  m.host.ask("G0 Z-10\nG4 P0\n", 10);
  m.host.send("G38.4 Z5 F300\nG4 P0\n");
  m.host.run_ms(500);
  m.rig.board.world().schedule(sim::Pin::door, true, m.rig.board.now());
  m.host.run_ms(6000);
  EXPECT_THAT(m.host.status(), testing::StartsWith("<Door:1"));
  EXPECT_EQ(m.loads()[2], 45 * 200);
  EXPECT_EQ(m.host.answers().size(), 2u);
  m.rig.board.world().schedule(sim::Pin::door, false, m.rig.board.now());
  m.host.run_ms(1);
  m.host.send("~");
  ASSERT_TRUE(m.host.wait_for_rest());
  EXPECT_THAT(m.host.said(), testing::Contains("[PRB:0.000,0.000,-2.995:1]"));
  EXPECT_NEAR(m.loads()[2], -599, 20);
}

TEST(Events, AnAlarmLeavesNoLight) {
  for (const sim::Pin pin : {sim::Pin::limit_x, sim::Pin::estop}) {
    job::Profile profile = laser_profile();
    profile.settings.set_milli(Id::hard_limits, 1000);
    Rig rig(profile);
    ProgramHost host(rig);
    host.send("M3 S1000 F600\nG1 X10\n");
    host.run_ms(300);
    rig.board.world().schedule(pin, true, rig.board.now());
    host.run_ms(50);
    rig.board.world().schedule(pin, false, rig.board.now());
    host.run_ms(50);
    const sim::Picoseconds off = rig.board.now();
    ASSERT_THAT(host.ask("$X\nG1 X0 F6000\nG4 P0\n", 5), testing::Contains("ok").Times(3));
    EXPECT_EQ(host.position()[0], 0);
    EXPECT_FALSE(rig.board.world().beam().shone(off, rig.board.now()));
    ASSERT_TRUE(host.stream("M3 S1000\nG1 X5 F6000\n"));
    EXPECT_TRUE(rig.board.world().beam().shone(off, rig.board.now()));
  }
}

/// When squaring is aborted, the two sides of a gantry keep their offset.
TEST(Events, TheNextMoveKeepsAGantrysSkew) {
  for (const std::uint8_t last : {std::uint8_t{0x18}, std::uint8_t{0}}) {
    job::Profile profile = homing_profile();
    profile.settings.set_milli(Id::ganged_axis, 2000);
    SwitchPlan plan;
    plan.switches = {7000, 7000, 7000, 7000};
    plan.start[side] = -400;
    MachineWithSwitches m(profile, plan, {limit_switch(side, plan)});
    m.host.send("$H\n");
    const auto bent = [&m] { return m.loads()[1] - m.loads()[side] < 300; };
    ASSERT_TRUE(m.wait_for(bent));
    if (last != 0)
      m.host.send(last);
    else
      m.rig.board.world().schedule(sim::Pin::estop, true, m.rig.board.now());
    m.host.run_ms(200);
    m.rig.board.world().schedule(sim::Pin::estop, false, m.rig.board.now());
    m.host.run_ms(50);
    const StepPosition stood = m.loads();
    EXPECT_NE(stood[1], stood[side]);
    ASSERT_THAT(m.host.ask("$X\n$J=G91 X0.1 Y-0.5 F600\n", 2), testing::Contains("ok").Times(2));
    m.host.run_ms(300);
    EXPECT_EQ(m.loads()[1], stood[1] - 100);
    EXPECT_EQ(m.loads()[side], stood[side] - 100);
  }
}

/// Also if both have waited for room for answers.
TEST(Events, ALineAfterHomingWaitsForIt) {
  MachineWithSwitches m(homing_profile(), {});
  m.host.ask("$X\nG0 X1\nG4 P0\n", 5);
  ASSERT_THAT(m.host.ask("$$\n$$\n$$\n$H\nG90 G0 X0\nG4 P0\n", 60),
              testing::Contains("ok").Times(6));
  EXPECT_THAT(m.host.status(), testing::HasSubstr("|MPos:0.000,49.000,49.000|"));
}

TEST(Events, OutputsWithoutMotionDoNotBlockTheProgram) {
  job::Profile profile = laser_profile();
  profile.settings.set_milli(Id::pin_map, 2000);
  Rig rig(profile);
  ProgramHost host(rig);
  std::string text = "G90 G1 F6000\n";
  for (int i = 0; i < 50; ++i) text += i % 2 == 0 ? "M62 P0\nG1 X0\n" : "M63 P0\nG1 X0\n";
  ASSERT_TRUE(host.stream(text + "M62 P0\nG1 X1\n", 10));
  EXPECT_TRUE(rig.board.bus().level(sim::Pin::aux_out));
}

}  // namespace
}  // namespace lamplock::test::pairs_of_events_test
