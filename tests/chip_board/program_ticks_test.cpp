// A program on the chip and on the virtual board: the same steps at the same ticks, and the same
// light.
//
// Both plan a line with the later lines that are known at that time. A planner that is not starved
// knows more lines than it needs, so its plans do not depend on their arrival. At the begin of a
// program only the first line is known, so this program begins with a long move, as programs do.
//
// To compare a file with programs:
//   LAMPLOCK_PROGRAM=part.ngc LAMPLOCK_PROGRAM_SECONDS=20
//   test_chip_board --gtest_filter='*Ticks*Cartesian' in its environment,
// which takes several times as long as the program on the chip.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "host/file.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/program_sender.hpp"
#include "tests/chip_board/program_trace.hpp"

namespace lamplock::test {
namespace {

/// A common laser cutter with a large work area and no lamp.
job::Profile laser_cutter() {
  job::Profile profile = chip_profile();
  job::set_acceleration(profile, 2);
  job::set_speed(profile, 0.2);
  const auto set = [&profile](Id id, double value) {
    job::state_setting(profile, id, value, "test");
  };
  set(Id::lamp_mode, 0);
  set(Id::laser_mode, 1);
  for (int axis = 0; axis < 3; ++axis) {
    set(settings::for_axis(Id::steps_per_mm_x, axis), axis == 2 ? 400 : 80);
    set(settings::for_axis(Id::travel_x, axis), 1000);
    set(settings::for_axis(Id::min_corner_x, axis), -500);
  }
  return profile;
}

/// Short lines on a wave, each with a power of its own.
std::string wave(int lines, double x, double y) {
  std::string text;
  for (int i = 1; i <= lines; ++i)
    text += fmt::format("X{:.3f}Y{:.3f}S{}\n", x + 0.15 * i, y + 2 * std::sin(0.15 * i),
                        200 + 731 * i % 800);
  return text;
}

/// Pixels with individual powers, in one line.
std::string row(int pixels, double x, double pixel_mm) {
  std::string text = fmt::format("G1 X{:.3f} S", x + pixels * pixel_mm);
  for (int i = 0; i < pixels; ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ":", i % 5 == 0 ? 0 : 100 + 377 * i % 900);
  return text + "\n";
}

/// Some seconds with all kinds of motion and light.
std::string mixed_program() {
  return "G21 G90 G17 G94\nM127 P3.3\nM128 P71\nG0 X30 Y10\n"
         "M3 S400\nG1 X38 F9000\nG2 X46 Y18 I0 J8\nG3 X38 Y26 R8\nG1 X34 S900\n"
         "G0 X20 Y26\nM4 S1000\nG1 X20 Y20 F6000\nG5 I0 J-4 P0 Q4 X26 Y12\n"
         "G2 X26 Y12 I2 J0 Z-1\nG1 F5000\n" +
         wave(scaled(80), 26, 12) +
         "G4 P0.02\nG91 G1 X-3 Y1 Z1 F4000\nG18 G3 X-8 Z0 R6\nM5\nG90 G17 G0 X0 Y0\n"
         "M3 S700\nG1 X2 F8000\n" +
         row(scaled(60), 2, 0.13) + "M4\n" + row(scaled(60), 2 + scaled(60) * 0.13, -0.1) +
         "M126 P1\nG1 X20 S350\nG2 X28 Y8 I0 J8\nG1 X15 Y3 F12000\nM126 P0\nX0\nM2\n";
}

struct Program {
  std::string text = mixed_program();
  double seconds = 100;    ///< of the program to compare
  std::size_t dwells = 1;  ///< in the program; unknown for a file
};

/// The program that the environment names, or the built-in one.
Program program_to_compare() {
  Program program;
  if (const char* file = std::getenv("LAMPLOCK_PROGRAM")) {
    program.text = read_file(file);
    if (!program.text.ends_with('\n')) program.text += '\n';
    program.dwells = std::string::npos;
  }
  if (const char* seconds = std::getenv("LAMPLOCK_PROGRAM_SECONDS"))
    program.seconds = std::atof(seconds);
  return program;
}

struct ProgramRun {
  ProgramTrace trace;
  std::vector<std::string> answers;
  bool ended = false;
};

/// Runs to the end, or for the given time from the first step and a little longer.
ProgramRun run(sim::Board& board, const PinMonitor& monitor, const Program& program) {
  constexpr sim::Picoseconds start = 10 * ps_per_s, more = ps_per_s / 2;
  const auto length = static_cast<Picoseconds>(program.seconds * 1e12);
  ProgramSender sender(board);
  sender.give(program.text);
  const Picoseconds begin = board.now();
  while (monitor.nothing_happened() && !sender.answered() && board.now() < begin + start)
    sender.step();
  ProgramRun result;
  const Picoseconds end = board.now() + length + more;
  result.ended = sender.run_until_answered(end) && sender.run_until_idle(end);
  result.trace = trace_of(monitor, board.world().beam(), board.now());
  result.answers = sender.answers();
  return result;
}

/// Compares the answers that both have given.
void expect_same_answers(const std::vector<std::string>& ours,
                         const std::vector<std::string>& theirs) {
  const std::size_t count = std::min(ours.size(), theirs.size());
  std::size_t errors = 0;
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(ours[i], theirs[i]) << "line " << i + 1;
    if (ours[i] == "ok") continue;
    if (errors++ == 0)
      std::cout << "line " << i + 1 << " is the first refused: " << ours[i] << "\n";
  }
  std::cout << fmt::format("{} answers, {} errors\n", count, errors);
}

void print(const TraceComparison& steps, const LightComparison& light) {
  std::cout << fmt::format("{} steps: at most {:.3f} ns apart; {} edges of the gate: {:.3f} ns\n",
                           steps.steps(), static_cast<double>(steps.largest_step_error()) / 1e3,
                           steps.gate_edges(),
                           static_cast<double>(steps.largest_gate_error()) / 1e3);
  for (const Stretch& stretch : steps.stretches())
    std::cout << fmt::format(
        "from {:.6f} to {:.6f} s: the chip {:.3f} us later\n",
        sim::seconds(stretch.first - steps.stretches().front().first),
        sim::seconds(stretch.last - steps.stretches().front().first),
        static_cast<double>(stretch.offset - steps.stretches().front().offset) / 1e6);
  std::cout << fmt::format("power at {} times: off by {} of 65535; energy {:.6f} and {:.6f} s\n",
                           light.samples(), light.largest_error(), light.energy(),
                           light.other_energy());
}

/// Assignment of motors to axes.
struct Motors {
  std::string name;
  Id id;
  int value;
};
class ProgramTicks : public testing::TestWithParam<Motors> {};
INSTANTIATE_TEST_SUITE_P(Motors, ProgramTicks,
                         testing::Values(Motors{"Cartesian", Id::kinematics, 0},
                                         Motors{"CoreXy", Id::kinematics, 1},
                                         Motors{"Ganged", Id::ganged_axis, 2}),
                         [](const auto& test) { return test.param.name; });

TEST_P(ProgramTicks, AndLightAreThoseOfTheVirtualBoard) {
  const Program program = program_to_compare();
  job::Profile profile = laser_cutter();
  profile.settings.set_milli(Id::pin_map, 1000);  // A's motor is the second motor of an axis
  profile.settings.set_milli(GetParam().id, GetParam().value * 1000);
  sim::VirtualBoard board(profile.settings, chip_world(profile));
  const PinMonitor monitor(board.bus(), board.world().lamp());
  ProgramRun ours = run(board, monitor, program);
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  const ProgramRun theirs = run(rig.board, rig.monitor, program);
  ASSERT_EQ(ours.ended, theirs.ended);
  if (!ours.ended && ours.trace.total() != 0)
    ours.trace.cut(ours.trace.first_step() + static_cast<Picoseconds>(program.seconds * 1e12));
  expect_same_answers(ours.answers, theirs.answers);
  const TraceComparison steps(ours.trace, theirs.trace, ours.ended);
  // A cell has the power of its middle.
  constexpr Picoseconds raster = 9 * ps_per_us;
  const LightComparison light(ours.trace, theirs.trace, steps, raster);
  print(steps, light);
  EXPECT_EQ(steps.difference(), "");
  EXPECT_EQ(steps.steps(), ours.trace.total());
  EXPECT_EQ(steps.largest_step_error(), 0);
  EXPECT_EQ(rig.monitor.steps(3).size(),
            GetParam().id == Id::ganged_axis ? rig.monitor.steps(1).size() : 0);
  EXPECT_EQ(rig.board.world().drives().position(), board.world().drives().position());
  EXPECT_LE(steps.stretches().size() - 1, program.dwells);
  EXPECT_EQ(steps.largest_gate_error(), 0);
  // A duty has 2000 counts.
  EXPECT_LE(light.largest_error(), 66);
  EXPECT_NEAR(light.other_energy(), light.energy(), 0.005 * light.energy());
  expect_no_violations(rig);
}

}  // namespace
}  // namespace lamplock::test
