// $981: after an error in a program line the board accepts no further line until `~` or a reset;
// also the bytes that switch flood and mist by hand.

#include "tests/board/program_host.hpp"

namespace lamplock::test::stop_at_error_test {
namespace {

constexpr std::uint8_t reset_byte = 0x18, flood_byte = 0xa0, mist_byte = 0xa1;

class ErrorsInPrograms : public testing::Test {
 protected:
  std::int32_t x() {
    host_.run_ms(5);  // until the ticks handed out are over
    return rig_.board.world().drives().position()[0];
  }

  job::Profile profile_ = program_profile();
  Rig rig_{profile_};
  ProgramHost host_{rig_};
};

TEST_F(ErrorsInPrograms, AreNoReasonToStopByDefault) {
  ASSERT_TRUE(host_.stream("G1 X1 F6000\nG1 X2 Q1\nG1 X3\n"));
  EXPECT_THAT(host_.answers(), ElementsAre("ok", "error:36", "ok"));
  EXPECT_EQ(x(), 600);
}

TEST_F(ErrorsInPrograms, StopTheStreamIfSet) {
  EXPECT_THAT(host_.ask("$981=1\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.stream("G1 X1 F6000\nX2\nG1 X3 Q1\nG1 X4\n$G\n\nM3 S5\n"));
  // Accepted lines run to their end; input other than program lines is answered as usual.
  EXPECT_THAT(host_.answers(),
              ElementsAre("ok", "ok", "ok", "error:36", "error:9", "ok", "ok", "error:9"));
  EXPECT_THAT(host_.said(), Contains(StartsWith("[MSG:Stopped at an error")));
  EXPECT_EQ(x(), 400);
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
  EXPECT_THAT(host_.ask("G0 X0\n"), ElementsAre("error:9"));
  EXPECT_THAT(host_.ask("$X\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.stream("G0 X0\n"));
  EXPECT_EQ(x(), 0);
  // The next error stops again; a reset of a machine at rest clears that state too.
  EXPECT_THAT(host_.ask("G1\nG0 X1\n"), ElementsAre("ok", "ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_THAT(host_.ask("G99999\nG0 X2\n"), Contains("error:9"));
  host_.send(reset_byte);
  host_.run_ms(5);
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
  ASSERT_TRUE(host_.stream("G0 X3\n"));
  EXPECT_EQ(x(), 600);
}

TEST_F(ErrorsInPrograms, LeaveTheLaserOff) {
  EXPECT_THAT(host_.ask("$981=1\n$32=1\n"), Each("ok"));
  ASSERT_TRUE(host_.stream("M3 S1000\nG1 X5 F6000\nG1 X6 H\nG1 X40\n"));
  EXPECT_EQ(x(), 1000);
  const sim::Beam& beam = rig_.board.world().beam();
  EXPECT_TRUE(beam.shone(0, rig_.now()));
  const auto from = rig_.now();
  host_.send("G1 X30\nS500\n");
  host_.run_ms(500);
  EXPECT_FALSE(beam.shone(from, rig_.now()));
}

/// A line that is too long counts as a lost program line.
TEST_F(ErrorsInPrograms, CountLinesThatAreTooLong) {
  EXPECT_THAT(host_.ask("$981=1\n"), ElementsAre("ok"));
  EXPECT_THAT(host_.ask("G0 X1" + std::string(300, ' ') + "Y1\nG0 X2\n"),
              ElementsAre("error:11", HasSubstr("Stopped"), "error:9"));
}

/// Errors of commands, jogs and check mode do not stop a stream.
TEST_F(ErrorsInPrograms, AreNotThoseOfCommands) {
  EXPECT_THAT(host_.ask("$981=1\n"), ElementsAre("ok"));
  EXPECT_THAT(host_.ask("$Q\n$981=7\n$J=X1\n$N0=G99999\n$N0=\nG0 X1\n"), Contains("ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(x(), 200);
  EXPECT_THAT(host_.ask("$C\nG99999\nG0 X1\n"),
              ElementsAre("[MSG:Enabled]", "ok", testing::_, "ok"));
}

TEST_F(ErrorsInPrograms, StopPointsOnTheBeatAfterAcceptedOnes) {
  EXPECT_THAT(host_.ask("$981=1\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.stream("M130 P0\nG1 X1 F6000\nX2\nX3 Q1\nX4\n"));
  EXPECT_EQ(rig_.shots().size(), 2u);
  EXPECT_EQ(x(), 400);
}

TEST_F(ErrorsInPrograms, CoolantIsSwitchedByHand) {
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr(" M9 ")));
  host_.send(flood_byte);
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr(" M8 ")));
  EXPECT_THAT(host_.status(), HasSubstr("|A:F"));
  host_.send(mist_byte);
  EXPECT_THAT(host_.status(), HasSubstr("|A:FM"));
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr(" M7 M8 ")));
  host_.send(flood_byte);
  const std::string status = host_.status();
  EXPECT_THAT(status, HasSubstr("|A:M"));
  EXPECT_THAT(host_.ask("M9\n$G\n"), Contains(HasSubstr(" M9 ")));
  EXPECT_THAT(host_.status(), Not(HasSubstr("|A:")));
  // By hand in motion and in a hold too, but not in an alarm, which switched both off.
  host_.send("G1 X20 F1200\n");
  host_.run_ms(50);
  host_.send(mist_byte);
  host_.send("!");
  host_.run_ms(200);
  host_.send(flood_byte);
  EXPECT_THAT(host_.status(), HasSubstr("|A:FM"));
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest());
  rig_.set(sim::Pin::estop, true);
  host_.run_ms(2);
  host_.send(flood_byte);
  EXPECT_THAT(host_.ask("$G\n"), Contains(HasSubstr(" M9 ")));
  EXPECT_THAT(host_.status(), Not(HasSubstr("|A:")));
}

}  // namespace
}  // namespace lamplock::test::stop_at_error_test
