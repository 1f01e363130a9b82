// Messages in comments, compared with what LinuxCNC's rs274 (2.9) makes of the same lines.
#include "firmware/program/message.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/program/rig.hpp"

namespace lamplock::program::test {
namespace {

std::vector<std::string> messages_of(Rig& rig, const std::string& text) {
  std::vector<std::string> found;
  std::string_view line = text;
  for (TextLine message; rig.interpreter.take_message(line, message); message = {})
    found.emplace_back(message.view());
  return found;
}

TEST(Message, TextsAndValuesAreThoseOfRs274) {
  Rig rig;
  rig.run("#1=2.5 #<foo>=-3.25");
  struct Case {
    const char *line, *text;
  };
  for (const Case& c : {
           Case{"(MSG, hello #1)", "hello #1"},
           Case{"(DEBUG, a=#1 b=#<foo> c=#5420 d=[#1] ## %d #1 %.2f #1 end)",
                "a=2.500000 b=-3.250000 c=0.000000 d=[2.500000] ##  2  2.50 end"},
           Case{"(PRINT,x #1 %f#<foo>)", "x 2.500000 -3.2500"},
           Case{"(debug,%lf#1 %x)", "2.500000 %x"},
           Case{"( msg,lower)", "lower"},
           Case{"G1 X1 (print, #<unset> #0 #)", "#<unset> #0 #"},
       })
    EXPECT_EQ(messages_of(rig, c.line), std::vector<std::string>{c.text}) << c.line;
}

/// rs274 prints the last one of a line only.
TEST(Message, EachMessageOfALineIsOne) {
  Rig rig;
  rig.run("#1=7");
  EXPECT_EQ(messages_of(rig, "(MSG,one) X1 (no message) (debug,two %d#1)(x) ;(msg,three)"),
            (std::vector<std::string>{"one", "two 7"}));
}

TEST(Message, OtherCommentsAreNone) {
  Rig rig;
  for (const char* line : {"G1 X1", "(message)", "(MSG)", "(MSGS, a)", "; (MSG, a)", "((MSG, a))",
                           "(DEBUGGING, #1)", "", "("})
    EXPECT_TRUE(messages_of(rig, line).empty()) << line;
}

TEST(Message, ItsLengthIsLimited) {
  Rig rig;
  rig.run("#1=-123456789.5");
  std::string text;
  for (int i = 0; i < 100; ++i) text += "#1";
  const std::vector<std::string> found = messages_of(rig, "(DEBUG," + text + ")");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LE(found.front().size(), max_message + 20);
}

TEST(Message, TheInterpreterNotesLinesThatMayHaveOne) {
  Rig rig;
  const auto noted = [&](const std::string& line) {
    rig.run(line);
    return rig.interpreter.has_ignored() && (rig.interpreter.take_ignored() & message_bit) != 0;
  };
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(noted("G1 X1 F100 (MSG, a)"));
    EXPECT_TRUE(noted("(debug, a) X2"));
    EXPECT_FALSE(noted("X3 (cut)"));
    EXPECT_FALSE(noted("X4 ; (MSG, a)"));
  }
}

}  // namespace
}  // namespace lamplock::program::test
