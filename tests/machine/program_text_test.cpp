// The machine's reports of its program, byte for byte as in grbl 1.1.
#include "firmware/machine/console/program_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "tests/scale.hpp"

namespace lamplock::machine {
namespace {

using program::Interpreter;
using program::Modal;

std::string modes(const Modal& modal, bool inches = false) {
  TextLine line;
  write_modes(line, modal, inches);
  return std::string(line.view());
}

struct Program {
  explicit Program(std::initializer_list<const char*> lines = {}) {
    options.probe = true;
    for (const char* line : lines) run(line);
  }
  void run(const std::string& line) {
    EXPECT_FALSE(interpreter.run(line)) << line;
    program::Action action;
    while (interpreter.next(action)) {
    }
  }
  std::string modes() const { return machine::modes(interpreter.modal()); }
  std::string offset(int i, int axes = 3, InchAxes inches = {}) const {
    TextLine line;
    write_offset(line, i, {parameters, interpreter.modal(), probe, axes, inches});
    return std::string(line.view());
  }

  program::Parameters parameters;
  program::Options options;
  ProbeResult probe;
  Interpreter interpreter{parameters, options};
};

TEST(ProgramText, ModesAfterPowerUpAreThoseOfGrbl) {
  EXPECT_EQ(modes({}), "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\n");
  EXPECT_EQ(modes({}, true), "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0.0 S0]\r\n");
}

TEST(ProgramText, ModesAreInTheOrderOfGrbl) {
  const Program p{"M7", "G55 G18 G20 G91 G93 M3 M8 T12 S1000.4 G1 X1 F60"};
  EXPECT_EQ(p.modes(), "[GC:G1 G55 G18 G20 G91 G93 M3 M7 M8 T12 F0 S1000]\r\n");
  EXPECT_EQ(Program({"M4 M7 S0.5 F1234.5 G19"}).modes(),
            "[GC:G0 G54 G19 G21 G90 G94 M4 M7 T0 F1235 S1]\r\n");
  EXPECT_EQ(Program({"M8 G2 X1 I0.5 F1"}).modes(),
            "[GC:G2 G54 G17 G21 G90 G94 M5 M8 T0 F1 S0]\r\n");
}

TEST(ProgramText, EveryMotionAndSystemHasItsName) {
  const std::vector<std::pair<const char*, const char*>> motions{{"G0", "G0"},
                                                                 {"G1 F1", "G1"},
                                                                 {"G2 X1 I0.5 F1", "G2"},
                                                                 {"G3 X1 R1 F1", "G3"},
                                                                 {"G5 X1 I1 J1 P-1 Q0 F1", "G5"},
                                                                 {"G5.1 X1 I1 J1 F1", "G5.1"},
                                                                 {"G38.2 X1 F1", "G38.2"},
                                                                 {"G38.3 X1 F1", "G38.3"},
                                                                 {"G38.4 X1 F1", "G38.4"},
                                                                 {"G38.5 X1 F1", "G38.5"},
                                                                 {"G80", "G80"},
                                                                 {"G81 Z-1 R1 F1", "G81"},
                                                                 {"G82 Z-1 R1 P1 F1", "G82"},
                                                                 {"G83 Z-1 R1 Q1 F1", "G83"},
                                                                 {"G73 Z-1 R1 Q1 F1", "G73"}};
  for (const auto& [line, name] : motions)
    EXPECT_EQ(Program({line}).modes().substr(0, std::string(name).size() + 9),
              std::string("[GC:") + name + " G54 ");
  for (const char* system : {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"})
    EXPECT_EQ(Program({system}).modes(),
              std::string("[GC:G0 ") + system + " G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\n");
}

TEST(ProgramText, ModesUnknownToGrblAreReportedOnlyIfNotDefault) {
  EXPECT_EQ(Program({"G90.1 G61.1 G99", "G43.1 Z2", "G68 R30", "M130 P1"}).modes(),
            "[GC:G0 G54 G17 G21 G90 G94 G90.1 G61.1 G43.1 G99 G68 M5 M9 M130 T0 F0 S0]\r\n");
  EXPECT_EQ(Program({"G64 P0.1"}).modes(), "[GC:G0 G54 G17 G21 G90 G94 G64 M5 M9 T0 F0 S0]\r\n");
  EXPECT_EQ(Program({"G90.1 G64 P1 G99", "G43.1 Z2", "G68 R30", "M130 P0", "G91.1 G61 G98", "G49",
                     "G69", "M131"})
                .modes(),
            modes({}));
}

TEST(ProgramText, FeedIsReportedInTheUnitsOfReports) {
  Modal modal;
  modal.feed = 254'000;  // um/min
  EXPECT_NE(modes(modal).find(" F254 "), std::string::npos);
  EXPECT_NE(modes(modal, true).find(" F10.0 "), std::string::npos);
  modal.feed = 26'670;  // 1.05 in/min
  EXPECT_NE(modes(modal, true).find(" F1.1 "), std::string::npos);
  modal.feed = 4'294'967'295;
  EXPECT_NE(modes(modal).find(" F4294967 "), std::string::npos);
  EXPECT_NE(modes(modal, true).find(" F169093.2 "), std::string::npos);
  const Program p{"G95 F0.1235"};
  EXPECT_NE(p.modes().find(" G95 M5 M9 T0 F0.124 "), std::string::npos) << p.modes();
  EXPECT_NE(modes(p.interpreter.modal(), true).find(" F0.0049 "), std::string::npos);
}

/// The words as parsed by a sender.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line.substr(4, line.size() - 7));
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

TEST(ProgramText, TheReportIsTheStateAndCanBeRead) {
  // CNCjs ignores a line with any other letter, a sign or an empty word.
  const std::regex shape(R"(\[GC:[GMTFS][0-9]+(\.[0-9]+)?( [GMTFS][0-9]+(\.[0-9]+)?)*\]\r\n)");
  const std::vector<std::vector<const char*>> codes{{"G0", "G80", "G1"},
                                                    {"G17", "G18", "G19"},
                                                    {"G21"},
                                                    {"G90", "G91"},
                                                    {"G94"},
                                                    {"G90.1", "G91.1"},
                                                    {"G61", "G61.1"},
                                                    {"G98", "G99"},
                                                    {"G54", "G58", "G59", "G59.1", "G59.3"},
                                                    {"M3", "M4", "M5"},
                                                    {"M7", "M8", "M9"},
                                                    {"M7", "M8", "M9"},
                                                    {"T0", "T255", "T7"},
                                                    {"F1", "F100", "F4000000"},
                                                    {"S0", "S1000", "S4000000"},
                                                    {"M131", "M130 P0"}};
  std::mt19937_64 random(5100);
  for (int i = 0; i < test::scaled(2000); ++i) {
    Program first{"F60"};
    for (const auto& group : codes)
      if (random() % 2 == 0) first.run(group[random() % group.size()]);
    const std::string text = first.modes();
    ASSERT_TRUE(std::regex_match(text, shape)) << text;
    Program second;
    std::vector<std::string> words = words_of(text);
    // F is set first because G1 requires a feed; the kind of lock of M130 is not reported.
    std::stable_partition(words.begin(), words.end(), [](auto& word) { return word[0] == 'F'; });
    for (const std::string& word : words) second.run(word == "M130" ? "M130 P0" : word);
    ASSERT_EQ(second.interpreter.modal(), first.interpreter.modal()) << text;
  }
}

TEST(ProgramText, OffsetsAreInTheOrderOfGrbl) {
  const Program p;
  std::string all;
  for (int i = 0; i < offset_lines; ++i) all += p.offset(i);
  EXPECT_EQ(all,
            "[G54:0.000,0.000,0.000]\r\n[G55:0.000,0.000,0.000]\r\n[G56:0.000,0.000,0.000]\r\n"
            "[G57:0.000,0.000,0.000]\r\n[G58:0.000,0.000,0.000]\r\n[G59:0.000,0.000,0.000]\r\n"
            "[G59.1:0.000,0.000,0.000]\r\n[G59.2:0.000,0.000,0.000]\r\n"
            "[G59.3:0.000,0.000,0.000]\r\n[G28:0.000,0.000,0.000]\r\n[G30:0.000,0.000,0.000]\r\n"
            "[G92:0.000,0.000,0.000]\r\n[TLO:0.000]\r\n[PRB:0.000,0.000,0.000:0]\r\n");
}

TEST(ProgramText, ToolsFollowTheProbeAsInGrblHal) {
  Program p{"G10 L1 P12 Z-41.25 R3.175", "G10 L1 P1 R1"};
  EXPECT_EQ(p.offset(probe_line + 1), "[T:12|0.000,0.000,-41.250|3.175]\r\n");
  EXPECT_EQ(p.offset(probe_line + 2, 4, {0xf}), "[T:1|0.0000,0.0000,0.0000,0.0000|0.0394]\r\n");
  EXPECT_EQ(p.offset(probe_line + 3), "");
}

TEST(ProgramText, RotationsAreDegreesOfAllSystems) {
  EXPECT_EQ(Program{}.offset(rotation_line), "");
  Program p{"G10 L2 P1 R30", "G10 L2 P4 R-12.5", "G20 G10 L2 P9 R0.0000001"};
  EXPECT_EQ(p.offset(rotation_line), "[ROT:30,0,0,-12.5,0,0,0,0,0.0000001]\r\n");
  p.run("G10 L2 P1 R0");
  EXPECT_EQ(p.offset(rotation_line), "[ROT:0,0,0,-12.5,0,0,0,0,0.0000001]\r\n");
}

TEST(ProgramText, TheToolInTheSpindleIsNotThatOfTheNextChange) {
  EXPECT_EQ(Program{}.offset(spindle_line), "");
  EXPECT_EQ(Program({"T2"}).offset(spindle_line), "[TOOL:0]\r\n");
  EXPECT_EQ(Program({"M61 Q1", "T2"}).offset(spindle_line), "[TOOL:1]\r\n");
  EXPECT_EQ(Program({"T200 M6", "T0"}).offset(spindle_line), "[TOOL:200]\r\n");
}

TEST(ProgramText, OffsetsEqualTheirSettings) {
  Program p{"G10 L2 P1 X1 Y-2.5 Z0.0004",
            "G10 L2 P6 Y1",
            "G10 L2 P7 X7",
            "G10 L2 P9 Z-9.9996",
            "G0 X3 Y4 Z5",
            "G28.1",
            "G0 X6",
            "G30.1",
            "G92 X0",
            "G43.1 Z-1.5"};
  p.probe = {{10'000'000, 20'000'000, -30'000'000, 5'000}, true};
  EXPECT_EQ(p.offset(0), "[G54:1.000,-2.500,0.000]\r\n");
  EXPECT_EQ(p.offset(5), "[G59:0.000,1.000,0.000]\r\n");
  EXPECT_EQ(p.offset(6), "[G59.1:7.000,0.000,0.000]\r\n");
  EXPECT_EQ(p.offset(8), "[G59.3:0.000,0.000,-10.000]\r\n");
  EXPECT_EQ(p.offset(9), "[G28:4.000,1.500,5.000]\r\n");
  EXPECT_EQ(p.offset(10), "[G30:7.000,1.500,5.000]\r\n");
  EXPECT_EQ(p.offset(11), "[G92:6.000,0.000,0.000]\r\n");
  EXPECT_EQ(p.offset(12), "[TLO:-1.500]\r\n");
  EXPECT_EQ(p.offset(13), "[PRB:1.000,2.000,-3.000:1]\r\n");
  EXPECT_EQ(p.offset(13, 4), "[PRB:1.000,2.000,-3.000,0.001:1]\r\n");
  EXPECT_EQ(p.offset(0, 4, {0x7}), "[G54:0.0394,-0.0984,0.0000,0.000]\r\n");
  EXPECT_EQ(p.offset(0, 4, {0xf}), "[G54:0.0394,-0.0984,0.0000,0.0000]\r\n");
  EXPECT_EQ(p.offset(12, 1, {0xf}), "[TLO:-0.0591]\r\n");
}

TEST(ProgramText, OffsetsAddUpToTheWorkOffset) {
  Program p{"G10 L2 P1 Z1", "G92 Z-2", "G43.1 Z4"};
  const auto z = [&p](int i) {
    const std::string text = p.offset(i);
    return std::stod(text.substr(text.find_last_of(i == 12 ? ":" : ",") + 1));
  };
  for (const char* line : {"G54", "G92.2", "G49", "G92.3", "G43.1 Z-7", "G92.1"}) {
    p.run(line);
    EXPECT_DOUBLE_EQ(z(0) + z(11) + z(12),
                     static_cast<double>(p.interpreter.work_offset_e7()[2]) / 1e7)
        << line;
  }
}

TEST(ProgramText, StoredLinesAndHelp) {
  const auto text = [](auto write) {
    TextLine line;
    write(line);
    return std::string(line.view());
  };
  EXPECT_EQ(text([](TextLine& l) { write_start_up_line(l, 0, ""); }), "$N0=\r\n");
  EXPECT_EQ(text([](TextLine& l) { write_start_up_line(l, 1, "G20G54"); }), "$N1=G20G54\r\n");
  EXPECT_EQ(text([](TextLine& l) { write_start_up_result(l, "G20G54", 0); }), ">G20G54:ok\r\n");
  EXPECT_EQ(text([](TextLine& l) { write_start_up_result(l, "G200", 20); }), ">G200:error:20\r\n");
  EXPECT_EQ(text([](TextLine& l) {
              write_help(l, {true, true, true});
            }),
            "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n");
  EXPECT_EQ(text([](TextLine& l) { write_help(l, {}); }),
            "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $X ~ ! ? ctrl-x]\r\n");
}

TEST(ProgramText, TheLongestTextFitsALine) {
  Program p;
  p.parameters.systems_e7.fill({-program::max_position_e7, -program::max_position_e7,
                                -program::max_position_e7, -program::max_position_e7});
  EXPECT_EQ(p.offset(8, 4), "[G59.3:-10000.000,-10000.000,-10000.000,-10000.000]\r\n");
  p.run("G90.1 G61.1 G99 G59.3 M7 T255 F4000000 S4000000 G18 G91");
  p.run("M8");
  p.run("G43.1 Z2");
  p.run("G68 R30");
  p.run("M130 P0");
  p.run("G38.2 X1");
  const std::string text = modes(p.interpreter.modal(), true);
  EXPECT_EQ(text.substr(text.size() - 3), "]\r\n");
}

}  // namespace
}  // namespace lamplock::machine
