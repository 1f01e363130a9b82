// E-stop, limit switches, door and reset during programs, jogs, dwells and pauses and at rest:
// light and motion end, the state is right, every line is answered once, and later commands are
// obeyed.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "tests/board/board_cable.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::program_safety_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr std::int32_t steps_per_mm = 200;
constexpr std::uint8_t reset_byte = 0x18, jog_cancel_byte = 0x85;

/// A board with a continuous laser, and a host.
class ProgramSafety : public testing::Test {
 protected:
  ProgramSafety() {
    profile_.settings.set_milli(Id::laser_mode, 1000);
    set_up();
  }
  void set_up() {
    host_.reset();
    rig_ = std::make_unique<Rig>(profile_);
    host_ = std::make_unique<ProgramHost>(*rig_, ProgramHost::Banner::kept);
    host_->run_ms(5);
  }
  void TearDown() override { expect_sound_wire(); }
  void expect_sound_wire() {
    EXPECT_EQ(host_->fault(), "");
    EXPECT_FALSE(rig_->board.controller().runner().generator().underrun());
    EXPECT_EQ(rig_->shots().size(), 0u);
  }

  void set(sim::Pin pin, bool level) {
    rig_->board.world().schedule(pin, level, rig_->board.now());
    host_->run_ms(2);
  }
  bool shines() const { return rig_->board.world().beam().at(rig_->board.now()).shines(); }
  std::int32_t x() const { return host_->position()[0]; }
  std::string state() {
    const std::string report = host_->status();
    return report.substr(1, report.find('|') - 1);
  }
  /// For `ms` nothing moves and the laser is dark.
  void expect_quiet(double ms) {
    const StepPosition stood = host_->position();
    const sim::Picoseconds from = rig_->board.now();
    host_->run_ms(ms);
    EXPECT_EQ(host_->position(), stood);
    EXPECT_FALSE(rig_->monitor.stepped(from, rig_->board.now()));
    EXPECT_FALSE(rig_->board.world().beam().shone(from, rig_->board.now()));
  }
  /// The machine obeys: a relative move ends where it should.
  void expect_obeys() {
    const StepPosition before = host_->position();
    const std::size_t answers = host_->answers().size();
    const int way = before[0] > 0 ? -1 : 1;
    host_->send(fmt::format("G21 G91 G94 G1 X{} F3000\n", way));
    ASSERT_TRUE(host_->wait_for(answers + 1));
    EXPECT_EQ(host_->answers().back(), "ok");
    EXPECT_TRUE(host_->wait_for_rest(2));
    EXPECT_EQ(x(), before[0] + way * steps_per_mm);
    host_->run_ms(20);
    EXPECT_EQ(host_->answers().size(), answers + 1);
  }

  job::Profile profile_ = lamp_profile(100, settings::LampMode::free_beat);
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<ProgramHost> host_;
};

std::size_t lines_in(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string many(std::string_view line, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line;
  return text;
}

/// Programs and jogs that are interrupted.
std::vector<std::string> scripts() {
  return {"M3 S1000\nG1 X40 F1200\n",
          "M3 S1000\nG1 X40 F600\nM0\nG1 X0\n",
          "M4 S500\nG1 X40 F600\nG4 P1\nG1 X0\n",
          "G1 X5 F6000\nM0\n",
          "M0\nG1 X5 F600\n",
          "G4 P3\nG1 X1 F600\n",
          "G1 X40 F600\nM30\nG1 X0\n",
          "G91 M3 S800 F60\n" + many("G1X.03\nG1Y.03\n", 65),
          "G2 X0 Y0 I20 F1200 M3 S300\nG1 X5\n",
          "$J=G91 X40 F1200\n$J=G91 Y5 F600\n",
          "$J=G91 X40 F1200\n" + many("$J=G91 X-.1 F60\n", 50),
          "(nothing)\n"};
}

class ProgramAlarm : public ProgramSafety, public testing::WithParamInterface<sim::Pin> {};

TEST_P(ProgramAlarm, EndsEverythingAndAnswersEveryLine) {
  std::mt19937 random(3);
  for (const std::string& script : scripts()) {
    for (const double ms : {3.0, 60.0, std::uniform_real_distribution<>(80, 900)(random)}) {
      SCOPED_TRACE(testing::Message() << script.substr(0, 60) << " after " << ms << " ms");
      set_up();
      host_->send(script);
      host_->run_ms(ms);
      set(GetParam(), true);
      const bool estop = GetParam() == sim::Pin::estop;
      const MachineState locked = estop ? MachineState::estop : MachineState::alarm;
      EXPECT_FALSE(shines());
      EXPECT_EQ(rig_->state(), locked);
      EXPECT_EQ(rig_->board.controller().outputs().laser_enable, false);
      EXPECT_EQ(rig_->board.bus().level(sim::Pin::enable), !estop);
      expect_quiet(100);
      EXPECT_EQ(rig_->state(), locked);
      EXPECT_THAT(state(), StartsWith("Alarm"));
      EXPECT_EQ(host_->count(Said::alarm), 1u);
      EXPECT_TRUE(host_->has_said(estop ? "ALARM:10" : "ALARM:1"));
      EXPECT_EQ(host_->answers().size(), lines_in(script));
      host_->send("~");
      expect_quiet(20);
      EXPECT_EQ(rig_->state(), locked);
      EXPECT_THAT(host_->ask("G1 X1 F600\n$J=X1 F600\n"), ElementsAre("error:9", "error:9"));
      set(GetParam(), false);
      EXPECT_THAT(host_->ask("$X\n"), Contains("ok"));
      EXPECT_THAT(state(), StartsWith("Idle"));
      expect_quiet(20);
      expect_obeys();
      EXPECT_EQ(host_->answers().size(), lines_in(script) + 4);
      expect_sound_wire();
    }
  }
}

/// The line that waits for the planner is answered with the lock's error because it never runs.
TEST_P(ProgramAlarm, NoLineIsAnsweredAsRunThatIsNot) {
  host_->send("G1 X40 F600\nM0\n");
  host_->run_ms(100);
  EXPECT_THAT(host_->answers(), ElementsAre("ok"));
  set(GetParam(), true);
  host_->run_ms(10);
  EXPECT_THAT(host_->answers(), ElementsAre("ok", "error:9"));
}

TEST_P(ProgramAlarm, OccursWhileAResetBrakes) {
  host_->send("G1 X40 F6000\nG1 X0\n");
  host_->run_ms(150);
  host_->send(reset_byte);
  host_->run_ms(10);
  ASSERT_EQ(host_->count(Said::banner), 1u) << "still braking";
  set(GetParam(), true);
  expect_quiet(50);
  EXPECT_EQ(host_->count(Said::banner), 2u);
  EXPECT_EQ(host_->count(Said::alarm), 1u);
  set(GetParam(), false);
  EXPECT_THAT(host_->ask("$X\n"), Contains("ok"));
  host_->send(reset_byte);
  host_->run_ms(20);
  EXPECT_EQ(host_->count(Said::banner), 3u);
  EXPECT_FALSE(host_->has_said("ALARM:3"));
  EXPECT_EQ(state(), "Idle");
  expect_obeys();
}

INSTANTIATE_TEST_SUITE_P(Inputs, ProgramAlarm,
                         testing::Values(sim::Pin::estop, sim::Pin::limit_x, sim::Pin::limit_z));

/// The door is opened before a program begins.
TEST_F(ProgramSafety, NothingBeginsWhileTheDoorIsOpen) {
  for (const char* script :
       {"M3 S1000\nG1 X40 F1200\n", "G0 X40\n", "G4 P0.2\nM3 S500\nG1 X40 F1200\n",
        "G2 X40 Y0 I20 F1200 M4 S1000\n"}) {
    SCOPED_TRACE(script);
    set_up();
    set(sim::Pin::door, true);
    host_->send(script);
    expect_quiet(400);
    EXPECT_EQ(state(), "Door:1");
    host_->send("~");
    expect_quiet(50);
    EXPECT_EQ(state(), "Door:1");
    set(sim::Pin::door, false);
    expect_quiet(50);
    EXPECT_EQ(state(), "Door:0");
    host_->send("~");
    ASSERT_TRUE(host_->wait_for(lines_in(script)));
    EXPECT_TRUE(host_->wait_for_rest(5));
    EXPECT_THAT(host_->answers(), AllOf(SizeIs(lines_in(script)), Each("ok")));
    EXPECT_EQ(x(), 40 * steps_per_mm);
    EXPECT_EQ(state(), "Idle");
    expect_sound_wire();
  }
}

TEST_F(ProgramSafety, NoJogWhileTheDoorIsOpen) {
  set(sim::Pin::door, true);
  EXPECT_THAT(host_->ask("$J=G91 X5 F1200\n"), ElementsAre("error:13"));
  expect_quiet(50);
  EXPECT_EQ(state(), "Idle");
  set(sim::Pin::door, false);
  EXPECT_THAT(host_->ask("$J=G91 X5 F1200\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_->wait_for_rest(2));
  EXPECT_EQ(x(), 5 * steps_per_mm);
}

TEST_F(ProgramSafety, NoUnlockWhileTheDoorIsOpen) {
  host_->send("M3 S1000\nG1 X40 F1200\n");
  host_->run_ms(200);
  set(sim::Pin::limit_x, true);
  set(sim::Pin::limit_x, false);
  set(sim::Pin::door, true);
  EXPECT_THAT(host_->ask("$X\n"), ElementsAre("error:13"));
  EXPECT_EQ(state(), "Alarm");
  EXPECT_THAT(host_->ask("G1 X10\n"), ElementsAre("error:9"));
  expect_quiet(100);
  set(sim::Pin::door, false);
  EXPECT_THAT(host_->ask("$X\n"), ElementsAre("[MSG:Caution: Unlocked]", "ok"));
  EXPECT_EQ(state(), "Idle");
  EXPECT_THAT(host_->ask("$X\n"), ElementsAre("ok"));
}

/// The door opens and closes at random moments; `~` does nothing while it is open.
TEST_F(ProgramSafety, AProgramResumesAfterTheDoorIsClosed) {
  std::mt19937 random(11);
  const std::string script =
      "G21 G90 M3 S800\nG1 X10 F3000\nG4 P0.1\nG1 X20\nG3 X20 Y20 J10 I0\nM4\nG1 X0\nM5\nG0 X0 Y0\n"
      "G1 X3 F600\nM30\n";
  for (int i = 0; i < scaled(40); ++i) {
    SCOPED_TRACE(testing::Message() << "run " << i);
    set_up();
    host_->send(script);
    for (int doors = 0; doors < 3; ++doors) {
      host_->run_ms(std::uniform_real_distribution<>(1, 700)(random));
      const bool runs = rig_->state() == MachineState::run;
      set(sim::Pin::door, true);
      EXPECT_FALSE(shines());
      host_->run_ms(std::uniform_real_distribution<>(0, 200)(random));
      EXPECT_FALSE(shines());
      host_->send("~");
      host_->run_ms(250);
      if (runs) {
        EXPECT_EQ(state(), "Door:1");
      }
      expect_quiet(20);
      set(sim::Pin::door, false);
      expect_quiet(20);
      if (runs) {
        EXPECT_EQ(state(), "Door:0");
      }
      host_->send("~");
    }
    ASSERT_TRUE(host_->wait_for(lines_in(script), 20));
    ASSERT_TRUE(host_->wait_for_rest(5));
    EXPECT_THAT(host_->answers(), AllOf(SizeIs(lines_in(script)), Each("ok")));
    EXPECT_EQ(host_->position(), (StepPosition{3 * steps_per_mm, 0, 0, 0}));
    EXPECT_EQ(state(), "Idle");
    expect_sound_wire();
  }
}

/// While the door is open, a pause and a dwell do not end, and the report shows the door.
TEST_F(ProgramSafety, ADoorInADwellAndInAPause) {
  host_->send("G1 X1 F6000\nG4 P0.2\nM0\nG1 X2\n");
  host_->run_ms(150);
  set(sim::Pin::door, true);
  host_->run_ms(400);
  EXPECT_EQ(state(), "Door:1");
  EXPECT_THAT(host_->answers(), SizeIs(1));
  set(sim::Pin::door, false);
  host_->send("~");
  host_->run_ms(50);
  EXPECT_EQ(state(), "Hold:0") << "the pause";
  EXPECT_THAT(host_->answers(), SizeIs(2));
  set(sim::Pin::door, true);
  EXPECT_EQ(state(), "Door:1");
  host_->send("~");
  expect_quiet(50);
  set(sim::Pin::door, false);
  EXPECT_EQ(state(), "Door:0");
  expect_quiet(50);
  host_->send("~");
  ASSERT_TRUE(host_->wait_for(4));
  ASSERT_TRUE(host_->wait_for_rest(2));
  EXPECT_EQ(x(), 2 * steps_per_mm);
  // M0 at an open door.
  set(sim::Pin::door, true);
  host_->send("M0\n");
  host_->run_ms(20);
  EXPECT_EQ(state(), "Door:1");
  set(sim::Pin::door, false);
  EXPECT_EQ(state(), "Door:0");
  host_->send("~");
  ASSERT_TRUE(host_->wait_for(5));
  host_->run_ms(5);
  EXPECT_EQ(state(), "Idle");
}

/// A pause after a dwell that was held is still a pause.
TEST_F(ProgramSafety, AHoldDoesNotSkipAPause) {
  host_->send("G4 P0.1\nM0\nG1 X1 F600\n");
  host_->run_ms(50);
  host_->send("!");
  host_->run_ms(200);
  EXPECT_EQ(state(), "Hold:0");
  host_->send("~");
  host_->run_ms(200);
  EXPECT_EQ(state(), "Hold:0");
  EXPECT_THAT(host_->answers(), SizeIs(1));
  host_->send("~");
  ASSERT_TRUE(host_->wait_for(3));
  ASSERT_TRUE(host_->wait_for_rest(2));
  EXPECT_EQ(x(), steps_per_mm);
}

TEST_F(ProgramSafety, ADoorCancelsAJog) {
  for (const bool cancelled : {false, true}) {
    set_up();
    host_->send("$J=G91 X40 F3000\n");
    host_->run_ms(200);
    set(sim::Pin::door, true);
    if (cancelled) host_->send(jog_cancel_byte);
    host_->run_ms(200);
    const std::int32_t stood = x();
    EXPECT_GT(stood, 0);
    EXPECT_LT(stood, 30 * steps_per_mm);
    EXPECT_EQ(state(), "Idle");
    EXPECT_THAT(host_->ask("$J=G91 X5 F1200\n"), ElementsAre("error:13"));
    expect_quiet(100);
    set(sim::Pin::door, false);
    expect_quiet(50);
    EXPECT_THAT(host_->ask("$J=G91 X5 F1200\n"), ElementsAre("ok"));
    ASSERT_TRUE(host_->wait_for_rest(2));
    EXPECT_EQ(x(), stood + 5 * steps_per_mm);
  }
}

/// The reset ends where the machine comes to rest, whether or not the door is open.
TEST_F(ProgramSafety, ADoorWhileAResetBrakes) {
  host_->send("M3 S1000\nG1 X40 F6000\nG1 X0\n");
  host_->run_ms(150);
  host_->send(reset_byte);
  host_->run_ms(2);
  set(sim::Pin::door, true);
  host_->run_ms(300);
  EXPECT_EQ(host_->count(Said::banner), 2u);
  EXPECT_TRUE(host_->has_said("ALARM:3"));
  EXPECT_EQ(state(), "Alarm");
  set(sim::Pin::door, false);
  EXPECT_THAT(host_->ask("$X\n"), Contains("ok"));
  expect_obeys();
}

TEST_F(ProgramSafety, AResetAtAnOpenDoorLeavesNothing) {
  host_->send("G1 X40 F6000\nG1 X0\n");
  host_->run_ms(150);
  set(sim::Pin::door, true);
  host_->run_ms(300);
  host_->send(reset_byte);
  host_->run_ms(50);
  EXPECT_EQ(host_->count(Said::banner), 2u);
  EXPECT_EQ(state(), "Idle");
  set(sim::Pin::door, false);
  host_->send("~");
  expect_quiet(100);
  expect_obeys();
}

/// A cancel and the next jog in one write: the jog begins where the machine has come to rest.
TEST_F(ProgramSafety, AJogAfterACancelBeginsWhereTheMachineStopped) {
  host_->send("$J=G91 X45 F3000\n");
  host_->run_ms(400);
  const std::int32_t at_cancel = x();
  host_->send("\x85$J=G91 X-5 F3000\n");
  ASSERT_TRUE(host_->wait_for(2));
  ASSERT_TRUE(host_->wait_for_rest(3));
  EXPECT_THAT(host_->answers(), AllOf(SizeIs(2), Each("ok")));
  // Braking from 50 mm/s at 2 m/s2 and the ticks handed out: some millimetres.
  EXPECT_GT(x(), at_cancel - 5 * steps_per_mm);
  EXPECT_LT(x(), at_cancel);
  expect_obeys();
}

/// Jogs that were waiting at the cancel are dropped; jogs sent later run.
TEST_F(ProgramSafety, JogsSentAfterACancelAreNew) {
  const std::string jogs = many("$J=G91X.1F60\n", 240);
  std::size_t sent = 0;
  while (sent < jogs.size()) {
    sent += host_->send_some(std::string_view(jogs).substr(sent, 13 * 20));
    host_->run_ms(10);
  }
  ASSERT_TRUE(rig_->board.controller().reader().lines_wait());
  const std::int32_t at_cancel = x();
  host_->send("\x85$J=G91 Y5 F3000\n");
  ASSERT_TRUE(host_->wait_for(241, 5));
  ASSERT_TRUE(host_->wait_for_rest(3));
  EXPECT_THAT(host_->answers(), AllOf(SizeIs(241), Each("ok")));
  EXPECT_EQ(host_->position()[1], 5 * steps_per_mm);
  EXPECT_NEAR(x(), at_cancel, steps_per_mm);
}

/// A start-up line that leaves the work space raises an alarm; it has no answer of its own, and the
/// next line is answered once.
TEST_F(ProgramSafety, AStartUpLineOutsideCostsNoAnswer) {
  EXPECT_THAT(host_->ask("$N0=G0 X40\n"), Contains("ok"));
  ASSERT_TRUE(host_->wait_for_rest(5));
  EXPECT_THAT(host_->ask("G10 L2 P1 X30\n"), Contains("ok"));
  const std::size_t answers = host_->answers().size();
  host_->send(reset_byte);
  host_->run_ms(50);
  EXPECT_TRUE(host_->has_said(">G0 X40:ok"));
  EXPECT_TRUE(host_->has_said("ALARM:2"));
  EXPECT_EQ(host_->answers().size(), answers);
  EXPECT_THAT(host_->ask("$X\n"), Contains("ok"));
  EXPECT_THAT(host_->ask("G10 L2 P1 X0\n"), ElementsAre("ok"));
  expect_obeys();
}

TEST_F(ProgramSafety, AStartUpLineIsKeptOnceItHasRun) {
  EXPECT_THAT(host_->ask("$N0=G21\n$N0=G0 X999\n"), Contains("error:33"));
  EXPECT_TRUE(host_->has_said("ALARM:2"));
  EXPECT_THAT(host_->ask("$X\n$N\n"), AllOf(Contains("$N0=G21"), Contains("$N1=")));
  host_->send("$N1=G4 P0.5\n");
  host_->run_ms(50);
  set(sim::Pin::limit_x, true);
  set(sim::Pin::limit_x, false);
  EXPECT_THAT(host_->ask("$X\n$N\n"), AllOf(Contains("$N0=G21"), Contains("$N1=")));
  host_->send("$N1=G4 P5\n");
  host_->run_ms(50);
  host_->send(reset_byte);
  host_->run_ms(50);
  EXPECT_THAT(host_->ask("$N\n"), AllOf(Contains("$N0=G21"), Contains("$N1=")));
  EXPECT_THAT(host_->ask("$N1=G4 P0.1\n$N\n"), ElementsAre("ok", "$N0=G21", "$N1=G4 P0.1", "ok"));
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_THAT(host_->ask("$N1=\n$N\n"), ElementsAre("ok", "$N0=G21", "$N1=", "ok"));
}

/// Start-up lines run before the host's lines, however long they take; no job starts in between.
TEST_F(ProgramSafety, StartUpLinesComeFirst) {
  EXPECT_THAT(host_->ask("$N0=G4 P0.2\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_THAT(host_->ask("$N1=G91 G0 X1\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_->wait_for_rest());
  const std::size_t heard = host_->said().size();
  host_->send("\x18G1 X5 F600\n");
  ASSERT_TRUE(host_->wait_for(3, 2));
  ASSERT_TRUE(host_->wait_for_rest(5));
  EXPECT_THAT(host_->said_from(heard),
              ElementsAre("Grbl 1.1h ['$' for help]", ">G4 P0.2:ok", ">G91 G0 X1:ok", "ok"));
  EXPECT_EQ(x(), 7 * steps_per_mm);
  const job::Job job = job::make_job({{1, 0, 0}}, profile_, {});
  host_->send(reset_byte);
  EXPECT_ANY_THROW(run_job(*rig_, job));
  rig_->run(ps_per_s);
  EXPECT_EQ(x(), 8 * steps_per_mm);
}

/// The answers to a reset and the banner wait for rest.
TEST_F(ProgramSafety, AResetWhileAStoppedJobBrakes) {
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(testing::Message() << "run " << i);
    set_up();
    const job::Job job = job_for(wild_points(20, 5), profile_, JoinMode::start_stop);
    BoardCable cable(*rig_);
    link::SenderOptions options;
    options.session = 1;
    link::JobSender sender(cable, job, options);
    const sim::Picoseconds at = (300 + 17 * i) * ps_per_ms;
    while (rig_->board.now() < at && sender.step()) {
    }
    sender.stop();
    while (rig_->board.controller().job_mark().session != 0 && sender.step()) {
    }
    cable.type("\x18");
    for (int n = 0; n < 1000; ++n) {
      rig_->run(250 * ps_per_us);
      const bool rests = rig_->board.controller().runner().at_rest();
      ASSERT_TRUE(rests || rig_->state() != MachineState::idle);
    }
    EXPECT_EQ(rig_->state(), MachineState::idle);
    const std::size_t shots = rig_->shots().size();
    EXPECT_EQ(rig_->status().first_unfired, shots);
    host_->run_ms(300);
    EXPECT_EQ(rig_->shots().size(), shots);
  }
  set_up();
}

/// A hold at rest is a hold too: moves sent after it are held.
TEST_F(ProgramSafety, AHoldAtRestHoldsLaterMoves) {
  host_->ask("G90 G21\n");
  host_->send("!");
  host_->run_ms(5);
  EXPECT_EQ(state(), "Hold:0");
  host_->send("M3 S500\nG1 X5 F3000\nG4 P0.01\n");
  expect_quiet(200);
  EXPECT_EQ(state(), "Hold:0");
  host_->send("~");
  ASSERT_TRUE(host_->wait_for(4));
  ASSERT_TRUE(host_->wait_for_rest(2));
  EXPECT_EQ(x(), 5 * steps_per_mm);
  EXPECT_EQ(state(), "Idle");
  // A pause that is reached in a hold follows the hold.
  host_->send("!");
  host_->run_ms(5);
  host_->send("M0\n");
  host_->run_ms(50);
  host_->send("~");
  host_->run_ms(50);
  EXPECT_EQ(state(), "Hold:0");
  EXPECT_THAT(host_->answers(), SizeIs(4));
  host_->send("~");
  host_->run_ms(5);
  EXPECT_THAT(host_->answers(), SizeIs(5));
  EXPECT_EQ(state(), "Idle");
}

/// If a host polls without reading, reports are lost but answers are not.
TEST_F(ProgramSafety, ReportsLeaveRoomForAnswers) {
  const int runs = 200;
  for (int i = 0; i < runs; ++i) {
    host_->send(i % 2 == 0 ? "G4 P.002\n" : "M30\n");
    for (int n = 0; n < 12 + i % 3; ++n) {
      host_->send(many("?", 30 + i % 7));
      host_->run_ms(0.25);
    }
    host_->run_ms(10);
  }
  EXPECT_THAT(host_->answers(), AllOf(SizeIs(runs), Each("ok")));
  EXPECT_EQ(host_->count(Said::message), runs / 2u);
}

/// Program and jog wait for a cancelled jog: the program has not begun when the jog is read.
TEST_F(ProgramSafety, NoJogIntoAProgram) {
  host_->send("$J=G91 X-40 F3000\n");
  host_->run_ms(20);
  host_->send("\x85M3 S1000\nG1 X5 F1200\n$J=G91 X1 F600\nG4 P0\n");
  host_->run_ms(300);
  EXPECT_EQ(state(), "Run");
  EXPECT_TRUE(shines());
  ASSERT_TRUE(host_->wait_for(5));
  EXPECT_THAT(host_->answers(), ElementsAre("ok", "ok", "ok", "error:8", "ok"));
  ASSERT_TRUE(host_->wait_for_rest(2));
  EXPECT_EQ(x(), 5 * steps_per_mm);
  // All jogs of one packet are accepted.
  host_->send("$J=G91 X1 F600\n$J=G91 X1 F600\nG1 X0\n");
  ASSERT_TRUE(host_->wait_for(8));
  ASSERT_TRUE(host_->wait_for_rest(2));
  EXPECT_EQ(x(), 7 * steps_per_mm);
  EXPECT_EQ(host_->answers().back(), "error:9");
}

TEST_F(ProgramSafety, ReportsThatThereIsNoHoming) {
  EXPECT_THAT(host_->ask("$H\n$HX\n$HELP\n"), ElementsAre("error:5", "error:5", "error:3"));
}

}  // namespace
}  // namespace lamplock::test::program_safety_test
