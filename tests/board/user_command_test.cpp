// User commands in the lines of a program: their numbers, and what is refused.
#include "host/program/user_command.hpp"

#include <gmock/gmock.h>

#include <string>

#include "host/job/job.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/program_flow.hpp"
#include "tests/error_of.hpp"

namespace lamplock::program_run::user_command_test {
namespace {

using testing::HasSubstr;

TEST(UserCommand, HasANumberAndTwoArguments) {
  const struct {
    const char* line;
    int number;
    double p, q;
  } rows[] = {
      {"M100", 100, -1, -1},     {"m199 q2.5 p-3", 199, -3, 2.5},
      {"N7 M101P0", 101, 0, -1}, {"M0118 Q1", 118, -1, 1},
      {"M 150", 150, -1, -1},    {"M101 P+999999999.5", 101, 999999999.5, -1},
  };
  for (const auto& row : rows) {
    const auto command = user_command_of({1, row.line}, "p.ngc");
    ASSERT_TRUE(command) << row.line;
    EXPECT_EQ(command->number, row.number) << row.line;
    EXPECT_EQ(command->p, row.p) << row.line;
    EXPECT_EQ(command->q, row.q) << row.line;
  }
}

TEST(UserCommand, LeavesTheCodesOfTheMachine) {
  for (const char* line : {"M99", "M200", "M117 M101", "M126 P1", "M127 P5", "M128 P5", "M130 P0",
                           "M131", "M3 S101", "G1 X101", "$M101", "M101.5", "(M101)", "M10 1 X"})
    EXPECT_FALSE(is_user_command(line)) << line;
}

TEST(UserCommand, StandsAlone) {
  const auto refusal = [](const char* line) {
    return test::error_of([line] { user_command_of({4, line}, "p.ngc"); });
  };
  EXPECT_THAT(refusal("M101 X5"), HasSubstr("p.ngc:4:6: 'X5' is in the line of a user command"));
  EXPECT_THAT(refusal("G0 M101"), HasSubstr("'G0' is in the line of a user command"));
  EXPECT_THAT(refusal("M101 M102"), HasSubstr("'M102' is in the line of a user command"));
  EXPECT_THAT(refusal("#1=2 M101"), HasSubstr("is in the line of a user command"));
  EXPECT_THAT(refusal("M101 P"), HasSubstr("'P' is not a number"));
  EXPECT_THAT(refusal("M101 P1 P2"), HasSubstr("p.ngc:4:9: error:25 'P2' occurs twice"));
  EXPECT_THAT(refusal("Q-1 M101 Q1"), HasSubstr("p.ngc:4:10: error:25 'Q1' occurs twice"));
  for (const char* value : {"P9999999999999", "P-1000000000", "P+1000000000.5"})
    EXPECT_THAT(refusal((std::string("M101 ") + value).c_str()),
                HasSubstr(std::string("p.ngc:4:6: error:2 '") + value + "' is too large"));
}

TEST(UserCommand, HasValuesOfSubs) {
  const std::string text = "o1 sub\nM101 P#1 Q[#1*2]\no1 endsub\no1 call [3]\no1 call [4]\nM2";
  std::string joined;
  for (const link::ProgramLine& line :
       run_flow(link::program_lines(text, "p.ngc"), "p.ngc", job::default_profile().settings))
    joined += line.text + " ";
  EXPECT_EQ(joined, "M101P3Q6 M101P4Q8 M2 ");
  EXPECT_TRUE(has_flow("#1=5\nM101 P#1"));
  EXPECT_FALSE(has_flow("M101 P5"));
}

TEST(UserCommand, APauseTakesItsPlace) {
  EXPECT_EQ(without_user_commands("G0 X1\r\n M101 P5 (text)\nM117 M101\n"),
            "G0 X1\nM60\nM117 M101\n");
}

}  // namespace
}  // namespace lamplock::program_run::user_command_test
