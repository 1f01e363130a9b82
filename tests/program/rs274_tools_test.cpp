// Random programs with tools by the board's interpreter and by LinuxCNC's rs274: the same moves end
// in the same places, and the same lines are refused.
//
// Differences that the programs avoid, named in docs/gcode.md: rs274 does not enter a tool that its
// file lacks; H0 is the tool in the spindle there, and so is G43 without a tool; it keeps a tool
// length as a number when the units change; it takes a tool without a diameter for G41; M61 does
// not choose the tool for M6. After M6 rs274 (not LinuxCNC, where the machine keeps it) forgets the
// length in force, and moves by it in the program's coordinates, so it is between a G49 with a move
// and a G43; M61 has no effect there.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/program/rig.hpp"
#include "tests/program/rs274.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::rs274_tools_test {
namespace {

using lamplock::test::scaled;
using test::CanonicalLine;
using test::CanonicalMove;
using test::Rig;
using test::Rs274;

/// rs274 prints four decimals of a millimetre; offsets and place are rounded by themselves.
constexpr double end_tolerance_mm = 4e-4;
constexpr std::string_view reset = "G21 G17 G90 G91.1 G94 G40 G49 G54 G61 G80 G92.1 M5 F100";
constexpr int tools = 4;

class Programs {
 public:
  explicit Programs(unsigned seed) : random_(seed) {}

  Rs274::Program program(int lines) {
    Rs274::Program result{"G10 L2 P1 X0 Y0 Z0", "G10 L2 P9 X0 Y0 Z0", "G0 X0 Y0 Z0", "G49",
                          "T1 M6"};
    for (int number = 1; number <= tools; ++number)
      result.push_back(fmt::format("G10 L1 P{} Z{} R{}", number, value(), 0.25 * number));
    for (int i = 0; i < lines; ++i) {
      const std::string next = line();
      const bool changes = next.find('M') != std::string::npos;
      if (changes) result.insert(result.end(), {"G49", "G0 Z1"});
      result.push_back(next);
      if (changes) result.emplace_back("G43");
    }
    return result;
  }

 private:
  std::string value() {
    return fmt::format("{:.3f}",
                       std::uniform_int_distribution<int>(-20'000, 20'000)(random_) / 1e3);
  }
  std::string entry() { return std::to_string(1 + random_() % tools); }
  /// Now and then one that the table does not have.
  std::string tool() { return std::to_string(random_() % 30 == 0 ? 9 : 1 + random_() % tools); }
  std::string line() {
    switch (random_() % 16) {
      case 0:
        return "T" + tool() + " M6";
      case 1:
        return "T" + tool();
      case 2:
        return "G10 L1 P" + entry() + " R0.3";
      case 3:
        return "T" + tool() + " M6";
      case 4:
        return "G43";
      case 5:
        return "G43 H" + tool() + " G0 Z" + value();
      case 6:
        return "G43.2 H" + tool();
      case 7:
        return "G43.1 Z" + value();
      case 8:
        return "G49";
      case 9:
        return fmt::format("G10 L1 P{} Z{}", entry(), value());
      case 10:
        return fmt::format("G10 L10 P{} Z{}", entry(), value());
      case 11:
        return fmt::format("G10 L11 P{} Z{}", entry(), value());
      case 12:
        return fmt::format("G10 L{} P1 Z{}", random_() % 2 == 0 ? 2 : 20, value());
      case 13:
        return random_() % 2 == 0 ? "G92 Z" + value() : "G92.1";
      default:
        return fmt::format("G{} X{} Z{}", random_() % 2, value(), value());
    }
  }

  std::mt19937 random_;
};

std::array<double, 3> in_mm(const Place& place) {
  return {static_cast<double>(place[0]) / one_e7, static_cast<double>(place[1]) / one_e7,
          static_cast<double>(place[2]) / one_e7};
}

/// Up to the first line that both refuse; true if there is none.
bool expect_same(const Rs274::Program& program, const std::vector<CanonicalLine>& lines) {
  Rig rig;
  rig.run(reset);
  std::string text;
  for (std::size_t i = 0; i < program.size(); ++i) {
    text += program[i] + "\n";
    const Fault fault = rig.interpreter.run(program[i]);
    EXPECT_EQ(static_cast<bool>(fault), !lines[i].refusal.empty())
        << text << test::text_of(fault) << " / " << lines[i].refusal;
    if (fault || !lines[i].refusal.empty()) return false;
    std::vector<std::array<double, 3>> ours;
    for (const Action& action : rig.take())
      if (action.kind == ActionKind::move) ours.push_back(in_mm(action.target_e7));
    // rs274 begins where the last program has ended.
    if (program[i] == "G0 X0 Y0 Z0") continue;
    bool same = ours.size() == lines[i].moves.size();
    for (std::size_t k = 0; same && k < ours.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        same = same && std::abs(ours[k][axis] - lines[i].moves[k].to_mm[axis]) <= end_tolerance_mm;
    EXPECT_TRUE(same) << text << ours.size() << " " << (ours.empty() ? 0 : ours[0][2]) << " / "
                      << (lines[i].moves.empty() ? 0 : lines[i].moves[0].to_mm[2]);
    if (!same) return false;
  }
  return true;
}

TEST(Rs274Tools, RandomProgramsMoveAlike) {
  if (!Rs274::available()) GTEST_SKIP() << "toolchain/setup could not unpack rs274";
  constexpr int programs_a_process = 50, lines_a_program = 20;
  const int count = scaled(1000, 100);
  Rs274 rs274({1, 2, 3, 4});
  int whole = 0;
  for (int done = 0; done < count; done += programs_a_process) {
    Programs random(1 + static_cast<unsigned>(done));
    std::vector<Rs274::Program> programs;
    for (int i = 0; i < programs_a_process; ++i)
      programs.push_back(random.program(lines_a_program));
    const auto results = rs274.run(programs, reset);
    for (std::size_t i = 0; i < programs.size(); ++i) {
      whole += expect_same(programs[i], results[i]) ? 1 : 0;
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(whole, count / 2);
}

}  // namespace
}  // namespace lamplock::program::rs274_tools_test
