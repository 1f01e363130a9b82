// Errors: every number that a program can cause, each with the column of the offending word; and a
// line with an error changes nothing.
#include "shared/gcode_errors.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::errors_test {
namespace {

using lamplock::test::scaled;
using test::Rig;
using test::Row;

TEST(GcodeErrors, AreInOrderWithNamesAndTexts) {
  int last = 0;
  std::set<std::string_view> names;
  for (const GcodeErrorRow& row : gcode_errors) {
    EXPECT_GT(static_cast<int>(row.error), last);
    last = static_cast<int>(row.error);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_FALSE(row.text.empty());
    EXPECT_EQ(find_gcode_error(static_cast<std::uint8_t>(row.error)), &row);
  }
  EXPECT_EQ(find_gcode_error(0), nullptr);
  EXPECT_EQ(find_gcode_error(21)->name, "modal_conflict");
  EXPECT_EQ(find_gcode_error(99), nullptr);
}

/// Only the last line may have an error.
void expect_fault(const Row& row) {
  Rig rig;
  const std::string_view lines = row.lines;
  const std::size_t bar = lines.rfind('|');
  std::string_view line = lines;
  if (bar != std::string_view::npos) {
    rig.run_all(lines.substr(0, bar));
    line.remove_prefix(bar + 1);
  }
  const test::Seen before = rig.seen();
  EXPECT_EQ(rig.run(line), row.wanted) << row.lines;
  EXPECT_EQ(rig.seen(), before) << row.lines;
}

TEST(InterpreterErrors, OfSingleWords) {
  const Row rows[] = {
      {"G0 X1 =", "1@7"},   {"3G0", "1@1"},           {"G0 X", "2@4"},
      {"G", "2@1"},         {"X1 G0 Y-", "2@7"},      {"X9999999999", "2@1"},
      {"G1 X1 F-1", "4@7"}, {"S-1", "4@1"},           {"T-1", "4@1"},
      {"N-1", "4@1"},       {"G4 P-1", "4@4"},        {"G64 P-1", "4@5"},
      {"M130 P-1", "4@6"},  {"G10 L-2 P1 X1", "4@5"}, {"G10 L2 P-1 X1", "4@8"},
      {"G7", "20@1"},       {"X1 G5.4", "20@4"},      {"G0.1", "20@1"},
      {"G-1", "20@1"},      {"G1.05", "20@1"},        {"G100", "20@1"},
      {"G1000", "20@1"},    {"G999999999", "20@1"},   {"G999999999.9999999", "20@1"},
      {"G41", "91@1"},      {"G59.4", "20@1"},        {"G54.1", "28@1"},
      {"G61.2", "20@1"},    {"G54.1 P4", "29@7"},     {"G54.1 P0 X1", "29@7"},
      {"G74 X1", "20@1"},   {"G87", "20@1"},          {"G88", "20@1"},
      {"G84", "20@1"},      {"G17.1", "20@1"},        {"G28.2", "20@1"},
      {"G92.4", "20@1"},    {"M66", "20@1"},          {"M10", "20@1"},
      {"M-3", "20@1"},      {"M99999", "20@1"},       {"M3.5", "23@1"},
      {"B1", "20@1"},       {"C1", "20@1"},           {"E1", "20@1"},
      {"U1", "20@1"},       {"V1", "20@1"},           {"W1", "20@1"},
      {"X1 X2", "25@4"},    {"X1 Y1 F1 F2", "25@10"}, {"N1 N1", "25@4"},
      {"T256", "38@1"},     {"T1.5", "23@1"},         {"N10000001", "27@1"},
      {"N1.5", "23@1"},     {"S4294967.296", "44@1"}, {"G1 F4294967.296", "43@4"},
  };
  for (const Row& row : rows) expect_fault(row);
}

TEST(InterpreterErrors, OfCommands) {
  const Row rows[] = {
      {"G1 X1", "22@1"},
      {"G1|G1 F0 X1", "22@1"},
      {"G1 F1 X1|F0|Y1", "22@1"},
      {"G1 F1|G93 X1", "22@5"},
      {"G93 G1 F1 X1|X1", "22@1"},
      {"G93 G1 F0 X1", "22@5"},
      {"G1 F1|G93 F1|G94 X1", "22@5"},
      {"G95 G1 F1 X1", "22@5"},  // at rest
      {"G95 S4000000 G1 F4000 X1", "43@14"},
      {"G93 G1 X1 F0.01", "39@11"},
      {"G4", "28@1"},
      {"G1 F1|X1 G4", "28@4"},
      {"G4 P4294.968", "39@4"},
      {"M130", "28@1"},
      {"M130 P2", "39@6"},
      {"M130 P0.5", "23@6"},
      {"G10 L2 P1", "26@1"},
      {"G10 P1 X1", "28@1"},
      {"G10 L2 X1", "28@1"},
      {"G10 L3 P1 X1", "20@5"},
      {"G10 L2.5 P1 X1", "23@5"},
      {"G10 L2 P1.5 X1", "23@8"},
      {"G10 L2 P10 X1", "29@8"},
      {"G10 L20 P1 R5 X1", "20@12"},
      {"G10 L2 P1 X20001", "39@11"},
      {"G92", "26@1"},
      {"X1 G92.1|G92", "26@1"},
      {"G92 X100000", "39@5"},
      {"G53 G2 X1", "30@1"},
      {"G80 G53", "30@5"},
      {"G81 R1 Z0 F60|G53 X1", "30@1"},
      {"G80 X1", "31@5"},
      {"G80|Y2 X1", "31@1"},
      {"G80 G49 Z1", "31@9"},
      {"M61", "28@1"},
      {"M61 Q256", "38@5"},
      {"M61 Q1.5", "23@5"},
      {"G64 Q-1", "4@5"},
      {"G50 X1", "20@5"},
      {"G50 S100", "20@5"},
      {"M117x", "20@1"},
      {"G96", "20@1"},
      {"D-1", "20@1"},
      {"G1 :1000", "1@4"},
      {"G43.1", "37@1"},
      {"G43.1 X1", "37@7"},
      {"G43.1 Z1 Y1", "37@10"},
      {"G43.1 Z10001", "39@7"},
      {"G68", "28@1"},
      {"G68 X1", "28@1"},
      {"G68 X1 Z1 R1", "31@8"},
      {"G18 G68 Y1 R1", "31@9"},
      {"G68 X10001 R1", "33@5"},
      {"G0 X10000.0000001", "33@4"},
      {"G91 X6000|Y1 X6000", "33@4"},
      {"G28 X10001", "33@5"},
      {"G68 R45|G0 X9000 Y9000", "33@1"},
      {"M72", "20@1"},
      {"X1 I1", "36@4"},
      {"I1", "36@1"},
      {"G0 X1 R1 J1", "36@7"},
      {"P1", "36@1"},
      {"L2 X1", "36@1"},
      {"Q1", "36@1"},
      {"M3 P1", "36@4"},
      {"G61 P1", "36@5"},
      {"G1 F1 X1 P1", "36@10"},
  };
  for (const Row& row : rows) expect_fault(row);
}

TEST(InterpreterErrors, OfCurves) {
  const Row rows[] = {
      {"G2 X1 I1", "22@1"},
      {"G2 F1", "26@1"},
      {"F1|G2 Z1 R1", "32@4"},
      {"F1|G18 G2 Y1 J1", "32@8"},
      {"F1|G2 X1", "35@1"},
      {"F1|G2 X1 K1", "35@1"},
      {"F1|G2 X2 Y0 I5", "33@10"},
      {"F1|G2 X2 J0 I5", "33@7"},
      {"F1|G2 X0 Y0 R1", "33@10"},
      {"F1|G2 X10 R4", "34@8"},
      {"F1|G2 X10 R0", "34@8"},
      {"F1|G2 X10 R5 I1", "36@11"},
      {"F1|G2 I0 J0", "34@4"},
      {"F1|G3 J0", "34@4"},
      {"F1|G2 X0 Y0 I0 J0", "34@10"},
      {"F1|G2 Z5 I0", "34@7"},
      {"F1|G2 X0.003 I0 J0 P2", "34@11"},
      {"F1|G2 X0.003 I0.003", "34@11"},
      {"F1|G18 G3 I0 K0", "34@8"},
      {"F1 X5|G90.1 G2 I5 J0", "34@10"},
      {"F1|G2 X5 I0 J0", "33@7"},
      {"F1|G2 X10 I5 P0", "19@11"},
      {"F1|G2 X10 I5 P-1", "4@11"},
      {"F1|G2 X10 I5 P1.5", "23@11"},
      {"F1|G2 X10 I5 P10000", "39@11"},
      {"F1|G2 X10 I2000000", "39@8"},
      {"F1|G2 X10001 I2", "33@4"},
      {"F1|G90.1 G2 X10 I5", "35@7"},
      {"F1|G1 X10|I5 J5", "36@1"},
      {"G5 X1 I1 J1 P1 Q1", "22@1"},
      {"F1|G5 I1 J1 P1 Q1", "26@1"},
      {"F1|G5 X1 Z1 I1 J1 P1 Q1", "31@7"},
      {"F1|G18 G5 X1 I1 J1 P1 Q1", "20@5"},
      {"F1|G5 X1 I1 P1 Q1", "28@1"},
      {"F1|G5 X1 J1 P1 Q1", "28@1"},
      {"F1|G5 X1 P1 Q1", "35@1"},
      {"F1|G5 X1 I1 J1 P1", "28@1"},
      {"F1|G5 X1 I1 J1 Q1", "28@1"},
      {"F1|G5 X1 I1 J1 P1 Q1 K1", "36@19"},
      {"F1|G5.1 X1", "35@1"},
      {"F1|G5.1 X1 I0 J0", "35@1"},
      {"F1|G5.1 X1 A1 I1", "31@9"},
      {"F1|G19 G5.1 X1 I1", "20@5"},
  };
  for (const Row& row : rows) expect_fault(row);
}

TEST(InterpreterErrors, OfCycles) {
  const Row rows[] = {
      {"G81 X1 R1 Z-1", "22@1"},
      {"F1|G81", "26@1"},
      {"F1|G81 R1", "26@1"},
      {"F1|G81 X1 Z-1", "28@1"},
      {"F1|G81 X1 R1", "28@1"},
      {"F1|G82 X1 R1 Z-1", "28@1"},
      {"F1|G82 X1 R1 Z-1 P-1", "4@15"},
      {"F1|G83 X1 R1 Z-1", "28@1"},
      {"F1|G73 X1 R1 Z-1", "28@1"},
      {"F1|G83 X1 R1 Z-1 Q0", "19@15"},
      {"F1|G83 X1 R1 Z-1 Q-1", "4@15"},
      {"F1|G81 X1 R1 Z2", "33@11"},
      {"F1|G81 X1 R1 Z-10001", "33@11"},
      {"F1|G81 X1 R20000 Z1", "33@15"},
      {"F1|G81 X1 R1 Z-1 L0", "19@15"},
      {"F1|G81 X1 R1 Z-1 L1.5", "23@15"},
      {"F1|G81 X1 R1 Z-1 L-1", "4@15"},
      {"F1|G81 X1 R1 Z-1 L10000", "39@15"},
      {"F1|G91 G81 X6000 R1 Z-1 L2", "33@5"},
      {"F1|G81 X1 R1 Z-1 P1", "36@15"},
      {"F1|G81 X1 R1 Z-1 Q1", "36@15"},
      {"G93 F1 G81 X1 R1 Z-1", "20@8"},
      {"F1|G81 X1 R1 Z-1|G82 X2 P1", "28@1"},
      {"F1|G81 X1 R1 Z-1|G80|X2", "31@1"},
      {"F1|G81 X1 R1 Z-1|G0 X3|G81 X2", "28@1"},
  };
  for (const Row& row : rows) expect_fault(row);
}

/// Codes of each modal group.
const std::vector<std::vector<const char*>> groups{
    {"G4", "G10", "G28", "G28.1", "G30", "G30.1", "G53", "G92", "G92.1", "G92.2", "G92.3"},
    {"G0", "G1", "G2", "G3", "G5", "G5.1", "G73", "G81", "G82", "G83", "G38.2", "G38.3", "G38.4",
     "G38.5"},
    {"G17", "G18", "G19"},
    {"G90", "G91"},
    {"G90.1", "G91.1"},
    {"G93", "G94", "G95"},
    {"G20", "G21"},
    {"G40", "G41", "G41.1", "G42", "G42.1"},
    {"G43.1", "G49"},
    {"G98", "G99"},
    {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"},
    {"G61", "G61.1", "G64"},
    {"G68", "G69"},
    {"G9"},
    {"M0", "M1", "M2", "M30"},
    {"M3", "M4", "M5"},
    {"M6"},
    {"M7", "M8", "M9"},
    {"M70", "M71", "M72", "M73"},
    {"M130", "M131"},
};

TEST(InterpreterErrors, TwoCodesOfOneGroup) {
  Rig rig;
  const test::Seen before = rig.seen();
  for (const auto& group : groups)
    for (const char* a : group)
      for (const char* b : group) {
        const std::string line = std::string(a) + b;
        const std::string column = std::to_string(std::string_view(a).size() + 1);
        EXPECT_EQ(rig.run(line), "21@" + column) << line;
        EXPECT_EQ(rig.seen(), before);
      }
}

TEST(InterpreterErrors, TwoCodesThatUseTheAxisWords) {
  // By group.
  const std::vector<std::vector<const char*>> wanting{
      {"G10", "G28", "G30", "G92"},
      {"G0", "G1", "G2", "G3", "G5", "G5.1", "G73", "G81", "G82", "G83", "G38.2"},
      {"G43.1"},
      {"G68"}};
  Rig rig;
  const test::Seen before = rig.seen();
  for (const auto& group : wanting)
    for (const auto& other : wanting) {
      if (&group == &other) continue;
      for (const char* a : group)
        for (const char* b : other) {
          const std::string line = std::string(a) + " X1 " + b;
          const std::string column = std::to_string(std::string_view(a).size() + 5);
          EXPECT_EQ(rig.run(line), "24@" + column) << line;
          EXPECT_EQ(rig.seen(), before);
        }
    }
}

TEST(InterpreterErrors, TwoCommandsThatUseOneWord) {
  const Row rows[] = {
      {"G4 P1 G64", "24@4"},
      {"M130 P1 G4", "24@6"},
      {"G64 G10 L2 P1 X1", "24@12"},
      {"F1 G82 R1 Z-1 G64 P1", "24@19"},
      {"F1 M130 G2 X1 I1 P1", "24@18"},
  };
  for (const Row& row : rows) expect_fault(row);
}

/// A line of words, valid or not in combination.
std::string random_line(std::mt19937_64& random) {
  const auto number = [&random] {
    const char* values[] = {"0", "1", "2", "-1", "0.5", "-3.25", "20", "100", "9", "", "1.0000001"};
    return std::string(values[random() % std::size(values)]);
  };
  std::string line;
  for (auto n = random() % 6; n > 0; --n) {
    if (random() % 2 == 0) {
      const auto& group = groups[random() % groups.size()];
      line += group[random() % group.size()];
    } else {
      line += "XYZAFIJKLNPQRST"[random() % 15] + number();
    }
    if (random() % 2 == 0) line += ' ';
  }
  return line;
}

void expect_nothing_changed_by_faults(Rig& rig, const std::string& line, int& faults) {
  const test::Seen before = rig.seen();
  const Fault fault = rig.interpreter.run(line);
  if (fault) {
    ++faults;
    ASSERT_EQ(rig.seen(), before) << line;
    ASSERT_GE(fault.column, 1) << line;
    ASSERT_LE(fault.column, line.size()) << line;
    ASSERT_NE(find_gcode_error(static_cast<std::uint8_t>(fault.error)), nullptr);
    Action action;
    ASSERT_FALSE(rig.interpreter.next(action)) << line;
    return;
  }
  Action action;
  for (int i = 0; i < 300 && rig.interpreter.next(action); ++i) {
  }
  rig.interpreter.set_position(rig.machine());
}

TEST(InterpreterErrors, ALineWithAnErrorChangesNothing) {
  std::mt19937_64 random(2);
  Rig rig;
  rig.options.probe = true;
  int faults = 0;
  const int lines = scaled(60000);
  for (int i = 0; i < lines; ++i) {
    if (i % 100 == 0) rig.interpreter.reset();
    expect_nothing_changed_by_faults(rig, random_line(random), faults);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(faults, lines / 4);
  EXPECT_LT(faults, lines * 99 / 100);
}

TEST(InterpreterErrors, AnyBytes) {
  std::mt19937_64 random(3);
  constexpr std::string_view likely = "GMXYZAIJKLNPQRSTFgmxy0123456789.-+ ();/%";
  Rig rig;
  int faults = 0;
  for (int i = 0; i < scaled(60000); ++i) {
    std::string line;
    for (auto n = random() % 40; n > 0; --n)
      line += random() % 16 == 0 ? static_cast<char>(random()) : likely[random() % likely.size()];
    expect_nothing_changed_by_faults(rig, line, faults);
    rig.interpreter.jog(line);
    rig.interpreter.set_position(rig.machine());
    if (HasFatalFailure()) return;
  }
}

/// A program gives the same actions and ends in the same state without its lines in error.
TEST(InterpreterErrors, ProgramsWithLinesInErrorRunAsWithout) {
  std::mt19937_64 random(4);
  for (int run = 0; run < scaled(100); ++run) {
    Rig with, without;
    for (int i = 0; i < 100; ++i) {
      const std::string line = random_line(random);
      const std::string result = with.run(line);
      if (result.find('@') != std::string::npos) continue;
      ASSERT_EQ(without.run(line), result) << line;
    }
    ASSERT_EQ(with.seen(), without.seen());
  }
}

}  // namespace
}  // namespace lamplock::program::errors_test
