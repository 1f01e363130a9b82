// Expressions and parameters of lines: values, precedence, assignments, and every error.
//
// Values are those that LinuxCNC's rs274 prints for the same lines, unless the text says otherwise.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::test {
namespace {

TEST(Expression, ValuesOfOperatorsAndFunctions) {
  const struct {
    const char* value;
    const char* wanted;
  } rows[] = {
      {"[2**3**2]", "64"},
      {"[-2**2]", "4"},
      {"[-[2]**2]", "4"},
      {"[2*3**2 mod 4]", "2"},
      {"[8/2*4]", "16"},
      {"[1 + 2 * 3 ** 2 - 4 / 2]", "17"},
      {"[[1+2]*[3+4]]", "21"},
      {"[ 1 2 + 3 ]", "15"},
      {"[-7 mod 3]", "2"},
      {"[7 mod -3]", "1"},
      {"[5.5 MOD 2]", "1.5"},
      {"--2", "2"},
      {"+-2", "-2"},
      {"-[1+2]", "-3"},
      {"-sin[30]", "-0.5"},
      {"-#1", "0"},
      {"[3 -2]", "1"},
      {"[3 - -2]", "5"},
      {"[+3]", "3"},
      {"[1 eq 1]", "1"},
      {"[1 eq 1.00005]", "1"},
      {"[1 eq 1.0002]", "0"},
      {"[1 ne 1.00005]", "0"},
      {"[1 ge 1.00005]", "0"},
      {"[1 lt 2 gt 0]", "1"},
      {"[1 le 1]", "1"},
      {"[1 or 0 and 0]", "0"},
      {"[2 xor 3]", "0"},
      {"[1.5 and 1]", "1"},
      {"[1 + 2 eq 3]", "1"},
      {"[2 ** -1]", "0.5"},
      {"[0**0]", "1"},
      {"[[-2]**3]", "-8"},
      {"[4 ** .5]", "2"},
      {"abs[-1.5]", "1.5"},
      {"acos[.5]", "60"},
      {"acos[-1]", "180"},
      {"asin[-.5]", "-30"},
      {"atan[1]/[-1]", "135"},
      {"atan[-1]/[-1]", "-135"},
      {"atan[0]/[-1]", "180"},
      {"atan[0]/[0]", "0"},
      {"atan[-1]/[0]", "-90"},
      {"cos[60]", "0.5"},
      {"cos[-720]", "1"},
      {"exp[0]", "1"},
      {"exp[1]", "2.7182818"},
      {"ln[exp[3]]", "3"},
      {"fix[2.8]", "2"},
      {"fix[-2.8]", "-3"},
      {"fup[2.2]", "3"},
      {"fup[-2.8]", "-2"},
      {"round[2.5]", "3"},
      {"round[-2.5]", "-3"},
      {"round[-2.4]", "-2"},
      {"sin[30]", "0.5"},
      {"sqrt[2]", "1.4142136"},
      {"tan[45]", "1"},
      {"s q r t [ 1 6 ]", "4"},
      {"[1/3*3]", "1"},
      {"[2 * [3 (three) + 4]]", "14"},
      {"[100 * 0.1 * 0.1]", "1"},
      {"exists[#<nothing>]", "0"},
      {"exists[#<_x>]", "1"},
  };
  for (const auto& row : rows) {
    Rig rig;
    EXPECT_EQ(rig.run(std::string("G0 Y0 X") + row.value),
              std::string("rapid to ") + row.wanted + " 0 0")
        << row.value;
  }
}

TEST(Expression, ParametersKeepValuesUntilTheProgramEnds) {
  expect_rows({
      Row{"#1=5|G0X#1", "rapid to 5 0 0"},
      Row{"G0X#1", "rapid to 0 0 0"},
      Row{"#1=5 G0X#1", "rapid to 0 0 0"},  // in force after the whole line
      Row{"#1=5|#1=6 #2=#1|G0X#1Y#2", "rapid to 6 5 0"},
      Row{"#1=1 #1=2|G0X#1", "rapid to 2 0 0"},
      Row{"#1=3 #3=7|G0X##1", "rapid to 7 0 0"},
      Row{"#[1+1]=4|G0X#2Y#[4/2]", "rapid to 4 4 0"},
      Row{"#<wide> = 12.5|G0X#<WI DE>", "rapid to 12.5 0 0"},
      Row{"#<a>=1 #<_b>=#1|#<a>=[#<a>+1] #<c>=#<a>|G0X#<a>Y#<_b>Z#<c>", "rapid to 2 0 1"},
      Row{"#5000=1|#5000=0|G0X#5000", "rapid to 0 0 0"},
      Row{"#1=1|#2=2|#3=3|#1=0|#2=0 #3=4|G0X#1Y#2Z#3", "rapid to 0 0 4"},
      Row{"#1=5|M2|G0X#1", "rapid to 0 0 0"},
      Row{"#<a>=5|M30|G0X#<a>", "74@4"},
      Row{"#<a>=0|G0X[EXISTS[#<a>]+EXISTS[#<b>]]", "rapid to 1 0 0"},
  });
}

TEST(Expression, WordsOfEveryKindTakeValues) {
  expect_rows({
      Row{"#1=1|G#1 X[1+1] F[#1*100]", "feed 100 to 2 0 0"},
      Row{"#1=1|G[1+0] X2 F[60*#1]", "feed 60 to 2 0 0"},
      Row{"G4 P[1/4]", "dwell 250000us"},
      Row{"M[3] S[50*2]", "spindle M3 S100"},
      Row{"#7=2|G10 L#7 P[1] X[10]|G0 X0", "rapid to 10 0 0"},
      Row{"N[2+1] G0 X1", "rapid to 1 0 0 N3"},
      Row{"#1=25.4|G0 G20 X[#1/25.4]", "rapid to 25.4 0 0"},
      Row{"G1 F100 X#1 Y-[2]*", "1@18"},
  });
}

TEST(Expression, ReadsValuesOfTheMachine) {
  expect_rows({
      Row{"G10 L2 P2 X1 Y2|G55 G0 X10 Y20|G0 X[#5420+1] Y[#<_y>+2] Z#5220", "rapid to 12 24 2"},
      Row{"G10 L2 P9 X1.5 A2|G53 G0 X#5381 Y#5384", "rapid to 1.5 2 0"},
      Row{"G0 X25.4|G20|G0 Y#5420 Z#<_x>", "rapid to 25.4 25.4 25.4"},
      Row{"G0 X3|G28.1|G0 X#5161 Y#5161", "rapid to 3 3 0"},
      Row{"G0 X5|G92 X1|G53 G0 X#5211 Y#5210", "rapid to 4 1 0"},
      Row{"G43.1 Z2|G53 G0 X#5403 Y#<_tool_offset>", "rapid to 2 1 0"},
      Row{"F123.5 S77 M61 Q4|G0 X#<_feed> Y#<_rpm> Z#5400", "rapid to 123.5 77 4"},
      Row{"G20 F10|G21|G0 X#<_feed>", "rapid to 254 0 0"},
      Row{"G18 G59.1|G53 G0 X#<_plane> Y#<_coord_system> Z#<_motion_mode>", "rapid to 180 591 0"},
      Row{"G91 G0 M8| X#<_incremental> Y#<_flood> Z#<_metric>", "rapid to 1 1 1"},
      Row{"G0 X#5602 Y#5062 Z#5399", "rapid to 0 0 0"},
  });
}

TEST(Expression, RefusesWithErrorAndColumn) {
  expect_rows({
      Row{"X[1/0]", "72@4"},
      Row{"X[5 mod 0]", "72@5"},
      Row{"X[0**-1]", "72@4"},
      Row{"Xtan[90]", "72@2"},
      Row{"X[1+sqrt[-1]]", "73@5"},
      Row{"Xln[0]", "73@2"},
      Row{"Xacos[2]", "73@2"},
      Row{"X[[-8]**[1/3]]", "73@7"},
      Row{"X#<bar>", "74@2"},
      Row{"X[1+2", "75@2"},
      Row{"X[1+[2*3]", "75@2"},
      Row{"X[]", "75@3"},
      Row{"X[1 2 / / 2]", "75@9"},
      Row{"Xatan[1]", "75@2"},
      Row{"X[1#2]", "75@4"},
      Row{"X#<>", "75@2"},
      Row{"X#<a", "75@2"},
      Row{"#1", "75@1"},
      Row{"#1=", "75@3"},
      Row{"#<a>", "75@1"},
      Row{"X[1 foo 2]", "71@5"},
      Row{"X[foo[1]]", "71@3"},
      Row{"Xfoo[1]", "2@1"},
      Row{"X", "2@1"},
      Row{"XY1", "2@1"},
      Row{"X1+2", "1@3"},
      Row{"X[1]]", "1@5"},
      Row{"#1=2+1", "1@5"},
      Row{"X[1234567890]", "2@3"},
      Row{"X[999999999+1]", "76@1"},
      Row{"X[99999999*99999999]", "76@11"},
      Row{"Xexp[23]", "76@2"},
      Row{"X#0", "39@2"},
      Row{"X#-1", "39@2"},
      Row{"X#5603", "39@2"},
      Row{"X#1.5", "23@2"},
      Row{"#[1.5]=3", "23@1"},
      Row{"#5001=1", "39@1"},
      Row{"#5420=1", "39@1"},
      Row{"#<_x>=1", "39@1"},
      Row{"S#1*3", "2@1"},
  });
}

TEST(Expression, ALineWithAnErrorAssignsNothing) {
  for (const char* line : {"#1=1 #<new>=2 X", "#1=1 #<new>=2 #3=[1/0]", "#<new>=1 G1 X1",
                           "#1=1 #<new>=3 G123", "#2=1 #<new>=#<none>"}) {
    Rig rig;
    rig.run("#1=5 #<old>=6");
    const Seen before = rig.seen();
    EXPECT_NE(rig.run(line).find('@'), std::string::npos) << line;
    EXPECT_EQ(rig.seen(), before) << line;
    EXPECT_EQ(rig.run("G0 X#1 Y#<old> Z[#2+#3+EXISTS[#<new>]]"), "rapid to 5 6 0") << line;
  }
}

TEST(Expression, NamesOfLinesInErrorTakeNoRoom) {
  Rig rig;
  for (std::uint32_t i = 0; i < Variables::name_characters / 8; ++i)
    ASSERT_EQ(rig.run(fmt::format("#<forgotten{:03}>=1 G1 F1 X", i)), "2@25");
  EXPECT_EQ(rig.run("#<kept>=1"), "");
}

TEST(Expression, AJogTakesNone) {
  Rig rig;
  EXPECT_EQ(rig.jog("X[1] F100"), "2@1");
  EXPECT_EQ(rig.jog("#1=2 X1 F100"), "1@1");
}

TEST(Expression, OWordsHaveTheirOwnError) {
  for (const char* line : {"o100 sub", "O100 endsub", "o<part> call [1] [2]", "N5 o1 if [#1 gt 2]",
                           "o1 else", "O1 while [#1 lt 3]", "o1 do", "o1 repeat [5]", "o#1 call",
                           "o1 return [3]", "o1 break", "o[1+1] continue"}) {
    Rig rig;
    const Fault fault = rig.interpreter.run(line);
    EXPECT_EQ(fault.error, GcodeError::o_word) << line;
    EXPECT_EQ(fault.column, std::string_view(line).starts_with('N') ? 4 : 1) << line;
  }
  Rig rig;
  EXPECT_EQ(rig.run("O1000 G0 X1"), "rapid to 1 0 0");  // a program number
  EXPECT_EQ(rig.run("O1000 G0 X"), "2@10");
}

TEST(Expression, NestsAsFarAsItsStacksReach) {
  const auto nested = [](int depth) {
    std::string line = "X";
    for (int i = 0; i < depth; ++i) line += "[1+";
    line += "1";
    return line + std::string(static_cast<std::size_t>(depth), ']');
  };
  Rig rig;
  EXPECT_EQ(rig.run("G0" + nested(20)), "rapid to 21 0 0");
  for (int depth = 24; depth < 60; ++depth)
    EXPECT_EQ(rig.interpreter.run(nested(depth)).error, GcodeError::nested_too_deep) << depth;
  EXPECT_EQ(rig.interpreter.run("X" + std::string(100, '-') + "1").error,
            GcodeError::nested_too_deep);
}

TEST(Expression, ParametersFillTheirRoom) {
  Rig rig;
  for (std::uint32_t i = 1; i <= Variables::capacity; ++i)
    ASSERT_EQ(rig.run(fmt::format("#{}={}", i * 7, i)), "") << i;
  EXPECT_EQ(rig.run("#5000=1"), "83@1");
  EXPECT_EQ(rig.run("G0 X#7 Y#1792"), "rapid to 1 256 0");
  EXPECT_EQ(rig.run("#7=1"), "83@1");  // an assignment needs a place until the end of its line
  EXPECT_EQ(rig.run("M2"), "end");
  EXPECT_EQ(rig.run("#7=1"), "");
  const std::string name(ValueText::max_name, 'n');
  EXPECT_EQ(rig.run("#<" + name + "n>=1"), "83@2");
  std::string last;
  for (int i = 0; i < 20 && last.empty(); ++i)
    last = rig.run(fmt::format("#<{}{:02}>=1", name.substr(2), i));
  EXPECT_EQ(last, "83@1");
  EXPECT_EQ(rig.run("G0 X#<" + name.substr(2) + "03>"), "rapid to 1 256 0");
}

TEST(Expression, AMillionSumsOfATenthAreExact) {
  Rig rig;
  for (int i = 0; i < 1'000'000; ++i) ASSERT_FALSE(rig.interpreter.run("#1=[#1+0.1]"));
  EXPECT_EQ(rig.interpreter.variables().value_at(0), 100'000 * one_e9);
}

/// Random pieces of the language and random characters: no line with an error changes anything, and
/// none crashes or stops the interpreter (the sanitizers watch).
TEST(Expression, RandomTextIsRunOrRefused) {
  static constexpr std::array pieces{
      "#",     "[",    "]",     "<",    ">",     "=",      "+",      "-",   "*",    "**",
      "/",     "1",    "0.5",   "3",    "9",     ".",      "999999", "#1",  "#2",   "#<a>",
      "X",     "Y",    "G0",    "G1",   "F100",  "sin[",   "atan[",  "]/[", "ln[",  "sqrt[",
      "exp[",  "fix[", " mod ", " eq ", " and ", "exists", "(c)",    ";",   "o1",   "#5220",
      "[1+2]", "#1=",  "#<b>=", "[[",   "]]",    "S",      ":",      "##",  "acos["};
  std::mt19937 random(7);
  Rig rig;
  int valid = 0;
  const int lines = lamplock::test::scaled(100'000, 2000);
  for (int i = 0; i < lines; ++i) {
    std::string line;
    for (auto k = random() % 14; k > 0; --k)
      if (random() % 20 == 0)
        line += static_cast<char>(random());
      else
        line += pieces[random() % pieces.size()];
    const Seen before = rig.seen();
    const std::uint32_t size = rig.interpreter.variables().size();
    const Fault fault = rig.interpreter.run(line);
    valid += fault ? 0 : 1;
    ASSERT_LE(fault.column, line.size()) << line;
    if (fault) {
      ASSERT_GT(fault.column, 0) << line;
      ASSERT_EQ(rig.seen(), before) << line;
      ASSERT_EQ(rig.interpreter.variables().size(), size) << line;
    }
    rig.take();
  }
  EXPECT_GT(valid, lines / 100);
}

}  // namespace
}  // namespace lamplock::program::test
