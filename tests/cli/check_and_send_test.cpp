// `lamplock check` and `lamplock send` judge the lines of a program alike, with the same text.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Expects that both refuse a program with this text about this place, FILE:LINE or
/// FILE:LINE:COLUMN.
void expect_both_refuse(const std::string& program, const std::string& place,
                        const std::string& what, const std::string& remedy = "") {
  const Folder folder;
  const std::string file = folder.write("p.ngc", program);
  const Finished sent = run({"send", file, "--board", "virtual"});
  Finished checked = run({"check", file});
  checked.out += checked.err;
  EXPECT_EQ(checked.status, 2) << program;
  EXPECT_EQ(sent.status, 2) << program;
  EXPECT_THAT(checked.out, HasSubstr(file + place + ":")) << program;
  EXPECT_THAT(sent.err, HasSubstr(file + place + ":")) << program;
  EXPECT_THAT(checked.out, HasSubstr(what)) << program;
  EXPECT_THAT(sent.err, HasSubstr(what)) << program;
  EXPECT_THAT(checked.out, HasSubstr(remedy)) << program;
  EXPECT_THAT(sent.err, HasSubstr(remedy)) << program;
}

TEST(CheckAndSend, RefuseTheSameBoardLines) {
  for (const std::string line : {"$J=G91 X1 F100", "$10=1", "$C", "$SLP", "$FOO", "$ j=x1", "$HXY",
                                 "$N0=G21", "$RST=*", "$32"})
    expect_both_refuse("G21\n" + line + "\nG4 P0.01\n", ":2",
                       "'" + line + "' must not be in a program");
  for (const std::string line : {"$", "$$", "$#", "$G", "$I", "$N", "$X", "$x", "$ G"}) {
    const Folder folder;
    const std::string file = folder.write("p.ngc", "G21\n" + line + "\nG4 P0.01\n");
    EXPECT_EQ(run({"check", file}).status, 0) << line;
    EXPECT_EQ(run({"send", file, "--board", "virtual"}).status, 0) << line;
  }
}

TEST(CheckAndSend, RefuseTheSameBytes) {
  for (const auto& [byte, name] :
       {std::pair{'\x18', "0x18"}, std::pair{'!', "0x21"}, std::pair{'~', "0x7E"},
        std::pair{'?', "0x3F"}, std::pair{'\x84', "0x84"}, std::pair{'\x7f', "0x7F"}}) {
    const std::string what = std::string("the byte ") + name + " outside of a comment";
    expect_both_refuse(std::string("G21\nG1 X1 F100") + byte + "\n", ":2", what);
    expect_both_refuse(std::string("G21\n$X") + byte + "\n", ":2", what);
    const Folder folder;
    const std::string file = folder.write("p.ngc", std::string("G4 P0.01 (a") + byte + ")\n");
    EXPECT_EQ(run({"check", file}).status, 0) << name;
    EXPECT_EQ(run({"send", file, "--board", "virtual"}).status, 0) << name;
  }
}

/// The word at fault, and what to do. The column is that of the file, before which a comment may
/// be.
TEST(CheckAndSend, NameTheWordAndARemedy) {
  struct Case {
    std::string line, column, what, remedy;
  };
  const std::string control = ": loops, branches and calls in this form are not read";
  const std::string without = "; write O-words or M98";
  for (const Case& c : std::initializer_list<Case>{
           {"G43 H1", "5", "error:95 'H1': the tool table does not have this tool", "G10 L1"},
           {"G1 X1 g 33", "7", "error:20 'g 33' is not supported", "; take the word out"},
           {"G41", "1", "error:91 the diameter of the tool is not known", "G41.1 D"},
           {"M84", "1", "error:20 'M84' is not supported", "; take the word out: $1 switches"},
           {"M104 S200", "1", "error:20 'M104' is not supported", "has no heater"},
           {"G33 Z1 K1", "1", "error:20 'G33' is not supported", "; take the word out"},
           {"G1 B5 F100", "4", "error:20 'B5' is for an axis that the machine does not have",
            "; take the word out: its axes are X, Y, Z"},
           {"G1 X1 A-1.5", "7", "error:20 'A-1.5' is for an axis", "its axes are X, Y, Z"},
           {"G1 X#<wide>", "5", "error:74 '#<wide>': no value has been assigned to this name",
            "; write '#<wide> = 0' with its value before this line"},
           {"G1 (a) X[1/0] F1", "11", "error:72 division by zero", "; correct "},
           {"#1=[2", "4", "error:75 the expression is incomplete", "; correct "},
           {"WHILE [#1 LT 5] DO1", "1", "error:2 'WHILE'" + control, without},
           {"IF [1 EQ 1] THEN", "1", "error:2 'IF'" + control, without},
           {"N1 G1 X5*22", "9", "error:1 '*22': line checksums are not read",
            "; switch them off in the sender"},
           {" \tG1 X5 *22", "9", "error:1 '*22': line checksums are not read", "; switch them off"},
           {"G1 X1,5", "6", "error:1 ','", "; write numbers with a decimal point"},
           {"G1 @ X1", "4", "error:1 a word must begin with a letter, not with '@'",
            "; take it out"},
           {"(a) (b) HELLO", "9", "error:2 the number after 'H' is missing",
            "; correct the number"}}) {
    expect_both_refuse("G21 (units)\n" + c.line + "\n", ":2:" + c.column, c.what, c.remedy);
  }
}

/// A command without a word that it needs: in plain programs and in those with O-words.
TEST(CheckAndSend, NameTheMissingWord) {
  struct Case {
    std::string lines, missing;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"G41.1", "'G41.1' needs a D word (the diameter of the cutter)"},
           {"X1 G42.1", "'G42.1' needs a D word (the diameter of the cutter)"},
           {"G43.2", "'G43.2' needs an H word (the number of the tool)"},
           {"G4 (dwell)", "'G4' needs a P word (the dwell in seconds)"},
           {"G10 X1 P1", "'G10' needs an L word (what it sets: 1, 2, 10, 11 or 20)"},
           {"M61", "'M61' needs a Q word (the number of the tool in the spindle)"},
           {"G81 X1 Z-1 F100", "'G81' needs an R word (the level at which the feed begins)"},
           {"G18 G81 X1 Z1 R1 F100", "'G81' needs a Y word (the bottom of the hole)"},
           {"G83 X1 R1 F100",
            "'G83' needs a Z word (the bottom of the hole) and a Q word (the depth of a peck)"},
           // Cycles keep their words, others begin without them.
           {"G81 X1 Z-1 R1 F100\nX2\nG82 X3 P1 Z-1",
            "'G82' needs an R word (the level at which the feed begins)"},
           {"G5 X1 I1 J1 P1 F100", "'G5' needs a Q word (the second control point in Y)"},
           {"G5 X1 I1 J1 P1 Q1 F100\nX2 P1", "'G5' needs a Q word (the second control point in Y)"},
           {"G5.2 X1 F100", "'G5.2' needs a Y word (the place of the control point)"},
           {"G[41]", "error:91 "},
           // The number of the command is an expression.
           {"G[41.1]", "error:28 a word is missing: "},
       }) {
    const auto ends = std::count(c.lines.begin(), c.lines.end(), '\n');
    const std::string place = fmt::format(":{}", ends + 2);
    expect_both_refuse("G21\n" + c.lines + "\n", place, c.missing);
  }
  const Folder folder;
  const std::string file = folder.write("p.ngc", "o1 sub\nG41.1\no1 endsub\no1 call\n");
  EXPECT_THAT(run({"check", file}).out, HasSubstr(":2:1: error:28 'G41.1' needs a D word"));
}

/// Words that the machine has, at a place where they must not be.
TEST(CheckAndSend, NameWhatExcludesAWord) {
  struct Case {
    std::string lines, what, remedy;
  };
  const std::string cycle_levels = "; R is the level at which the feed begins";
  const std::string range =
      " is too large: the numbers of a program are between -1000000000 and 1000000000";
  for (const Case& c : std::initializer_list<Case>{
           {"G41 D-2", ":5: error:20 'D-2': the number of a tool must not be negative", "; write"},
           {"G43 H-1", ":5: error:20 'H-1': the number of a tool must not be negative", "; write"},
           {"G42.1 D-2", ":7: error:20 'D-2': a diameter must not be negative",
            "; write it without its sign: G41.1 is left"},
           {"G41 D2.5", ":5: error:23 'D2.5': the value must be a whole number", "; "},
           {"G41 D99", ":5: error:95 'D99': the tool table does not have this tool", "G10 L1"},
           {"M72", ":1: error:20 'M72' restores a modal state, and no M70 has saved one",
            "; write M70"},
           {"M70\nM71\nM72", ":1: error:20 'M72' restores a modal state", "; write M70"},
           {"G5.2 X1 Y1 F100\nX2 Y2\nX3 Y1\nM2",
            ":1: error:20 'M2' must not be within a NURBS, which lasts from G5.2 to G5.3",
            "; write G5.3"},
           {"G1 X1000000000 F1", ":4: error:2 'X1000000000'" + range, "; correct the number"},
           {"#1=1000000000.5", ":4: error:2 '1000000000.5'" + range, "; correct the number"},
           {"#1=[2+01234567890]", ":7: error:2 '01234567890'" + range, "; correct the number"},
           {"#1=EXISTS[#1]", ":10: error:75 'EXISTS[#1]': EXISTS asks for a name, EXISTS[#<name>]",
            "; write a name"},
           {"G81 X1 Z5 R1 F1",
            ":8: error:33 the bottom of the hole, Z5, is above the retract level R1",
            cycle_levels + ", and Z the bottom below it"},
           {"G81 X1 Z-5 R1 F1\nX2 R-7",
            ":4: error:33 the bottom of the hole, Z-5, is above the retract level R-7",
            cycle_levels},
           {"G18 G81 X1 Z1 Y5 R1 F1",
            ":15: error:33 the bottom of the hole, Y5, is above the retract level R1",
            cycle_levels + ", and Y the bottom below it"},
           {"G91 G81 X1 Z5 R1 F1", ":12: error:33 Z5 is above the retract level R: in G91",
            "; write a negative Z"},
           {"G81 X20000 Z-1 R1 F1", ":5: error:33 the target cannot be reached", "; "},
           {"G18 G5.1 X1 I1 F1",
            ":5: error:20 'G5.1': curves of G5 to G5.3 are in the plane of G17", "; write G17"},
           {"G93 G81 X1 Z-1 R1 F1", ":5: error:20 'G81': a cycle has no time of its own",
            "; write G94"},
           {"G93\nG41.1 D1", ":1: error:90 cutter compensation (G41, G42) is not possible with G93",
            "; write G94"},
           {"G93 G41.1 D1", ":5: error:90 cutter compensation (G41, G42) is not possible with G93",
            "; write G94"},
           {"G1 F60\nG41.1 D1\nG93 X5 F1", ":5: error:90 cutter compensation (G41, G42) is not",
            "; write G40 before it"},
           {"G53 G0 G41.1 D1 X5", ":1: error:90 'G53' is not possible in a line that begins cutter",
            "; write G41 or G42 in"},
           {"M0 G41.1 D1", ":1: error:90 'M0' is not possible in a line that begins cutter",
            "; write G41 or G42 in"},
           {"G41.1 D1\nG10 L2 P1 X1", ":1: error:90 not possible while cutter compensation", ""},
           {"G10 L20 P1 R10", ":12: error:20 'R10': only G10 L1, L10, L11 and L2 have an R word",
            "; rotate the coordinate system with G10 L2 P R"},
           {"G10 L3 P1 X1", ":5: error:20 'L3': G10 has L1, L2, L10, L11 and L20", "; correct"},
       })
    expect_both_refuse(c.lines + "\n",
                       fmt::format(":{}", std::count(c.lines.begin(), c.lines.end(), '\n') + 1),
                       c.what, c.remedy);
  const Folder folder;
  // One fault, one message.
  const std::string file = folder.write("p.ngc", "G5.2 X1 Y1 F100\nX2 Y2\nM2\n");
  EXPECT_THAT(run({"check", file}).err, HasSubstr("1 line is wrong"));
}

TEST(CheckAndSend, RunLoopsAndSubroutines) {
  const Folder folder;
  const std::string file = folder.write(
      "p.ngc", "o1 sub\nG0 X#1\no1 endsub\no2 repeat [3]\no1 call [2]\no2 endrepeat\nM2\n");
  EXPECT_EQ(run({"check", file}).status, 0);
  const Finished sent = run({"send", file, "--board", "virtual"});
  EXPECT_EQ(sent.status, 0) << sent.err;
  EXPECT_THAT(sent.out + sent.err, HasSubstr("4 of 4 lines"));
  expect_both_refuse("G21\nN5 M98 P100\n", ":2", "there is no program O100",
                     "; write it after M30");
  expect_both_refuse("G21\no100 sub\n", ":2", "'o100 sub' has no end", "; add o100 endsub");
}

/// By the board, and by the host in a program with O-words.
TEST(CheckAndSend, ShowMessagesWithValues) {
  const Folder folder;
  const std::string program =
      "(PRINT,%d#5220)\n$X\nG21 G55\n#1=2.25 #<_wide>=-3\nG0 X1\n(MSG, turn #1)\n(DEBUG, wide "
      "%.1f#1 #<_none>)\n"
      "G0 X2 (print,%d#<_Wide>|%lf#1)\n(PRINT, last #1)\n#1=7 (MSG, hi)\n(MSG, "
      "stop)\n#2=4\n(PRINT,#1)\n";
  for (const std::string end : {"", "o1 if [1]\no1 endif\n"}) {
    const std::string file = folder.write("p.ngc", program + end);
    EXPECT_EQ(run({"check", file}).status, 0);
    const Finished sent = run({"send", file, "--board", "virtual"});
    EXPECT_EQ(sent.status, 0) << sent.err;
    std::vector<std::string> messages;
    for (const std::string& line : lines(sent.err))
      if (line.starts_with("machine: ")) messages.push_back(line.substr(9));
    EXPECT_THAT(messages, testing::ElementsAre("1", "turn #1", "wide 2.2 #<_none>", "-3|2.250000",
                                               "last 2.250000", "hi", "stop", "7.000000"))
        << end;
  }
}

/// The texts of the messages that `send` shows for a program.
std::vector<std::string> shown_messages(const std::string& program,
                                        const std::vector<std::string>& options = {}) {
  const Folder folder;
  std::vector<std::string> arguments{"send", folder.write("p.ngc", program), "--board", "virtual"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Finished sent = run(arguments);
  EXPECT_EQ(sent.status, 0) << sent.err;
  std::vector<std::string> messages;
  for (const std::string& line : lines(sent.err))
    if (line.starts_with("machine: ") && line != "machine: Pgm End")
      messages.push_back(line.substr(9));
  return messages;
}

/// A line of the board has no room for them together.
TEST(CheckAndSend, LoseNoMessage) {
  const std::string a(100, 'a'), b(100, 'b'), c(100, 'c');
  const std::string three = fmt::format("(MSG, {})\n(MSG, {})\n(MSG, {})\n", a, b, c);
  const std::string beside = fmt::format("G1 X1 F600 (MSG, {}) (MSG, {}) (MSG, {})\nM2\n", a, b, c);
  for (const std::string begin : {"", "o1 if [1]\no1 endif\n"}) {
    EXPECT_THAT(shown_messages(begin + three + "G1 X1 F600\nM2\n"), testing::ElementsAre(a, b, c));
    EXPECT_THAT(shown_messages(begin + beside), testing::ElementsAre(a, b, c));
    EXPECT_THAT(
        shown_messages(begin + "G21\n(MSG, a)\nM3 S9 (MSG, b)\nG1 X1 F600\n(MSG, c)\n", {"--dry"}),
        testing::ElementsAre("a", "b", "c"));
  }
  constexpr int count = 40;
  std::vector<std::string> numbers;
  numbers.reserve(count);
  for (int i = 0; i < count; ++i) numbers.push_back(fmt::format("n {}", i));
  EXPECT_THAT(shown_messages("G21\n#1=0\no1 repeat [40]\n(PRINT, n %d#1)\n#1=[#1+1]\no1 endrepeat\n"
                             "G1 X1 F600\n"),
              testing::ElementsAreArray(numbers));
  EXPECT_THAT(shown_messages("#1=0\nG21\n(MSG, begin)\no1 while [#1 lt 3]\n#1=[#1+1]\no1 endwhile\n"
                             "(MSG, end)\n"),
              testing::ElementsAre("begin", "end"));
  EXPECT_THAT(shown_messages("o1 if [1]\nG21\n(MSG, a)\n$X\no1 endif\n"),
              testing::ElementsAre("a"));
}

TEST(CheckAndSend, RefuseUtf16) {
  const std::string program = "G21\nG1 X1 F100\n";
  for (const bool high_first : {false, true}) {
    for (const bool marked : {false, true}) {
      std::string text;
      if (marked) text = high_first ? "\xFE\xFF" : "\xFF\xFE";
      for (const char c : program) text += high_first ? std::string{'\0', c} : std::string{c, '\0'};
      expect_both_refuse(text, "", "the text is UTF-16", "; save it as UTF-8");
    }
  }
}

TEST(CheckAndSend, RefuseAFileWithoutALineToRun) {
  const Folder folder;
  for (const std::string text : {"\n", "(nothing)\n", "%\n; a\n%\n", " \t\n(a) (b)\n"}) {
    const std::string file = folder.write("p.ngc", text);
    for (const Finished& done : {run({"check", file}), run({"send", file, "--board", "virtual"})}) {
      EXPECT_EQ(done.status, 2) << text;
      EXPECT_THAT(done.err, HasSubstr("p.ngc: has no line to send; is this the right file?"));
    }
  }
}

TEST(CheckAndSend, RefuseOWordsThatLeadToNoLine) {
  const Folder folder;
  for (const std::string text : {"o1 if [0]\nG0 X1\no1 endif\n", "o1 sub\nG0 X1\no1 endsub\n"}) {
    const std::string file = folder.write("p.ngc", text);
    for (const Finished& done : {run({"check", file}), run({"send", file, "--board", "virtual"})}) {
      EXPECT_EQ(done.status, 2) << text;
      EXPECT_THAT(done.err, HasSubstr("p.ngc: its O-words lead to no line for the machine; check"));
    }
  }
  const std::string file = folder.write("p.ngc", "o1 if [1]\n(MSG, a)\no1 endif\n");
  EXPECT_EQ(run({"check", file}).status, 0);
  EXPECT_THAT(run({"send", file, "--board", "virtual"}).err, HasSubstr("machine: a"));
}

/// A machine that sleeps does not answer.
TEST(CheckAndSend, SleepIsNeverSent) {
  const Folder folder;
  for (const std::string text : {"$SLP\n", "$X\n$ slp\n", "G4 P0.01\n$SLP\n"}) {
    const std::string file = folder.write("p.ngc", text);
    const Finished sent = run({"send", file, "--board", "virtual", "--ignore-errors"});
    EXPECT_EQ(sent.status, 2) << text;
    EXPECT_THAT(sent.err, HasSubstr("must not be in a program, nothing was sent; take it out"));
    EXPECT_EQ(run({"check", file}).status, 2) << text;
  }
}

/// Time, bounds and errors are those of all lines, as `send` runs them.
TEST(CheckAndSend, LinesAfterTheEndAreRun) {
  const Folder folder;
  for (const std::string end : {"M2", "M30"}) {
    const std::string before = "G21 G90\nG1 X10 F600\n", after = "G1 X-20 F600\nG4 P0.5\n";
    const auto seen = [&](const std::string& text) {
      const Finished done = run({"check", folder.write("p.ngc", text), "--json"});
      EXPECT_EQ(done.status, 0) << done.err;
      return nlohmann::json::parse(done.out);
    };
    const nlohmann::json whole = seen(fmt::format("{}{}\n{}", before, end, after));
    EXPECT_NEAR(whole["feed_mm"].get<double>(), 40, 1e-9);
    EXPECT_NEAR(whole["low_mm"][0].get<double>(), -20, 1e-9);
    EXPECT_NEAR(whole["time_s"].get<double>(),
                seen(fmt::format("{}G4 P0\n{}", before, after))["time_s"].get<double>(), 1e-3);
    EXPECT_EQ(whole["ended"], true);
    expect_both_refuse(fmt::format("{}{}\nG1 X1 X2 F100\n", before, end), ":4",
                       "the word occurs twice");
    expect_both_refuse(fmt::format("{}{}\nG1 X60 F100\n", before, end), ":4",
                       "X 60.000 mm is outside");
  }
}

/// Comments of any length are dropped; columns count them.
TEST(CheckAndSend, DropLongComments) {
  const Folder folder;
  constexpr std::size_t columns_of_16_bits = 65'536;
  for (const std::size_t length :
       {std::size_t{300}, columns_of_16_bits - 8, columns_of_16_bits, columns_of_16_bits + 5'000}) {
    const std::string text(length, 'a');
    for (const std::string& line : {fmt::format("G0X1 ({})", text), fmt::format("G0X1 ;{}", text),
                                    fmt::format("G0X1 (MSG, {})", text)}) {
      const std::string file = folder.write("p.ngc", line + "\nX3\n");
      const Finished checked = run({"check", file, "--json"});
      EXPECT_EQ(checked.status, 0) << length << checked.out.substr(0, 300);
      EXPECT_EQ(run({"jerk", file, "-o", folder / "o.ngc"}).status, 0) << length;
    }
    const std::string wrong = fmt::format("G0 X1\n({}) G1 X2 X3 F100\n", text);
    expect_both_refuse(wrong, fmt::format(":2:{}", length + 10), "the word occurs twice");
    const std::string digits(length, '0');
    expect_both_refuse(fmt::format("G0 X{}1\nG0 X2\n", digits), ":1", "error:11");
    const std::string file = folder.write("p.ngc", fmt::format("G0 X{}1\nG0 X2\n", digits));
    EXPECT_EQ(run({"jerk", file, "-o", folder / "o.ngc"}).status, 2) << length;
  }
}

/// The place where the board is does not make a wrong line valid.
TEST(CheckAndSend, RefuseArcsToTheirStart) {
  for (const std::string before : {"", "G1 X8 F1000\nG1 X0\n"}) {
    const std::string place = before.empty() ? ":1" : ":3";
    expect_both_refuse(before + "G2 X0 Y0 R5 F1000\nG1 X9\n", place, "error:33");
    expect_both_refuse(before + "G38.2 X0 F100\n", place, "error:33");
  }
}

/// Of the line that was refused on the board, and of the one before it.
TEST(CheckAndSend, NameTheLastLineThatWasAccepted) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", "G0 X1\nG0 X2\nG2 X2 Y0 R5 F1000\n");
  const Finished sent = run({"send", file, "--board", "virtual", "--ignore-errors", "--json"});
  EXPECT_EQ(sent.status, 1);
  EXPECT_EQ(nlohmann::json::parse(sent.out)["last_line"], 2) << sent.out;
}

/// Lines before the one that raises an alarm are executed: the end is reported at rest.
TEST(CheckAndSend, AnAlarmIsReportedAtRest) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", "G1 X20 F1200\nG0 X9999\nG1 X2\n");
  const Finished sent = run({"send", file, "--board", "virtual", "--ignore-errors", "--json"});
  EXPECT_EQ(sent.status, 1) << sent.err;
  const auto document = nlohmann::json::parse(sent.out);
  EXPECT_EQ(document["end"], "alarm");
  EXPECT_EQ(document["state"], "Alarm");
  EXPECT_EQ(document["position"][0], 20.0);
  EXPECT_THAT(sent.err, HasSubstr("line 1 of " + file + " was the last one that it accepted"));
}

}  // namespace
}  // namespace lamplock::cli::test
