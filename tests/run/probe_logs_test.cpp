// Probe logs on the virtual board, whose tool touches a plate: places in work coordinates with
// offsets, shifts, tool lengths, inches and rotation, also those that follow from a probe.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "host/job/profile.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/program_lines.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/program/board_state.hpp"
#include "host/run/probe_log_files.hpp"
#include "host/text.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::run::probe_logs {
namespace {

using settings::Id;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr int steps_per_mm = 200;
constexpr double plate_mm = -3;

/// A board with a plate, and a folder of logs.
class ProbeLogs : public testing::Test {
 protected:
  ProbeLogs() {
    job::Profile profile = job::default_profile();
    profile.settings.set_milli(Id::laser_mode, 0);
    values_ = profile.settings;
  }

  /// Runs a program to its end; what is lost.
  std::vector<LostFile> run(const std::string& text, bool ignore_errors = false) {
    sim::WorldConfig world;
    world.switches.push_back(
        {.pin = sim::Pin::probe,
         .contacts = {sim::ContactConfig::below(2, static_cast<int>(plate_mm * steps_per_mm))},
         .normally_closed = false});
    sim::VirtualBoard board(values_, world);
    link::SimulatedTransport transport(board);
    link::LinePort port(transport);
    const link::BoardStatus status = link::greet(port).status;
    const auto state = program_run::read_state(port, status, {});
    EXPECT_TRUE(state.has_value());
    if (!state) return {};
    auto lines = link::program_lines(text, "p.ngc");
    ProbeLogFiles::check(folder(), program_run::log_names(lines), "p.ngc");
    const auto program = program_run::with_probe_questions(std::move(lines), values_, *state);
    if (after_check_) after_check_();
    ProbeLogFiles logs(program.lines, program.probes, folder(), values_, *state);
    const link::LineSender* running = nullptr;
    link::LineOptions options;
    options.ignore_errors = ignore_errors;
    options.on_text = [&](const std::string& line) {
      if (!logs.take(line, *running)) texts_.push_back(line);
    };
    link::LineSender sender(port, program.lines, options);
    running = &sender;
    while (sender.step()) logs.poll(sender);
    EXPECT_EQ(sender.result().end, link::LineEnd::done) << text << sender.result().alarm;
    const auto position = sender.result().status.position;
    if (position.size() > 2) end_z_mm_ = position[2];
    LostFiles lost;
    logs.finish(lost);
    return lost.all();
  }
  std::string folder() const { return folder_.file("").string(); }
  std::vector<std::string> lines_of(const std::string& name) const {
    std::ifstream file(folder_.file(name));
    EXPECT_TRUE(file.is_open()) << name;
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }

  lamplock::test::TemporaryFolder folder_;
  settings::Values values_;
  std::vector<std::string> texts_;
  std::function<void()> after_check_;  ///< before the program begins
  double end_z_mm_ = 0;
};

TEST_F(ProbeLogs, HaveALineForEachContact) {
  EXPECT_THAT(run("G21 G90 (ProbeOpen  a b.txt )\nG0 X1.5 Y-2\nG38.2 Z-10 F600\nG0 Z0\n"
                  "G38.3 Z-1 F600\nG0 X2\n(probeclose)\nG38.2 Z-10 F600\nG0 Z0\n"
                  "(probeopen b.txt)\nG38.3 Z-1\nX3\n(probeopen a b.txt)\nG38.2 Z-10 F600\n"),
              IsEmpty());
  EXPECT_THAT(lines_of("a b.txt"),
              ElementsAre("1.500000 -2.000000 -3.000000 0.000000 0.000000 0.000000 0.000000 "
                          "0.000000 0.000000",
                          "3.000000 -2.000000 -3.000000 0.000000 0.000000 0.000000 0.000000 "
                          "0.000000 0.000000"));
  EXPECT_THAT(lines_of("b.txt"), IsEmpty());
  for (const std::string& text : texts_) EXPECT_TRUE(text.starts_with("[PRB:")) << text;
}

TEST_F(ProbeLogs, ThereAreNoQuestionsWithoutALog) {
  auto lines = link::program_lines("G38.3 Z-1 F600\n(probeclose)\nG38.3 Z-1\n", "p.ngc");
  const auto program = program_run::with_probe_questions(std::move(lines), values_, {});
  EXPECT_EQ(program.lines.size(), 2u);
  EXPECT_TRUE(program.probes.empty());
}

/// The coordinates of LoggedPlace X, Y and Z of the only line of a log.
std::array<double, 3> only_place(const std::vector<std::string>& lines) {
  std::array<double, 3> place{NAN, NAN, NAN};
  EXPECT_EQ(lines.size(), 1u);
  if (lines.size() != 1) return place;
  std::string_view rest = lines[0];
  for (double& value : place) {
    value = number_of<double>(rest.substr(0, rest.find(' '))).value_or(NAN);
    rest.remove_prefix(rest.find(' ') + 1);
  }
  return place;
}

TEST_F(ProbeLogs, AreInWorkCoordinates) {
  struct Case {
    std::string before;
    std::array<double, 3> place;
    double tolerance_mm = 1.01e-6;
  };
  // The board reports a contact in whole steps of each axis.
  constexpr double half_a_step_of_two_mm = 0.0036;
  const std::string probe = "G38.2 Z[#5423 - [10 * #<_metric> + 0.3 * #<_imperial>]] F20\n";
  for (const Case& c : std::initializer_list<Case>{
           {"G10 L2 P2 X1 Y2 Z0.5\nG55 G0 X2 Y1\n", {2, 1, -3.5}},
           {"G59.3 G10 L2 P9 X-1\nG0 X0.25\n", {0.25, 0, -3}},
           {"G0 X4\nG92 X10 Z2\n", {10, 0, -1}},
           {"G0 X4\nG92 X10 Z2\nG92.2\n", {4, 0, -3}},
           {"G43.1 Z1.25\nG0 X1\n", {1, 0, -4.25}},
           {"G10 L1 P3 Z2\nM61 Q3\nG43\nG43.1 Z2.5\nG49\nG43 H3\n", {0, 0, -5}},
           {"G10 L2 P1 Z0.1\nG20 G0 X0.5\n", {0.5, 0, -3.1 / 25.4}},
           {"G68 X0 Y0 R90\nG0 X4 Y1\n", {4, 1, -3}},
           {"G10 L2 P1 X1 Y1\nG68 X2 Y1 R33.3\nG0 X4 Y1\n", {4, 1, -3}, half_a_step_of_two_mm},
           {"G0 X4 Y1\nG68 R30\nG91 G0 X1\nG90\n", {5, 1, -3}, half_a_step_of_two_mm},
       }) {
    EXPECT_THAT(run("G21 G90\n" + c.before + "(probeopen a)\n" + probe), IsEmpty());
    const auto place = only_place(lines_of("a"));
    for (std::size_t a = 0; a < place.size(); ++a)
      EXPECT_NEAR(place[a], c.place[a], c.tolerance_mm) << c.before << a;
  }
}

/// The machine stops beyond the contact; offsets that count from there are known to the board
/// alone.
TEST_F(ProbeLogs, FollowOffsetsThatWereProbed) {
  for (const std::string touch_off : {"G92 Z0", "G10 L20 P1 Z0"}) {
    EXPECT_THAT(
        run("G38.2 Z-10 F600\n" + touch_off + "\nG0 Z2\n(probeopen a)\nG38.2 Z-8 F600\nG1 Z0\n"),
        IsEmpty())
        << touch_off;
    // At its end the machine is where the zero was entered.
    const auto logged = lines_of("a");
    ASSERT_EQ(logged.size(), 1u);
    EXPECT_NEAR(only_place(logged)[2], plate_mm - end_z_mm_, 1.01e-6);
    EXPECT_GT(only_place(logged)[2], 0);
  }
}

/// A centre of rotation where a probe has ended.
TEST_F(ProbeLogs, RotationRoundAProbedPlace) {
  EXPECT_THAT(
      run("G38.2 X3 Z-10 F600 (no log)\nG0 Z0\nG92 X0 Y0\nG68 R90\nG0 X2 Y1\n(probeopen a)\n"
          "G38.2 Z-10 F600\n"),
      IsEmpty());
  const auto place = only_place(lines_of("a"));
  EXPECT_NEAR(place[0], 2, 1.01e-6);
  EXPECT_NEAR(place[1], 1, 1.01e-6);
}

/// A probe within a rotated system; its origin is entered at a contact, and G68 turns it further.
TEST_F(ProbeLogs, RotatedSystems) {
  EXPECT_THAT(run("G10 L2 P1 R90\nG0 X2 Y1\n(probeopen a)\nG38.2 Z-10 F600\nG0 Z0\n(probeclose)\n"
                  "G10 L20 P1 X0 Y0\nG10 L2 P1 R30\nG0 X3 Y2\n(probeopen b)\nG38.2 Z-10\nG0 Z0\n"
                  "(probeclose)\nG68 X0 Y0 R20\nG0 X-2 Y4\n(probeopen c)\nG38.2 Z-10\n"),
              IsEmpty());
  constexpr double half_step_mm = 0.51 / steps_per_mm;
  const auto expect = [&](const char* name, double x, double y) {
    const auto place = only_place(lines_of(name));
    EXPECT_NEAR(place[0], x, 2 * half_step_mm) << name;
    EXPECT_NEAR(place[1], y, 2 * half_step_mm) << name;
  };
  expect("a", 2, 1);
  expect("b", 3, 2);
  expect("c", -2, 4);
}

TEST_F(ProbeLogs, RefusedProbesHaveNoLine) {
  EXPECT_THAT(run("(probeopen a)\nG38.2 Z-10 F600\nG0 Z0\nG38.2 Z0\nG38.2 Z-10\n", true),
              IsEmpty());
  EXPECT_EQ(lines_of("a").size(), 2u);
}

/// A full disk does not stop the machine, nor other logs.
TEST_F(ProbeLogs, AFailedWriteIsReported) {
  after_check_ = [this] { std::filesystem::create_symlink("/dev/full", folder_.file("full")); };
  const auto lost =
      run("(probeopen full)\nG38.2 Z-10 F600\nG0 Z0\n(probeopen a)\nG38.2 Z-10 F600\nG0 Z0\n");
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].file, folder_.file("full").string());
  EXPECT_THAT(lost[0].reason, testing::HasSubstr("No space left on device"));
  EXPECT_EQ(lines_of("a").size(), 1u);
}

TEST_F(ProbeLogs, WhatIsNoPlainFileIsRefusedBefore) {
  const std::string probe = "G38.2 Z-10 F600\nG0 Z0\n";
  std::filesystem::create_directory(folder_.file("b"));
  std::filesystem::create_symlink("/dev/full", folder_.file("full"));
  EXPECT_THROW(run("(probeopen b)\n" + probe), Error);
  EXPECT_THROW(run("(probeopen full)\n" + probe), Error);
  EXPECT_THROW(ProbeLogFiles::check(folder() + "none", {"a"}, "p.ngc"), Error);
  const std::string program = folder_.write("p.ngc", probe).string();
  EXPECT_THROW(ProbeLogFiles::check(folder(), {"p.ngc"}, program), Error);
  ProbeLogFiles::check(folder(), {"q.ngc"}, program);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("q.ngc")));
}

}  // namespace
}  // namespace lamplock::run::probe_logs
