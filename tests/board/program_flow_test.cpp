// O-words and subprograms: the lines that the host makes of them, their errors, and the moves of
// random programs beside those of LinuxCNC's rs274.
#include "host/program/program_flow.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/job/job.hpp"
#include "host/program/flow_unit.hpp"
#include "host/program/line_column.hpp"
#include "host/program/program_run.hpp"
#include "tests/program/rs274.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::program_run {
namespace {

using program::test::CanonicalMove;
using program::test::Rs274;
using testing::HasSubstr;

std::vector<link::ProgramLine> flow_of(const std::string& text, const std::string& file = "p.ngc") {
  return run_flow(link::program_lines(text, file), file, job::default_profile().settings);
}

/// The lines that a board gets, each after the number of its line in the file.
std::string lines_of(const std::string& text) {
  std::string joined;
  for (const link::ProgramLine& line : flow_of(text))
    joined += fmt::format("{}{}:{}", joined.empty() ? "" : " ", line.number, line.text);
  return joined;
}

std::string refusal_of(const std::string& text) {
  try {
    flow_of(text);
  } catch (const Error& error) {
    return std::string(error.message());
  }
  return "none";
}

/// The other words of M98, M99 and of the line of the number.
TEST(ProgramFlow, DropsNoWordOfSubprograms) {
  EXPECT_EQ(lines_of("M98 P1\nG1 X9\nM30\nO1\nM3 S9\nN7 G0 Z5 M5 M99"),
            "5:M3 S9 6:N7 G0 Z5 M5 2:G1 X9 3:M30");
  EXPECT_EQ(lines_of("M98 P1\nG0 X[1+1]\nM30\nO1\nG91\n#1=3\nG0 X#1 M99 G90"),
            "5:G91 7:G0X3G90 2:G0X2 3:M30");
  EXPECT_EQ(lines_of("M98 P1 L2\nM30\nO1 G1 Y3\nX5\nM99"), "3:O1 G1 Y3 4:X5 3:O1 G1 Y3 4:X5 2:M30");
  EXPECT_EQ(lines_of("M98 P1\nM30\n(text)\nO1 (text)\nX5\nM99"), "5:X5 2:M30");
  EXPECT_EQ(lines_of("/o1 if [1]\n/ G0 X1\n / o1 endif"), "2:/ G0 X1");
  for (const char* text : {"M98 P1 M5", "M98 P1 M98", "M98 P1 P2", "M98 P1 L1 L2", "M98 P1 G90"})
    EXPECT_THAT(refusal_of(std::string(text) + "\nM30\nO1\nM99"), HasSubstr("p.ngc:1: ")) << text;
  EXPECT_THAT(refusal_of("M98 P1\nM30\nO1\nM99 P10"), HasSubstr("p.ngc:4: M99 P10"));
}

/// M73: the modes of the caller are in force again after each end, also of nested calls.
TEST(ProgramFlow, RestoresTheModesOfM73) {
  const settings::Values values = job::default_profile().settings;
  const auto place_after = [&](const std::string& text) {
    std::string sent;
    for (const link::ProgramLine& line : flow_of(text)) sent += line.text + "\n";
    const ProgramRun run = run_program(sent, values, 9);
    EXPECT_TRUE(run.problems.empty()) << sent;
    return run.bounds.high[0];
  };
  const std::string sub = "o1 sub\nM73\nG91 G20 G93\nG1 X0.1 F20\n";
  EXPECT_NEAR(place_after("G21 G90 F600\n" + sub + "o1 endsub\no1 call\nG1 X9\nM2"), 9, 1e-6);
  EXPECT_NEAR(place_after("G21 G90 F600\n" + sub + "o1 return\no1 endsub\no1 call\nG1 X9\nM2"), 9,
              1e-6);
  EXPECT_NEAR(place_after("G21 G90 F600\no2 sub\nM73\nG91\no1 call\nG1 X3\no2 endsub\n" + sub +
                          "o1 endsub\no2 call\nG1 X12\nM2"),
              12, 1e-6);
  EXPECT_NEAR(place_after("G21 G90 F600\nM98 P1 L2\nG1 X9\nM2\nO1\nM73 G20 G91\nG1 X0.1\nM99"), 9,
              1e-6);
  EXPECT_THAT(lines_of("G21 F600\nM8\no1 sub\nM73\nM9 M3 S5\no1 endsub\no1 call\nM2"),
              HasSubstr("6:M9 6:M8 6:S0.000 M5"));
  EXPECT_THAT(refusal_of("o1 sub\nM73\nM130 P0\no1 endsub\no1 call\nM2"),
              HasSubstr("M73 does not restore M130"));
  EXPECT_THAT(lines_of("M73\nG91\nM2"), HasSubstr("M73"));
}

TEST(ProgramFlow, MakesLinesOfLoopsAndBranches) {
  const struct {
    const char* text;
    const char* lines;
  } rows[] = {
      {"o1 repeat [3]\nG0 X1\no1 endrepeat\nG0 X2", "2:G0 X1 2:G0 X1 2:G0 X1 4:G0 X2"},
      {"o1 repeat [0]\nG0 X1\no1 endrepeat\nG0 X2", "4:G0 X2"},
      {"#1=3\no1 while [#1 GT 1]\nG0 X#1\n#1=[#1-1]\no1 endwhile\nG0 Y#1", "3:G0X3 3:G0X2 6:G0Y1"},
      {"#1=0\nO2 DO\n#1=[#1+1]\nG0 X#1\nO2 WHILE [#1 LT 3]", "4:G0X1 4:G0X2 4:G0X3"},
      {"#1=2\no1 if [#1 EQ 1]\nG0 X1\no1 elseif [#1 EQ 2]\nG0 X2\no1 else\nG0 X3\no1 endif",
       "5:G0 X2"},
      {"o1 if [0]\nG0 X1\no1 elseif [0]\nG0 X2\no1 else\nG0 X3\no1 endif\nG0 Y1",
       "6:G0 X3 8:G0 Y1"},
      {"o1 if [0]\nG0 X1\no1 endif", ""},
      {"o1 repeat [2]\no2 repeat [2]\nG0 X1\no1 continue\no2 endrepeat\no1 endrepeat\nG0 Y1",
       "3:G0 X1 3:G0 X1 7:G0 Y1"},
      {"#1=0\no1 while [1]\n#1=[#1+1]\no2 if [#1 EQ 3]\no1 break\no2 endif\nG0 X#1\no1 endwhile",
       "7:G0X1 7:G0X2"},
      {"n10 o 1 rep eat [2]\nG0 X1 (o1 endrepeat)\nn20 o01 endrepeat", "2:G0 X1 2:G0 X1"},
      {"o1 repeat [2]\nG0 X1\no1 endrepeat\nM2\nG0 X9", "2:G0 X1 2:G0 X1 4:M2"},
      {"#1=-0.5 G1 X[#1] F1\nG1 X#1 Y[1/3] (text) Z-[2]\no1 if [0]\no1 endif",
       "1:G1X0F1 2:G1X-0.5Y0.3333333Z-2"},
      {"G0 X3\nG91 X1\no1 if [#<_x> EQ 4]\nG0 Y1\no1 endif", "1:G0 X3 2:G91 X1 4:G0 Y1"},
  };
  for (const auto& row : rows) EXPECT_EQ(lines_of(row.text), row.lines) << row.text;
}

TEST(ProgramFlow, CallsSubs) {
  EXPECT_EQ(lines_of("o<Row> sub\n#<n>=[#1+#2]\nG0 X#<n>\no<row> endsub [#<n>*2]\n#1=7\n"
                     "o<row> call [1] [2]\nG0 X#<_value> Y#1 Z[EXISTS[#<n>]]"),
            "3:G0X3 7:G0X6Y7Z0");
  EXPECT_EQ(lines_of("o1 sub\n#31=[#31+1]\n#<_g>=#1\no2 if [#1 GT 0]\no1 call [#1-1]\no1 return\n"
                     "o2 endif\nG0 X#31\no1 endsub\no1 call [3]\nG0 Y#31 Z#<_g>"),
            "8:G0X4 11:G0Y4Z0");
  EXPECT_EQ(lines_of("o5 sub\nG0 X#2\no5 endsub\n#3=2\no[#3+3] call [1] [9]"), "2:G0X9");
  EXPECT_EQ(lines_of("G0 X0\nM98 P100 L2\nG0 X9\nM30\nO100\n#1=[#1+1]\nG0 X#1\nM99"),
            "1:G0 X0 7:G0X1 7:G0X2 3:G0 X9 4:M30");
}

TEST(ProgramFlow, FindsSubsInFilesOfTheFolder) {
  const lamplock::test::TemporaryFolder folder;
  write_file(folder.file("hole.ngc"), "o<hole> sub\nG0 X#1\nG1 Z#1 F9\no<hole> endsub\n");
  const auto lines = flow_of("\no<hole> call [2]\n", folder.file("main.ngc").string());
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].text, "G0X2");
  EXPECT_EQ(lines[1].number, 2u);  // of the call
  EXPECT_THAT(refusal_of("o<../hole> call"), HasSubstr("no sub o<../hole>"));
}

TEST(ProgramFlow, RefusesWithTheLineOfTheFile) {
  const struct {
    const char* text;
    const char* refusal;
  } rows[] = {
      {"o1 if [1]\nG0 X1", "p.ngc:1: 'o1 if' has no end; add o1 endif"},
      {"G0\no1 endwhile", "p.ngc:2: 'o1 endwhile' has no begin here"},
      {"o1 if [1]\no2 endif", "p.ngc:2: 'o2 endif' has no begin here: o1 if is open"},
      {"o1 repeat [1]\no1 break\no1 endrepeat\no1 break", "p.ngc:4: 'o1 break' is in no loop"},
      {"o1 if [1/0]\no1 endif", "p.ngc:1:9: error:72"},
      {"N5 o1 if [1] (a)\n  o2 if [1 / 0]\no2 endif\no1 endif", "p.ngc:2:12: error:72"},
      {"G0 X1\n/ o[1/0] call", "p.ngc:2:6: error:72"},
      {"o1 if 1\no1 endif",
       "p.ngc:1: the value '1' of if is not in square brackets; write 'if [1]'"},
      {"o1 call 5", "p.ngc:1: the value '5' of call is not in square brackets; write 'call [5]'"},
      {"o1 while #1 LT 5\no1 endwhile", "the value '#1lt5' of while is not in square brackets"},
      {"o1 while EXISTS[#<a>]\no1 endwhile", "'exists[#<a>]' of while is not in square brackets"},
      {"o1 if [1]\no1 else 5\no1 endif", "p.ngc:2: else has no value; remove what follows it"},
      {"o1 if\no1 endif", "p.ngc:1: if has 0 values"},
      {"o1 gosub", "p.ngc:1: 'gosub' is no O-word"},
      {"o7 call", "p.ngc:1: there is no sub o7, and no file 7.ngc"},
      {"o1 sub\no1 call\no1 endsub\no1 call", "p.ngc:2: calls are nested more than 10 deep"},
      {"o1 sub\no1 sub\no1 endsub", "p.ngc:2: a sub begins inside of o1 sub"},
      {"o1 return", "p.ngc:1: return is outside of a sub"},
      {"o1 while [1]\no1 endwhile",
       "p.ngc:1: the program has executed 1000000 statements in a row without a line for the "
       "machine, the limit of the host"},
      {"o1 while [1]\nG0\no1 endwhile", "p.ngc:2: the program has more than 1000000 lines"},
      {"M66 P0 L3 Q1\no1 if [#5399 GT 0]\no1 endif", "p.ngc:2: #5399 is not known"},
      {"M98 P7", "p.ngc:1: there is no program O7"},
      {"M99", "p.ngc:1: M99 ends no program"},
      {"M98 P7\nM30\nO7\nG0", "p.ngc:4: the program that M98 called has no end"},
      {"o1 if [1]\nG0 X[#<none>]\no1 endif", "p.ngc:2:6: error:74"},
      {"o1 if [1]\n  G0 (a) Y[#1 + 3] X[1/0]\no1 endif", "p.ngc:2:23: error:72"},
      {"o1 sub\nM73 G0 X[1/0]\no1 endsub\no1 call", "p.ngc:2: error:72"},
  };
  for (const auto& row : rows)
    EXPECT_THAT(refusal_of(row.text), HasSubstr(row.refusal)) << row.text;
}

/// For `check` and `send`, which run the lines again.
TEST(ProgramFlow, LinesKeepThePlacesOfTheirWords) {
  const auto lines = flow_of(
      "o1 sub\nM73 G91 (text) X[2 + 3]\no1 endsub\no1 if [1]\n"
      " #2=4 X[1+1] (a) Y#2 (b)\no1 call\no1 endif\nG0 X1\n");
  ASSERT_GE(lines.size(), 4u);
  EXPECT_EQ(lines[0].text, "X2Y0");
  EXPECT_EQ(column_in_file(lines[0], 1), 7u);
  EXPECT_EQ(column_in_file(lines[0], 3), 18u);
  EXPECT_EQ(lines[1].text, "G91X5");
  EXPECT_EQ(column_in_file(lines[1], 1), 0u) << "without M73 the words are others";
  EXPECT_EQ(column_in_file(lines[2], 1), 0u) << "a line of the host, which restores the modes";
}

TEST(ProgramFlow, ShowsTheMessageOfAnEndOnce) {
  std::string messages;
  for (const link::ProgramLine& line :
       flow_of("o1 sub\nM73 G91\nX1\no1 endsub (MSG, end)\no1 call\nM2\n"))
    messages += line.messages;
  EXPECT_EQ(messages, "(MSG,end)");
}

TEST(ProgramFlow, FindsWhatNeedsIt) {
  for (const char* text : {"o1 sub", "N5 O<a> call [1]", "M98 P1", "G0\nG0 X1 M99", "o[1] call"})
    EXPECT_TRUE(has_flow(text)) << text;
  for (const char* text : {"O1000", "O1000 G90 G21", ":1000", "G1 X1 (o1 sub)", "; o1 sub",
                           "M9 G98", "$H", "#1=5 X#1"})
    EXPECT_FALSE(has_flow(text)) << text;
}

/// Random programs of nested blocks, subs and calls that end.
class FlowPrograms {
 public:
  explicit FlowPrograms(unsigned seed) : random_(seed) {}

  Rs274::Program program() {
    lines_ = {"G21 G90 G94 F100", "G0 X0 Y0 Z0"};
    label_ = 100;
    leaves_loops_ = below(2) == 0;
    for (int number = 1; number <= 20; ++number) lines_.push_back(fmt::format("#{}=0", number));
    lines_.push_back("#31=0 #32=0 #33=0 #<_g>=0");
    for (int sub = 1; sub <= 2; ++sub) {
      lines_.push_back(fmt::format("o{} sub", sub));
      body(2, sub - 1);
      if (below(3) == 0) lines_.push_back(fmt::format("o{} return [{}]", sub, value()));
      body(1, sub - 1);
      lines_.push_back(fmt::format("o{} endsub{}", sub, below(2) ? "" : " [" + value() + "]"));
    }
    body(3, 2);
    return lines_;
  }

 private:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  std::string value() {
    static constexpr const char* names[] = {"#1", "#2", "#3", "#31", "#32", "#<_g>"};
    const std::string name = names[below(6)];
    switch (below(3)) {
      case 0:
        return fmt::format("{}", below(9));
      case 1:
        return name;
      default:
        return fmt::format("{} {} {}", name, below(2) ? "+" : "-", below(5));
    }
  }
  std::string condition() {
    static constexpr const char* operators[] = {"EQ", "NE", "GT", "GE", "LT", "LE"};
    return fmt::format("[[{}] {} [{}]]", value(), operators[below(6)], value());
  }

  void body(int depth, int subs) {
    for (int i = below(3) + 1; i > 0; --i) statement(depth, subs);
  }
  void statement(int depth, int subs) {
    const int kind = depth == 0 ? below(2) : below(7);
    if (kind == 0)
      lines_.push_back(fmt::format("G1 X[{}] Y[{}]", value(), value()));
    else if (kind == 1)
      lines_.push_back(fmt::format("#{}=[{}]", below(2) ? below(3) + 1 : below(2) + 31, value()));
    else if (kind == 2 && subs > 0)
      lines_.push_back(fmt::format("o{} call [{}] [{}]", below(subs) + 1, value(), value()));
    else if (kind == 3)
      branch(depth, subs);
    else
      loop(kind == 5 && leaves_loops_ ? 6 : kind, depth, subs);
  }
  void branch(int depth, int subs) {
    const int label = label_++;
    lines_.push_back(fmt::format("o{} if {}", label, condition()));
    body(depth - 1, subs);
    for (int i = below(3); i > 0; --i) {
      lines_.push_back(fmt::format("o{} elseif {}", label, condition()));
      body(depth - 1, subs);
    }
    if (below(2) == 0) {
      lines_.push_back(fmt::format("o{} else", label));
      body(depth - 1, subs);
    }
    lines_.push_back(fmt::format("o{} endif", label));
  }
  /// A counter of its own, which only this loop changes, ends each loop.
  void loop(int kind, int depth, int subs) {
    const int label = label_++;
    const std::string counter = fmt::format("#{}", 100 + label);
    lines_.push_back(counter + "=0");
    if (kind == 4)
      lines_.push_back(fmt::format("o{} repeat [{}]", label, below(4)));
    else if (kind == 5)
      lines_.push_back(fmt::format("o{} do", label));
    else
      lines_.push_back(fmt::format("o{} while [{} LT {}]", label, counter, below(4)));
    lines_.push_back(fmt::format("{0}=[{0}+1]", counter));
    body(depth - 1, subs);
    // In rs274 break and continue are errors in repeat, and every later do loses its end.
    if (kind == 6 && leaves_loops_ && below(3) != 0) {
      const int inner = label_++;
      lines_.push_back(fmt::format("o{} if {}", inner, condition()));
      lines_.push_back(fmt::format("o{} {}", label, below(2) ? "break" : "continue"));
      lines_.push_back(fmt::format("o{} endif", inner));
      body(depth - 1, subs);
    }
    if (kind == 4)
      lines_.push_back(fmt::format("o{} endrepeat", label));
    else if (kind == 5)
      lines_.push_back(fmt::format("o{} while [{} LT {}]", label, counter, below(4)));
    else
      lines_.push_back(fmt::format("o{} endwhile", label));
  }

  std::mt19937 random_;
  Rs274::Program lines_;
  int label_ = 100;
  bool leaves_loops_ = false;  ///< by break and continue; else it has do
};

/// "X1.0000 Y2.0000" of each move.
std::string places_of(const std::vector<CanonicalMove>& moves) {
  std::string text;
  for (const CanonicalMove& move : moves)
    text += fmt::format("{:.4f} {:.4f}\n", move.to_mm[0] + 0.0, move.to_mm[1] + 0.0);
  return text;
}

TEST(ProgramFlow, MovesAsLinuxCnc) {
  if (!Rs274::available()) GTEST_SKIP() << "rs274 is not unpacked";
  std::size_t moves = 0;
  for (int i = 0; i < lamplock::test::scaled(30, 15); ++i) {
    const Rs274::Program program = FlowPrograms(static_cast<unsigned>(i)).program();
    std::string text;
    for (const std::string& line : program) text += line + "\n";
    Rs274 theirs, ours;
    const auto wanted = theirs.run_whole(program);
    Rs274::Program plain;
    for (const link::ProgramLine& line : flow_of(text)) plain.push_back(line.text);
    ASSERT_EQ(wanted.refusal, "") << text;
    ASSERT_EQ(places_of(ours.run_whole(plain).moves), places_of(wanted.moves)) << text;
    moves += wanted.moves.size();
  }
  EXPECT_GT(moves, 100u);
}

}  // namespace
}  // namespace lamplock::program_run
