// Parking at an open door: Z rises and returns in the dark, and the program ends at its place; a
// second opening, a reset or an e-stop on the way.
#include <fmt/format.h>

#include <random>

#include "tests/board/program_host.hpp"
#include "tests/judges/motion_judge.hpp"

namespace lamplock::test::parking_test {
namespace {

constexpr std::int32_t steps_per_mm = 200;
constexpr std::uint8_t reset_byte = 0x18;

class Parking : public testing::Test {
 protected:
  Parking() {
    settings::Values& s = profile_.settings;
    s.set_milli(Id::laser_mode, 1000);
    s.set_milli(Id::parking, 1000);
    s.set_milli(Id::parking_slow, 600'000);
    s.set_milli(Id::parking_fast, 6'000'000);
    s.set_milli(Id::parking_target, 30'000);
    set_up();
  }
  void set_up() {
    host_.reset();
    judge_.reset();
    rig_ = std::make_unique<Rig>(profile_);
    judge_ = std::make_unique<MotionJudge>(rig_->board, profile_.settings, true);
    host_ = std::make_unique<ProgramHost>(*rig_);
    host_->run_ms(5);
  }
  void set_door(bool open) {
    rig_->set(sim::Pin::door, open);
    host_->run_ms(1);
  }
  std::string state() {
    const std::string report = host_->status();
    return report.substr(1, report.find('|') - 1);
  }
  StepPosition loads() const { return rig_->board.world().drives().position(); }
  bool wait_for_state(std::string_view wanted, double seconds = 20) {
    for (int i = 0; i < seconds * 1000 && state() != wanted; ++i) host_->run_ms(1);
    return state() == wanted;
  }

  job::Profile profile_ = program_profile();
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<MotionJudge> judge_;
  std::unique_ptr<ProgramHost> host_;
};

TEST_F(Parking, GoesUpAndComesBack) {
  host_->send("M3 S1000\nG1 X20 Z-3 F1200\nG4 P0\n");
  host_->run_ms(600);
  set_door(true);
  EXPECT_EQ(state(), "Door:2");
  const auto opened = rig_->now();
  ASSERT_TRUE(wait_for_state("Door:1"));
  const StepPosition parked = loads();
  EXPECT_EQ(parked[2], 30 * steps_per_mm);
  set_door(false);
  EXPECT_EQ(state(), "Door:0");
  host_->run_ms(100);
  EXPECT_EQ(loads(), parked);
  host_->send("~");
  host_->run_ms(2);
  EXPECT_EQ(state(), "Door:3");
  ASSERT_TRUE(wait_for_state("Run"));
  EXPECT_FALSE(rig_->board.world().beam().shone(opened, rig_->now()));
  EXPECT_EQ(loads()[0], parked[0]);
  EXPECT_LT(loads()[2], 0);
  ASSERT_TRUE(host_->wait_for_rest());
  EXPECT_EQ(loads(), (StepPosition{20 * steps_per_mm, 0, -3 * steps_per_mm, 0}));
  EXPECT_THAT(host_->answers(), Each("ok"));
  EXPECT_EQ(judge_->fault(), "");
}

/// Z stays if it is already higher, or without $41.
TEST_F(Parking, OnlyUp) {
  host_->ask("G0 Z40\n", 5);
  host_->send("G1 X20 F1200\n");
  host_->run_ms(300);
  set_door(true);
  ASSERT_TRUE(wait_for_state("Door:1"));
  EXPECT_EQ(loads()[2], 40 * steps_per_mm);
  profile_.settings.set_milli(Id::parking, 0);
  set_up();
  host_->send("G1 X20 F1200\n");
  host_->run_ms(300);
  set_door(true);
  ASSERT_TRUE(wait_for_state("Door:1"));
  EXPECT_EQ(loads()[2], 0);
}

/// The door opens and closes at random moments, with and without a jerk limit: limits are kept, the
/// laser is dark with the door open or the tool up, and the program ends at its place.
TEST_F(Parking, DoorsAtRandomMoments) {
  std::mt19937_64 random(6);
  const Pick<double> ms(random);
  for (int round = 0; round < scaled(40); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    const bool jerk = round % 3 == 0;
    for (int a = 0; a < 3; ++a)
      profile_.settings.set_milli(settings::for_axis(Id::jerk_x, a), jerk ? 50'000 : 0);
    set_up();
    host_->send("M3 S1000\nG1 X10 Y3 Z-1 F1200\nG2 X10 Y-3 J-3 I0 F900\nG1 X0 Y0 Z0.005\nG4 P0\n");
    for (int doors = 0; doors < 4; ++doors) {
      host_->run_ms(ms(600));
      set_door(true);
      const auto opened = rig_->now();
      host_->run_ms(ms(900));
      EXPECT_FALSE(rig_->board.world().beam().shone(opened, rig_->now()));
      set_door(false);
      host_->send("~");
      host_->run_ms(ms(900));
    }
    // The door may have opened on the way back.
    for (int i = 0; i < 20 && host_->answers().size() < 5; ++i) {
      host_->send("~");
      host_->run_ms(1000);
    }
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(loads(), (StepPosition{0, 0, 1, 0}));
    EXPECT_THAT(host_->answers(), Each("ok"));
    EXPECT_EQ(judge_->fault(), "");
    EXPECT_EQ(rig_->board.controller().program().starvations(), 0u);
  }
}

/// With a jerk limit, braking while Z accelerates takes longer than the planned braking: aborted at
/// any moment, Z stays in its work space.
TEST_F(Parking, AbortedAnywhereItStaysInsideTheWorkArea) {
  std::mt19937_64 random(8);
  const Pick<double> ms(random);
  constexpr std::int32_t top = 50 * steps_per_mm;
  profile_.settings.set_milli(Id::parking_target, 50'000);
  profile_.settings.set_milli(Id::parking_pull_out, 1'000);
  profile_.settings.set_milli(Id::jerk_z, 20'000);
  for (int round = 0; round < scaled(60); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    set_up();
    host_->send("G0 Z49\nM3 S100\nG1 X5 F600\n");
    host_->run_ms(3000);
    set_door(true);
    for (int i = 0; i < 4; ++i) {
      host_->run_ms(ms(300));
      set_door(false);
      host_->send(i % 2 == 0 ? "~" : "!");
      host_->run_ms(ms(300));
      if (i == 3) host_->send(std::uint8_t{reset_byte});
      set_door(true);
    }
    for (int i = 0; i < 400; ++i) {
      host_->run_ms(1);
      ASSERT_LE(loads()[2], top);
    }
    EXPECT_EQ(judge_->fault(), "");
  }
}

/// The door opens, closes and, after a resume, opens again while the program still brakes: it comes
/// to rest on its path and parks once.
TEST_F(Parking, ADoorThatOpensAgainWhileTheProgramBrakes) {
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    set_up();
    host_->send("G1 X10 Y5 Z-1 F6000\nG1 X0 Y0 Z0\nG4 P0\n");
    host_->run_ms(60);
    set_door(true);
    host_->run_ms(round);
    set_door(false);
    host_->send("~");
    host_->run_ms(round % 3);
    set_door(true);
    ASSERT_TRUE(wait_for_state("Door:1"));
    EXPECT_EQ(loads()[2], 30 * steps_per_mm);
    EXPECT_NEAR(loads()[0], 2 * loads()[1], 1);
    set_door(false);
    host_->send("~");
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(loads(), (StepPosition{}));
    EXPECT_EQ(rig_->board.controller().program().starvations(), 0u);
    EXPECT_EQ(judge_->fault(), "");
  }
}

TEST_F(Parking, ResetAndEstopOnTheWay) {
  std::mt19937_64 random(8);
  for (int round = 0; round < scaled(20); ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    set_up();
    host_->send("G1 X10 Z-1 F1200\nG1 X0\n");
    host_->run_ms(200);
    set_door(true);
    host_->run_ms(static_cast<double>(random() % 700));
    if (round % 2 == 0)
      host_->send(reset_byte);
    else
      rig_->set(sim::Pin::estop, true);
    host_->run_ms(2000);
    const StepPosition stood = loads();
    host_->run_ms(200);
    EXPECT_EQ(loads(), stood);
    EXPECT_EQ(host_->position(), stood);
    if (round % 2 != 0) {
      EXPECT_THAT(host_->said(), Contains("ALARM:10"));
    }
    EXPECT_THAT(state(), AnyOf(StartsWith("Alarm"), StartsWith("Idle")));
    // It works on: no motion that was broken off leaves it busy.
    rig_->set(sim::Pin::estop, false);
    set_door(false);
    host_->run_ms(100);
    host_->ask("$X\n");
    EXPECT_THAT(host_->ask("G91 G1 X1 F1200\n"), Contains("ok"));
    ASSERT_TRUE(host_->wait_for_rest());
    EXPECT_EQ(host_->position()[0] - stood[0], 200);
  }
}

}  // namespace
}  // namespace lamplock::test::parking_test
