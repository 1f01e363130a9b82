// `lamplock check --tools`: programs are checked with the tools of a machine, as `send` does.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using namespace std::string_literals;

class CheckTools : public testing::Test {
 protected:
  Finished check(const std::string& program, const std::string& tools) const {
    return run({"check", folder_.write("p.ngc", program), "--json", "--tools",
                folder_.write("tools.ngc", tools)});
  }
  double low_z_mm(const std::string& program, const std::string& tools) const {
    const Finished done = check(program, tools);
    EXPECT_EQ(done.status, 0) << done.out << done.err;
    return nlohmann::json::parse(done.out)["low_mm"][2].get<double>();
  }
  const Folder folder_;
};

TEST_F(CheckTools, HaveTheirLengthsAndDiameters) {
  const std::string program = "T2 M6\nG43\nG0 Z-10\nG41 D2 G1 X5 F600\nY5\nG40 X10 Y10\nM2\n";
  const std::string entered = "%\n(mill)\nG21\nG10 L1 P2 Z4.25 R1.5 (2 flutes)\n",
                    inches = "G20 G10 L1 P2 Z.1 R.125\n",
                    reported =
                        "[G54:0.000,0.000,0.000]\n[TLO:0.000]\n"
                        "[T:1|0.000,0.000,1.000|0.500]\n[T:2|0.000,0.000,4.250|1.500]\nok\n";
  EXPECT_DOUBLE_EQ(low_z_mm(program, entered), -5.75);
  EXPECT_DOUBLE_EQ(low_z_mm(program, inches), -7.46);
  EXPECT_DOUBLE_EQ(low_z_mm(program, reported), -5.75);
  // In a program with O-words, and its values.
  EXPECT_DOUBLE_EQ(low_z_mm("o1 if [1]\nT2 M6\nG43\nG0 Z-10\no1 endif\nG0 X[#5403]\n", entered),
                   -5.75);
  const Finished other = check("T3\n", entered);
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.out, HasSubstr("'T3': the tool table does not have this tool"));
}

/// What `lamplock send` has entered on a board is what the board reports.
TEST_F(CheckTools, AcceptTheAnswerOfABoard) {
  const Finished board = run({"console", "--board", "virtual"}, "$X\nG10 L1 P7 Z3 R2\n$#\n");
  ASSERT_EQ(board.status, 0) << board.err;
  EXPECT_DOUBLE_EQ(low_z_mm("G43 H7\nG0 Z-4\n", board.out), -1);
}

TEST_F(CheckTools, BadTablesAreRefused) {
  std::string full;
  for (int i = 1; i <= 25; ++i) full += "[T:" + std::to_string(i) + "|0,0,1|1]\n";
  const std::pair<std::string, std::string> cases[] = {
      {"(none)\n", ": it has no tool; write lines like G10 L1"},
      {"G10 L1 P1 Z1\nG1 X1 F100\n", ":2: 'G1 X1 F100' does not enter a tool; write lines"},
      {"G10 L2 P1 X1\n", ":1: 'G10 L2 P1 X1' does not enter a tool"},
      {"G10 L1 Z1\n", ":1: error:28 'G10' needs a P word"},
      {"[T:1|0,0|1]\n", ":1: '[T:1|0,0|1]' is not a tool as a board reports it"},
      {"[T:1|0,0,nan|1]\n", ":1: '[T:1|0,0,nan|1]' is not"},
      {"[T:1|0,0,1e300|1]\n", ":1: '[T:1|0,0,1e300|1]' is not"},
      {full, ":25: a board has room for 24 tools"},
      {"G10 L1 P1 R-1\n", ":1: error:4 'R-1': the value must not be negative"},
  };
  for (const auto& [tools, text] : cases) {
    const Finished done = check("G0 X1\n", tools);
    EXPECT_EQ(done.status, 2) << tools;
    EXPECT_THAT(done.err, HasSubstr("tools.ngc" + text)) << tools;
  }
  const Finished none = run({"check", folder_.write("p.ngc", "G0 X1\n"), "--tools", "/none.ngc"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("/none.ngc"));
}

}  // namespace
}  // namespace lamplock::cli::test
