// G-code programs on the virtual board: answers, end positions, durations, holds, overrides, jogs,
// resets and the limits of the work space.
#include <fmt/format.h>

#include <random>

#include "host/program/program_run.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::program_test {
namespace {

constexpr double steps_per_mm = 200;

StepPosition at_mm(double x, double y, double z = 0) {
  const auto steps = [](double mm) {
    return static_cast<std::int32_t>(std::lround(mm * steps_per_mm));
  };
  return {steps(x), steps(y), steps(z), 0};
}

class Program : public testing::Test {
 protected:
  void TearDown() override {
    const stepper::TickGenerator& generator = rig_.board.controller().runner().generator();
    EXPECT_FALSE(generator.underrun());
    EXPECT_EQ(rig_.shots().size(), shots_);
  }

  job::Profile profile_ = program_profile();
  Rig rig_{profile_};
  ProgramHost host_{rig_};
  std::size_t shots_ = 0;
};

TEST_F(Program, RunsToItsEndInTheTimeThatCheckPredicts) {
  const std::string program =
      "G21 G90\nG0 X10 Y5\nG1 X20 F3000\nG2 X30 Y15 I0 J10\nG1 Z-2 F600\nG91 G1 X-3.5 Y0.25\n"
      "G90 G0 X0 Y0 Z0\n";
  const auto plan = program_run::run_program(program, profile_.settings, 1);
  ASSERT_TRUE(plan.problems.empty());
  const auto begin = rig_.now();
  ASSERT_TRUE(host_.stream(program));
  EXPECT_THAT(host_.answers(), AllOf(SizeIs(7), Each("ok")));
  EXPECT_EQ(host_.position(), at_mm(0, 0));
  const double seconds = static_cast<double>(rig_.now() - begin) / 1e12;
  EXPECT_GE(seconds, plan.seconds());
  EXPECT_LE(seconds, plan.seconds() + 0.010);
  EXPECT_EQ(rig_.board.controller().program().starvations(), 0u);
}

TEST_F(Program, DwellsPausesAndEnds) {
  const auto begin = rig_.now();
  EXPECT_THAT(host_.ask("G1 X1 F6000\nG4 P0.5\nM0\n", 0.9), Contains("ok").Times(2));
  EXPECT_THAT(host_.status(), StartsWith("<Hold:0|MPos:1.000,"));
  EXPECT_GT(rig_.now() - begin, ps_per_s / 2);
  host_.send("~");
  host_.run_ms(2);
  EXPECT_EQ(host_.answers().size(), 3u);
  EXPECT_THAT(host_.ask("G1 X2\nM30\n"), ElementsAre("ok", "[MSG:Pgm End]", "ok"));
  EXPECT_EQ(host_.position(), at_mm(2, 0));
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
}

/// "Hold", "Idle" and the answer to a dwell are sent after the last step is out, not when it is
/// planned: a user who reacts finds the machine at its final position.
TEST_F(Program, WaitingForRestIncludesTheLastStep) {
  const StepPosition target = at_mm(1, 0), back = at_mm(0, 0);
  const auto steps = [this] { return rig_.board.world().drives().position(); };
  const auto run_until = [this](auto&& said) {
    for (int i = 0; i < 20'000 && !said(); ++i) host_.run(ps_per_ms / 20);
    EXPECT_TRUE(said());
  };
  host_.send("G1 X1 F6000\nM0\n");
  run_until([this] { return rig_.state() == MachineState::hold; });
  EXPECT_EQ(steps(), target);
  host_.send("~G1 X0\nG4 P0.001\n");
  run_until([this] { return host_.answers().size() == 4; });
  EXPECT_EQ(steps(), back);
  host_.send("G1 X1\nM2\n");
  run_until([this] { return host_.has_said("[MSG:Pgm End]"); });
  EXPECT_EQ(steps(), target);
  host_.send("G1 X0\n");
  host_.run_ms(5);
  run_until([this] { return rig_.state() == MachineState::idle; });
  EXPECT_EQ(steps(), back);
}

TEST_F(Program, HoldsAtAnyMomentAndEndsWhereItShould) {
  std::mt19937 random(7);
  for (int i = 0; i < static_cast<int>(scaled(20)); ++i) {
    Rig rig(profile_);
    ProgramHost host(rig);
    host.send("G1 X8 F9000\nG3 X0 Y16 I-8 J8\nG1 X-20 Y3\nX0 Y0\n");
    host.run_ms(std::uniform_real_distribution<>(1, 400)(random));
    host.send("!");
    host.run_ms(400);
    EXPECT_THAT(host.status(), StartsWith("<Hold:0|"));
    const StepPosition stood = host.position();
    host.run_ms(100);
    EXPECT_EQ(host.position(), stood);
    host.send("~");
    ASSERT_TRUE(host.wait_for_rest());
    EXPECT_EQ(host.position(), at_mm(0, 0));
    EXPECT_EQ(rig.board.controller().program().starvations(), 0u);
  }
}

TEST_F(Program, OverridesAreInForceWithin50Milliseconds) {
  host_.send("G1 X45 F3000\n");
  host_.run_ms(200);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:3000,"));
  for (int i = 0; i < 5; ++i) host_.send(std::uint8_t{0x92});  // -10 %
  host_.run_ms(48);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:1500,"));
  host_.send(std::uint8_t{0x90});
  host_.run_ms(70);
  EXPECT_THAT(host_.status(), HasSubstr("|FS:3000,"));
  host_.run_ms(20);
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(host_.position(), at_mm(45, 0));
}

TEST_F(Program, JogsAndCancels) {
  EXPECT_THAT(host_.ask("$J=G91 X5 F1200\n"), ElementsAre("ok"));
  host_.run_ms(50);
  EXPECT_THAT(host_.status(), StartsWith("<Jog|"));
  EXPECT_THAT(host_.ask("G1 X1 F100\n"), ElementsAre("error:9"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(host_.position(), at_mm(5, 0));
  EXPECT_THAT(host_.ask("$J=X200 F1200\n"), ElementsAre("error:15"));
  EXPECT_THAT(host_.ask("$J=X40 F6000\n"), ElementsAre("ok"));
  host_.run_ms(100);
  host_.send(std::uint8_t{0x85});
  host_.run_ms(200);
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
  const StepPosition stopped = host_.position();
  EXPECT_GT(stopped[0], at_mm(5, 0)[0]);
  EXPECT_LT(stopped[0], at_mm(30, 0)[0]);
  // The program continues from where the machine is.
  EXPECT_THAT(host_.ask("G91 G1 Y1 F600\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(host_.position(), (StepPosition{stopped[0], 200, 0, 0}));
}

TEST_F(Program, ResetInMotionStopsOnThePathAndLocks) {
  host_.send("G1 X40 Y20 F6000\nG1 X0 Y0\n");
  host_.run_ms(150);
  host_.send(std::uint8_t{0x18});
  host_.run_ms(400);
  EXPECT_TRUE(host_.has_said("ALARM:3"));
  EXPECT_TRUE(host_.has_said("Grbl 1.1h ['$' for help]"));
  EXPECT_THAT(host_.status(), StartsWith("<Alarm|"));
  const StepPosition stopped = host_.position();
  EXPECT_NEAR(stopped[0], 2 * stopped[1], 2);
  EXPECT_THAT(host_.ask("G1 X1\n$X\nG1 X0 Y0 F600\n"), Contains("error:9"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(host_.position(), at_mm(0, 0));
}

/// M49: feed and rapids are as programmed, whatever the user sets; M48, the end of the program and
/// a reset let the overrides act again.
TEST_F(Program, OverridesActOrNot) {
  const auto seconds = [&](const std::string& lines) {
    const auto begin = rig_.now();
    EXPECT_TRUE(host_.stream(lines));
    return static_cast<double>(rig_.now() - begin) / 1e12;
  };
  constexpr char faster = '\x91', rapid_25 = '\x97';
  const std::string there_and_back = "G1 X20 F1200\nG0 X0\n";
  const double plain = seconds("G21 G90 G1 X20 F1200\nG0 X0\n");
  for (int i = 0; i < 10; ++i) host_.send(std::string(1, faster));
  host_.send(std::string(1, rapid_25));
  const double changed = seconds(there_and_back);
  EXPECT_LT(changed, plain - 0.2);
  EXPECT_NEAR(seconds("M49\n" + there_and_back), plain, 0.01);
  EXPECT_NEAR(seconds("M48\n" + there_and_back), changed, 0.01);
  EXPECT_NEAR(seconds("M49\n" + there_and_back), plain, 0.01);
  EXPECT_NEAR(seconds("M70\nM48\n" + there_and_back), changed, 0.01);
  EXPECT_NEAR(seconds("M72\n" + there_and_back), plain, 0.01);
  // The end of a program ends M49 and the overrides, too.
  host_.ask("M2\n");
  host_.send(std::string(1, faster));
  EXPECT_LT(seconds(there_and_back), plain - 0.05);
}

TEST_F(Program, NeverLeavesTheWorkArea) {
  host_.send("G1 X10 F6000\nG1 X60\nG1 X0\n");
  host_.run_ms(1000);
  EXPECT_THAT(host_.answers(), ElementsAre("ok", "error:33", "error:9"));
  EXPECT_TRUE(host_.has_said("ALARM:2"));
  EXPECT_EQ(host_.position(), at_mm(10, 0));
}

TEST_F(Program, AcceptsNoMoreThanItsWindow) {
  std::string text;
  for (int i = 0; i < 4000; ++i) text += i % 2 == 0 ? "G1 X1.234 F600\n" : "G1 X-1.234 F600\n";
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  ASSERT_EQ(rig_.board.write({bytes, text.size()}), text.size());
  host_.run_ms(200);
  EXPECT_LT(rig_.board.controller().receive_room(), 20u);
}

/// M4: power is proportional to speed; no light in rapids and at rest.
TEST_F(Program, ScalesPowerWithSpeed) {
  EXPECT_THAT(host_.ask("$32=1\n"), ElementsAre("ok"));
  host_.send("M4 S500\nG0 X5\nG1 X25 F3000\nG0 X30\nM3 S250\nG1 X35 F600\nG4 P0.1\nM5\n");
  const auto begin = rig_.now();
  double highest = 0;
  for (int i = 0; i < 2000 && !(i > 100 && rig_.state() == MachineState::idle); ++i) {
    host_.run_ms(1);
    const sim::BeamChange beam = rig_.board.world().beam().at(rig_.now());
    const double mm = host_.position()[0] / steps_per_mm;
    const double power = beam.light() / 65535.0;
    highest = std::max(highest, power);
    // This is the position of the ticks handed out, some milliseconds ahead of the motion.
    const bool cuts = (mm > 6 && mm < 25) || (mm > 31 && mm < 35);
    const bool rests = mm < 4.9 || (mm > 25.5 && mm < 29.9);
    EXPECT_TRUE(!rests || power == 0) << power << " at " << mm;
    EXPECT_TRUE(!cuts || power > 0) << mm;
    EXPECT_TRUE(mm < 10 || mm > 20 || std::abs(power - 0.5) < 0.01) << power << " at " << mm;
    EXPECT_TRUE(mm < 31 || mm > 34 || std::abs(power - 0.25) < 0.01) << power << " at " << mm;
  }
  EXPECT_NEAR(highest, 0.5, 0.01);
  EXPECT_EQ(host_.position(), at_mm(35, 0));
  host_.run_ms(10);
  EXPECT_FALSE(rig_.board.world().beam().shone(rig_.now() - ps_per_ms, rig_.now()));
  // 20 mm at 50 mm/s and half power, 5 mm at 10 mm/s and a quarter.
  EXPECT_NEAR(rig_.board.world().beam().energy(begin, rig_.now()), 0.2 + 0.125, 0.005);
}

/// M4: whatever limits the speed, the light of a path is that of its programmed feed. Limits are
/// those of the axes, and of many short lines.
TEST_F(Program, ScalesPowerByTheProgrammedFeed) {
  EXPECT_THAT(host_.ask("$32=1\n"), ElementsAre("ok"));
  constexpr double feed_mm_s = 2000, power = 0.9, mm = 20;
  std::string zigzag;
  for (int i = 1; i <= 400; ++i)
    zigzag += "X" + std::to_string(0.05 * i) + (i % 2 != 0 ? " Y0.02\n" : " Y0\n");
  const double zigzag_mm = 400 * std::hypot(0.05, 0.02);
  for (const auto& [path, length] : {std::pair{std::string("X20\n"), mm}, {zigzag, zigzag_mm}}) {
    const auto begin = rig_.now();
    ASSERT_TRUE(host_.stream("G0 X0 Y0\nM4 S900 F120000\nG1 " + path + "M5\n"));
    host_.run_ms(20);
    const double light_s = power * length / feed_mm_s;
    EXPECT_NEAR(rig_.board.world().beam().energy(begin, rig_.now()), light_s, 0.03 * light_s);
  }
}

TEST_F(Program, TheLaserIsOffWhenTheDoorOpens) {
  EXPECT_THAT(host_.ask("$32=1\n"), ElementsAre("ok"));
  host_.send("M3 S1000\nG1 X40 F1200\n");
  host_.run_ms(300);
  EXPECT_TRUE(rig_.board.world().beam().at(rig_.now()).shines());
  rig_.set(sim::Pin::door, true);
  host_.run_ms(5);
  EXPECT_FALSE(rig_.board.world().beam().at(rig_.now()).shines());
  host_.run_ms(200);
  EXPECT_THAT(host_.status(), StartsWith("<Door:1|"));
}

TEST_F(Program, ReportsItsState) {
  EXPECT_THAT(host_.ask("$G\n"), ElementsAre("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]", "ok"));
  EXPECT_THAT(host_.ask("G10 L2 P1 X1 Y2\nG91 G20\n$#\n"), Contains("[G54:1.000,2.000,0.000]"));
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr("G20 G91")));
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
  EXPECT_THAT(host_.ask("$N0=G21 G90\n$N\n"), ElementsAre("ok", "$N0=G21 G90", "$N1=", "ok"));
  host_.run_ms(2);
  // A board that starts with the state that this board stored.
  sim::VirtualBoard next(rig_.board.stored_settings(), world_for(profile_),
                         rig_.board.kept_state());
  next.run_until(5 * ps_per_ms);
  EXPECT_EQ(next.controller().reader().kept().parameters.systems_e7[0][1], 20'000'000);
}

/// The tool is still mounted when the power returns.
TEST_F(Program, TheToolLengthOutlivesResetAndPowerCut) {
  host_.ask("G21 G90 G43.1 Z2.5\nG0 Z1\n");
  host_.run_ms(200);
  EXPECT_EQ(host_.position(), at_mm(0, 0, 3.5));
  host_.send("\x18");
  host_.run_ms(20);
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr(" G43.1 ")));
  EXPECT_THAT(host_.ask("$#\n"), Contains("[TLO:2.500]"));
  const auto tool_length_after = [&] {
    sim::VirtualBoard next(rig_.board.stored_settings(), world_for(profile_),
                           rig_.board.kept_state());
    next.run_until(5 * ps_per_ms);
    return next.controller().reader().interpreter().work_offset_e7()[2];
  };
  EXPECT_EQ(tool_length_after(), 25'000'000);
  host_.ask("G49\n");
  host_.run_ms(20);
  EXPECT_EQ(tool_length_after(), 0);
}

/// $RST=P does to parameters and saved modes what M2 does, and to nothing else.
TEST_F(Program, ParametersAreClearedByACommand) {
  host_.ask("G20 G91 T3 S7\n#1=40 #<wide>=3\nM70\n");
  const auto modes = host_.ask("$G\n");
  EXPECT_THAT(host_.ask("$RST=P\n"), ElementsAre("ok"));
  EXPECT_EQ(host_.ask("$G\n"), modes);
  EXPECT_THAT(host_.ask("(PRINT,%d#1)\n"), ElementsAre("[MSG:0]", "ok"));
  EXPECT_THAT(host_.ask("#2=#<wide>\n"), ElementsAre("error:74"));
  EXPECT_THAT(host_.ask("M72\n"), ElementsAre(StartsWith("error:")));
  EXPECT_THAT(host_.ask("G21 G90\n#1=4\nG1 X5 F600\n$RST=P\n"), Contains("error:8"));
  EXPECT_THAT(host_.ask("(PRINT,%d#1)\n"), ElementsAre("[MSG:4]", "ok"));
}

/// As the origins do, and $RST=# clears it at once.
TEST_F(Program, TheRotationOfASystemOutlivesResetAndPowerCut) {
  host_.ask("G10 L2 P1 X10 R90\nG0 X1 Y0\n");
  host_.run_ms(200);
  EXPECT_EQ(host_.position(), at_mm(10, 1));
  host_.send("\x18");
  host_.run_ms(20);
  EXPECT_THAT(host_.ask("$#\n"), Contains("[ROT:90,0,0,0,0,0,0,0,0]"));
  host_.ask("G0 X2\n");
  host_.run_ms(200);
  EXPECT_EQ(host_.position(), at_mm(10, 2));
  sim::VirtualBoard next(rig_.board.stored_settings(), world_for(profile_),
                         rig_.board.kept_state());
  next.run_until(5 * ps_per_ms);
  EXPECT_TRUE(next.controller().reader().interpreter().state().system_rotation.active());
  EXPECT_THAT(host_.ask("$RST=#\n$#\n"), Not(Contains(StartsWith("[ROT:"))));
  host_.ask("G0 X3\n");
  host_.run_ms(200);
  EXPECT_EQ(host_.position(), at_mm(3, 2));
}

/// Programs and jobs alternate; each begins where the other has left the machine.
TEST_F(Program, AndJobsTakeTurns) {
  const job::Job job = job::make_job({{1, 0, 0}, {1, 2, 0}, {3, 2, 0}}, profile_, {});
  for (const double x : {5.0, -7.0}) {
    host_.send(fmt::format("G90 G1 X{} Y1 F3000\n", x));
    host_.run_ms(20);
    EXPECT_ANY_THROW(run_job(rig_, job));
    ASSERT_TRUE(host_.wait_for_rest());
    EXPECT_EQ(host_.position(), at_mm(x, 1));
    const std::size_t before = rig_.shots().size();
    EXPECT_EQ(run_job(rig_, job, session(static_cast<std::uint32_t>(100 + x))).end, JobEnd::done);
    EXPECT_EQ(rig_.shots().size(), before + 3);
    EXPECT_THAT(host_.ask("G91 G1 X-0.5 F600\n"), Contains("ok"));
    ASSERT_TRUE(host_.wait_for_rest());
    EXPECT_EQ(host_.position(), at_mm(2.5, 2));
  }
  shots_ = 6;
}

TEST_F(Program, WakesFromSleepByAReset) {
  EXPECT_THAT(host_.ask("$SLP\nG1 X1 F100\n"), Contains("error:9"));
  EXPECT_THAT(host_.status(), StartsWith("<Sleep|"));
  EXPECT_FALSE(rig_.board.controller().outputs().drives_enable);
  host_.send(std::uint8_t{0x18});
  host_.run_ms(5);
  EXPECT_THAT(host_.status(), StartsWith("<Alarm|"));
}

}  // namespace
}  // namespace lamplock::test::program_test
