// E-stop, limit switches, door and reset in the middle of programs, jogs, dwells, pauses and at
// rest: light and motion end, the state is right, every line is answered once, and what the user
// says afterwards is heard.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "tests/board/board_cable.hpp"
#include "tests/board/wire_host.hpp"

namespace lamplock::test {
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
constexpr unsigned reset_byte = 0x18, jog_cancel_byte = 0x85;

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
    host_ = std::make_unique<WireHost>(*rig_);
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
  /// For so long nothing moves and no light leaves.
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
    EXPECT_TRUE(host_->stand(2));
    EXPECT_EQ(x(), before[0] + way * steps_per_mm);
    host_->run_ms(20);
    EXPECT_EQ(host_->answers().size(), answers + 1);
  }

  job::Profile profile_ = lamp_profile(100, settings::LampMode::free_beat);
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<WireHost> host_;
};

std::size_t lines_in(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::string many(std::string_view line, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line;
  return text;
}

/// What may be under way when something happens.
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
      EXPECT_TRUE(host_->heard(estop ? "ALARM:10" : "ALARM:1"));
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

/// The one that waits for the planner is answered as locked: it will not be run.
TEST_P(ProgramAlarm, NoLineIsAnsweredAsRunThatIsNot) {
  host_->send("G1 X40 F600\nM0\n");
  host_->run_ms(100);
  EXPECT_THAT(host_->answers(), ElementsAre("ok"));
  set(GetParam(), true);
  host_->run_ms(10);
  EXPECT_THAT(host_->answers(), ElementsAre("ok", "error:9"));
}

INSTANTIATE_TEST_SUITE_P(Inputs, ProgramAlarm,
                         testing::Values(sim::Pin::estop, sim::Pin::limit_x, sim::Pin::limit_z));
}  // namespace
}  // namespace lamplock::test
