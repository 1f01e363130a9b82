// Tool changes of a program: M6 waits as the state Tool; after an acknowledgement the user jogs,
// probes and touches off; a resume returns to the program.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "host/link/line_sender.hpp"
#include "tests/board/bench.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::tool_change_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double steps_per_mm = 200;
constexpr std::uint8_t acknowledge = 0xa3, jog_cancel = 0x85, reset = 0x18;

class ToolChange : public testing::Test {
 protected:
  ToolChange() { host_.run_ms(5); }
  double mm(std::size_t axis) const {
    return rig_.board.world().drives().position()[axis] / steps_per_mm;
  }
  /// Runs until the state begins with this word.
  bool reaches(const std::string& state) {
    for (int i = 0; i < 4000; ++i) {
      if (host_.status().starts_with("<" + state)) return true;
      host_.run_ms(10);
    }
    return false;
  }
  void begin(std::string_view lines = "G1 X1 Y2 Z3 F6000\nT3 M6\nG1 X3\n") {
    host_.send(lines);
    ASSERT_TRUE(reaches("Tool|")) << host_.status();
    first_ = host_.answers().size();
  }
  /// Since the tool change began.
  std::vector<std::string> answers() const {
    return {host_.answers().begin() + static_cast<std::ptrdiff_t>(first_), host_.answers().end()};
  }

  std::size_t first_ = 0;
  job::Profile profile_ = program_profile();
  Rig rig_{profile_};
  ProgramHost host_{rig_};
};

TEST_F(ToolChange, WaitsForAResumeWithoutAnAcknowledgement) {
  host_.send("G1 X1 F6000\nT3 M6\n$J=G91 X5 F600\nG1 X3\n");
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  host_.run_ms(500);
  EXPECT_EQ(mm(0), 1);
  host_.send("~");
  host_.run_ms(1000);
  // A jog of the program's host waits as any line does; then the machine is not idle.
  EXPECT_THAT(host_.answers(), ElementsAre("ok", "ok", "error:8", "ok"));
  EXPECT_EQ(mm(0), 3);
}

TEST_F(ToolChange, LinesOfTheUserRunAndTheProgramContinuesFromItsPlace) {
  begin("G20 G91 G1 X0.1 F60\nG90 G21 G1 X5 Y2 Z3 F6000\nT3 M6\nX8\nM2\n");
  host_.send(acknowledge);
  EXPECT_THAT(host_.ask("$J=G91 Z20 F3000\n"), ElementsAre("ok"));
  EXPECT_THAT(host_.status(), StartsWith("<Jog|"));
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  EXPECT_THAT(host_.ask("G91 G0 X20 Y10\n"), ElementsAre("ok"));
  EXPECT_THAT(host_.status(), StartsWith("<Run|"));
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  EXPECT_EQ(mm(0), 25);
  EXPECT_EQ(mm(2), 23);
  EXPECT_THAT(host_.ask("G43.1 Z-1.5\n"), ElementsAre("ok"));
  EXPECT_THAT(host_.ask("G10 L20 P1 Y0\n"), ElementsAre("ok"));
  first_ = host_.answers().size();
  host_.send("~");
  host_.run_ms(20);
  EXPECT_THAT(host_.status(), StartsWith("<Run|"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_THAT(answers(), ElementsAre("ok", "ok", "ok"));  // of M6, X8 and M2
  // In millimetres, absolute, at the feed rate of the program; at the Y and Z of M6.
  EXPECT_EQ(mm(0), 8);
  EXPECT_EQ(mm(1), 2);
  EXPECT_EQ(mm(2), 3);
  EXPECT_THAT(host_.ask("$#\n"), Contains("[TLO:-1.500]"));
  EXPECT_THAT(host_.ask("$#\n"), Contains(HasSubstr("[G54:0.000,12.000,")));
}

TEST_F(ToolChange, TheWayBackIsAtTheHigherZ) {
  for (const double z : {10.0, -2.0}) {
    begin(fmt::format("G1 X5 Y5 Z3 F6000\nM6\nX5\n"));
    host_.send(acknowledge);
    host_.ask(fmt::format("G91 G0 X10 Y10 Z{}\n", z));
    ASSERT_TRUE(reaches("Tool|")) << host_.status();
    const double high = std::max(3.0, 3.0 + z);
    host_.send("~");
    for (int i = 0; i < 4000 && (mm(0) != 5 || mm(1) != 5); ++i) {
      host_.run_ms(1);
      if (mm(0) != 15 && mm(0) != 5) {
        ASSERT_EQ(mm(2), high) << mm(0);
      }
    }
    ASSERT_TRUE(host_.wait_for_rest());
    EXPECT_EQ(mm(2), 3);
  }
}

TEST_F(ToolChange, CommandsThatWouldEndOrBlockTheProgramAreRefused) {
  begin();
  host_.send(acknowledge);
  for (const std::string line : {"M0", "M2", "M30", "M6", "T1 M6", "M49", "M131", "G41.1 D1"})
    EXPECT_THAT(host_.ask(line + "\n"), ElementsAre("error:40")) << line;
  EXPECT_THAT(host_.ask("G1 X\n"), ElementsAre("error:2"));
  EXPECT_THAT(host_.ask("$H\n"), ElementsAre(HasSubstr("error:")));
  EXPECT_THAT(host_.ask("$100=200\n"), ElementsAre("error:8"));
  EXPECT_THAT(host_.ask("M61 Q7\n"), ElementsAre("ok"));
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(mm(0), 3);
}

TEST_F(ToolChange, OtherCommandsInTheLineOfM6ExcludeLinesOfTheUser) {
  begin("T3 M6 G0 X2\n");
  host_.send(acknowledge);
  EXPECT_THAT(host_.ask("$J=G91 X5 F600\n"), ElementsAre("error:40"));
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(mm(0), 2);
  EXPECT_THAT(host_.ask("$J=G91 X5 F6000\n"), ElementsAre("ok"));
}

TEST_F(ToolChange, AResumeWaitsForTheLineOfTheUser) {
  begin();
  host_.send(acknowledge);
  host_.send("G1 X40 F600\n");
  host_.run_ms(300);
  host_.send("~");
  host_.run_ms(20);
  EXPECT_THAT(host_.said(), Contains(HasSubstr("a line is not finished")));
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  EXPECT_EQ(mm(0), 40);
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(mm(0), 3);
}

TEST_F(ToolChange, HoldsCancelsAndTheDoorOfItsJogs) {
  begin();
  host_.send(acknowledge);
  host_.ask("$J=X40 F1200\n");
  host_.run_ms(200);
  host_.send(jog_cancel);
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  EXPECT_LT(mm(0), 40);
  host_.ask("G1 X45 F1200\n");
  host_.run_ms(200);
  host_.send("!");
  ASSERT_TRUE(reaches("Hold:0|")) << host_.status();
  EXPECT_LT(mm(0), 45);
  host_.send("~");
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  EXPECT_EQ(mm(0), 45);
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(mm(0), 3);
}

TEST_F(ToolChange, ADoorLeadsBackToIt) {
  begin();
  host_.send(acknowledge);
  host_.ask("$J=X40 F1200\n");
  host_.run_ms(200);
  rig_.board.world().schedule(sim::Pin::door, true, rig_.now());
  ASSERT_TRUE(reaches("Door:1|")) << host_.status();
  EXPECT_LT(mm(0), 40);
  host_.send("~");
  host_.run_ms(100);
  EXPECT_THAT(host_.status(), StartsWith("<Door:1|"));
  rig_.board.world().schedule(sim::Pin::door, false, rig_.now());
  ASSERT_TRUE(reaches("Door:0|")) << host_.status();
  host_.send("~");
  ASSERT_TRUE(reaches("Tool|")) << host_.status();
  host_.send("~");
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(mm(0), 3);
}

TEST_F(ToolChange, AResetEndsIt) {
  begin();
  host_.send(acknowledge);
  host_.send(reset);
  host_.run_ms(100);
  EXPECT_THAT(host_.status(), StartsWith("<Idle|"));
  EXPECT_THAT(host_.ask("G1 X2 F6000\n"), ElementsAre("ok"));
  ASSERT_TRUE(host_.wait_for_rest());
  EXPECT_EQ(mm(0), 2);
}

TEST_F(ToolChange, AnAlarmAnswersEveryLine) {
  begin("G1 X1 F6000\nT3 M6\nX3\nX4\n");
  host_.send(acknowledge);
  host_.send("G1 X9999 F600\n");
  host_.run_ms(500);
  EXPECT_THAT(host_.status(), StartsWith("<Alarm|"));
  // The user's line, that of M6 and two of the program.
  EXPECT_THAT(answers(), ElementsAre("error:9", "error:33", "error:9", "error:9"));
  EXPECT_THAT(host_.ask("$X\n"), Contains("ok"));
  EXPECT_THAT(host_.ask("X2\n"), ElementsAre("ok"));
}

/// Programs with tool changes at random places, with lines of the user of random lengths, end where
/// they end without them; each line is answered once.
TEST_F(ToolChange, RandomProgramsEndAtTheSamePlace) {
  std::mt19937 random(7);
  const auto any = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int round = 0; round < scaled(12); ++round) {
    std::string program = "G90 G21 F6000\n";
    std::size_t lines = 1;
    int changes = 0;
    double x = mm(0), y = mm(1);
    for (int i = 0; i < 30; ++i, ++lines) {
      if (any(8) == 0) {
        ++changes;
        program += fmt::format("T{} M6\n", 1 + any(9));
        continue;
      }
      x = any(50);
      y = any(50);
      program += fmt::format("G1 X{} Y{} ({})\n", x, y,
                             std::string(static_cast<std::size_t>(any(5)), 'c'));
    }
    first_ = host_.answers().size();
    host_.send(program);
    std::size_t users = 0;
    for (int i = 0; i < changes; ++i) {
      ASSERT_TRUE(reaches("Tool|")) << host_.status();
      if (any(4) != 0) {
        host_.send(acknowledge);
        for (int k = any(4); k > 0; --k, ++users) {
          host_.send(any(2) == 0
                         ? fmt::format("$J=G90 X{} F6000\n", any(50))
                         : fmt::format("G90 G20 G0 X{} ({})\n", any(2),
                                       std::string(static_cast<std::size_t>(any(150)), 'u')));
          host_.run_ms(5);
          ASSERT_TRUE(reaches("Tool|")) << host_.status();
        }
      }
      host_.send("~");
      host_.run_ms(5);
    }
    ASSERT_TRUE(host_.wait_for_rest());
    EXPECT_EQ(answers().size(), lines + users);
    EXPECT_EQ(mm(0), x);
    EXPECT_EQ(mm(1), y);
  }
}

/// A host that counts characters: the window is full of lines of the program meanwhile.
TEST(ToolChangeOfASender, LinesOfTheUserDoNotDisturbItsCount) {
  Rig rig(program_profile());
  BoardCable cable(rig);
  std::string program = "G90 G21 G1 X1 F6000\nT3 M6\n";
  for (int i = 0; i < 300; ++i) program += fmt::format("G1 X{} Y{}\n", i % 7, i % 5);
  link::LinePort port(cable);
  link::LineSender sender(port, link::program_lines(program, "program"));
  const auto wait = [&] {
    while (!sender.waits())
      if (!sender.step()) return false;
    return sender.status().is("Tool");
  };
  ASSERT_TRUE(wait());
  EXPECT_FALSE(sender.status().free_bytes.value_or(1024) > 300);
  for (const char* line : {"$J=G91 X20 F6000", "G10 L20 P1 Z1", "G91 G0 X5", "G1 X", "M61 Q3"}) {
    EXPECT_TRUE(sender.send_users_line(line)) << line;
    EXPECT_FALSE(sender.send_users_line(line)) << "not before its answer";
    EXPECT_FALSE(sender.waits());
    ASSERT_TRUE(wait()) << line;
  }
  EXPECT_EQ(rig.board.world().drives().position()[0], 26 * 200);
  sender.resume();
  while (sender.step()) {
  }
  EXPECT_EQ(sender.result().end, link::LineEnd::done);
  EXPECT_EQ(sender.result().answered, 302u);
  EXPECT_TRUE(sender.errors().empty());
  EXPECT_EQ(rig.board.world().drives().position()[0], 299 % 7 * 200);
}

}  // namespace
}  // namespace lamplock::test::tool_change_test
