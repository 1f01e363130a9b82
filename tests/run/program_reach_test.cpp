// How far a program of G-code has come: the line that the board executes, not those that it has
// accepted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "host/job/profile.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/program_lines.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::run::program_reach {
namespace {

using namespace std::chrono_literals;

/// A program whose line `first` + n ends after n + 1 s; blank lines and numbers of its own are not
/// counted by the board.
std::string a_second_a_line(int lines) {
  std::string text = "G21 G91\n\n(a line is a second)\nG1 F600\n";
  for (int i = 0; i < lines; ++i)
    text += fmt::format("{}X{}\n", i % 3 == 0 ? "n7 " : "", i % 2 == 0 ? 10 : -10);
  return text;
}
constexpr std::size_t first = 5;

TEST(ProgramReach, IsTheLineUnderWay) {
  for (const std::chrono::milliseconds stop_at : {2500ms, 7500ms, 12'500ms}) {
    sim::VirtualBoard board(job::default_profile().settings, {});
    link::SimulatedTransport transport(board);
    link::LinePort port(transport);
    link::LineSender sender(port, link::program_lines(a_second_a_line(20), "test"), {});
    while (sender.elapsed() < stop_at && sender.step()) continue;
    const auto line = first + static_cast<std::size_t>(stop_at / 1s);
    EXPECT_EQ(sender.answered(), sender.lines()) << "the board has taken all lines";
    EXPECT_EQ(sender.executed(), line - 3) << "two lines without words";
    sender.stop();
    while (sender.step()) continue;
    EXPECT_EQ(sender.result().at_line, line);
  }
}

TEST(ProgramReach, IsWholeAtTheEnd) {
  sim::VirtualBoard board(job::default_profile().settings, {});
  link::SimulatedTransport transport(board);
  link::LinePort port(transport);
  link::LineSender sender(port, link::program_lines(a_second_a_line(3) + "M30\n", "test"), {});
  while (sender.step()) continue;
  EXPECT_EQ(sender.result().end, link::LineEnd::done);
  EXPECT_EQ(sender.executed(), sender.lines());
}

/// Lines for the board, of a tape, and those that would be too long stay as they are.
TEST(ProgramReach, NumbersOnlyBlocks) {
  const std::string longest(253, '1');
  const auto numbered = link::with_numbers({{1, "$H"},
                                            {2, "%"},
                                            {3, "/G1 X1"},
                                            {4, "G1 X1"},
                                            {5, "N20 X2"},
                                            {6, "N9"},
                                            {7, "X" + longest}});
  const std::vector<std::string> wanted{"$H",   "%",  "/G1 X1",     "N4G1 X1",
                                        "N5X2", "N9", "X" + longest};
  ASSERT_EQ(numbered.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(numbered[i].text, wanted[i]);
}

}  // namespace
}  // namespace lamplock::run::program_reach
