// Programs that begin in their middle (--from) or are dry (--dry), against whole programs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "firmware/program/interpreter.hpp"
#include "host/job/profile.hpp"
#include "host/program/board_state.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/program_run.hpp"
#include "host/program/start_at.hpp"
#include "host/program/without_laser.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using program_run::Piece;
using program_run::Pieces;
using testing::HasSubstr;

settings::Values laser_settings() {
  settings::Values values = job::default_profile().settings;
  values.set_milli(settings::Id::laser_mode, 1000);
  return values;
}

std::string text_of(const std::vector<link::ProgramLine>& lines) {
  std::string text;
  for (const link::ProgramLine& line : lines) text += line.text + "\n";
  return text;
}

Pieces pieces_of(const std::string& text) {
  const auto run = program_run::run_program(text, laser_settings(), 10);
  for (const auto& problem : run.problems)
    ADD_FAILURE() << problem.line << ": " << problem.text << "\n" << text;
  return run.pieces;
}

/// The first line places every axis; units, distances, planes, feeds and power follow at random.
std::string random_program(std::mt19937_64& random, int lines) {
  const auto mm = [&random] { return static_cast<double>(random() % 2000) / 1000 - 1; };
  std::string text = "G21 G90 G0 X0 Y0 Z0\nG1 F600 S100\n";
  for (int i = 0; i < lines; ++i) {
    switch (random() % 8) {
      case 0:
        text += random() % 2 == 0 ? "G20\n" : "G21\n";
        break;
      case 1:
        text += random() % 2 == 0 ? "G91\n" : "G90\n";
        break;
      case 2:
        text += random() % 3 == 0 ? "M5\n" : random() % 2 == 0 ? "M3\n" : "M4\n";
        break;
      case 3:
        text += fmt::format("S{} F{}\n", random() % 1000, 20 + random() % 600);
        break;
      case 4:
        text += random() % 2 == 0 ? "G0\n" : "G1\n";
        break;
      default:
        // Small values, because of inches and incremental distances.
        text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", 0.2 * mm(), 0.2 * mm(), 0.2 * mm());
    }
  }
  return text;
}

void expect_same(const Pieces& all, const Pieces& part) {
  // The part's pieces equal those at the end of the whole program.
  ASSERT_GE(all.size(), part.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Piece &wanted = all[all.size() - part.size() + i], &made = part[i];
    for (std::size_t a = 0; a < 3; ++a) ASSERT_NEAR(made.to[a], wanted.to[a], 1e-6);
    ASSERT_EQ(made.rapid, wanted.rapid);
    ASSERT_NEAR(made.power, wanted.power, 1e-9);
  }
}

TEST(ProgramParts, BeginInTheMiddleAsIfTheyHadRunFromTheBeginning) {
  std::mt19937_64 random(8);
  for (int round = 0; round < scaled(200); ++round) {
    const auto lines = link::program_lines(random_program(random, 30), "part.ngc");
    const std::size_t first = 3 + random() % 30;
    const auto part = program_run::start_at(lines, first, laser_settings(), "part.ngc");
    SCOPED_TRACE(fmt::format("from {}\n{}", first, text_of(part)));
    std::size_t approach = 0;
    while (approach < part.size() && part[approach].text != lines[first - 1].text) ++approach;
    const auto pieces = pieces_of(text_of(part));
    const auto rest =
        std::find_if(pieces.begin(), pieces.end(), [](const Piece& piece) { return !piece.rapid; });
    // The approach is dark; it need not be shorter than the omitted part.
    for (auto piece = pieces.begin(); piece != rest; ++piece) EXPECT_EQ(piece->power, 0);
    ASSERT_NO_FATAL_FAILURE(expect_same(pieces_of(text_of(lines)), Pieces(rest, pieces.end())));
  }
}

TEST(ProgramParts, KeepParametersAndExpressions) {
  const std::string text =
      "#1 = 2.5 #<Wide One>=-1\nM3 S[#1*10] G1 F600 X[#1 + SIN[30]]\n#2=#1 Y#<wide one>\nX-#2 "
      "S#1\n";
  const auto lines = link::program_lines(text, "p.ngc");
  const auto all = pieces_of(text);
  for (std::size_t first = 2; first <= 4; ++first) {
    const auto part = program_run::start_at(lines, first, laser_settings(), "p.ngc");
    const auto pieces = pieces_of(text_of(part));
    EXPECT_EQ(pieces.back().to, all.back().to) << text_of(part);
    EXPECT_EQ(pieces.back().power, all.back().power) << text_of(part);
  }
  const auto dark = program_run::without_laser(
      link::program_lines("#1=SIN[30] S#1 G1 F60 X[#1 mod 3]S [2+1] Y ATAN[1] / [#1]\n", "p.ngc"),
      "p.ngc");
  EXPECT_EQ(text_of(dark), "M5\n#1=SIN[30] G1 F60 X[#1 mod 3]Y ATAN[1] / [#1]\n");
  EXPECT_THAT(error_of([] {
                program_run::without_laser(link::program_lines("M[3] S1\n", "p.ngc"), "p.ngc");
              }),
              HasSubstr("p.ngc:1: --dry cannot leave 'M[3]' out"));
}

/// Where a program ends on a board with these offsets.
program::Place end_of(const std::vector<link::ProgramLine>& lines,
                      const program_run::BoardState& state) {
  program::Parameters parameters;
  const program::Options options = program_run::program_options(laser_settings());
  program::Interpreter interpreter(parameters, options);
  program_run::begin_with(state, interpreter, parameters);
  for (const link::ProgramLine& line : lines) {
    EXPECT_FALSE(interpreter.run(line.text)) << line.text;
    for (program::Action action; interpreter.next(action);) {
    }
  }
  return interpreter.machine_e7();
}

TEST(ProgramParts, BeginInRotatedSystems) {
  link::BoardStatus status;
  status.state = "Idle";
  status.position = {3, 4, 5};
  std::vector<std::string> offsets{"[G54:10.000,20.000,1.000]", "[G55:-5.000,0.000,0.000]",
                                   "[G92:1.000,2.000,0.000]", "[TLO:0.000]",
                                   "[ROT:90,-30.0000001,0,0,0,0,0,0,0]"};
  for (const char* const system : {"G56", "G57", "G58", "G59"})
    offsets.push_back(fmt::format("[{}:0.000,0.000,0.000]", system));
  const auto state =
      program_run::parse_state(status, offsets, {"[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"}, {});
  ASSERT_TRUE(state);
  EXPECT_EQ(state->parameters.rotations_e7[0], 90 * program::one_e7);
  EXPECT_EQ(state->parameters.rotations_e7[1], -300'000'001);
  EXPECT_FALSE(state->as_after_power_up);
  const auto lines =
      link::program_lines("G54 G0 X1 Y2\nZ3\nG55 G1 F600 X3\nY4\nG54 X5\nX6 Y6\nG55 X1\n", "p.ngc");
  const program::Place whole = end_of(lines, *state);
  EXPECT_NEAR(static_cast<double>(whole[2]), 4e7, 1);
  for (std::size_t first = 2; first <= lines.size(); ++first) {
    const auto part = program_run::start_at(lines, first, laser_settings(), "p.ngc", state);
    const program::Place end = end_of(part, *state);
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(static_cast<double>(end[a]), static_cast<double>(whole[a]), 4) << text_of(part);
  }
}

TEST(ProgramParts, BeginWithARotaryAxisInDegreesBesideInches) {
  settings::Values values;
  values.set_milli(settings::Id::report_inches, 1000);
  values.set_milli(settings::Id::rotary_axis, 1000);
  link::BoardStatus status;
  status.state = "Idle";
  status.position = {1, 2, 3, 90};
  std::vector<std::string> offsets{"[G92:0.0000,0.0000,0.0000,0.000]", "[TLO:0.0000]"};
  for (const char* const system : {"G54", "G55", "G56", "G57", "G58", "G59"})
    offsets.push_back(fmt::format("[{}:0.1000,0.0000,0.0000,45.000]", system));
  const auto state = program_run::parse_state(
      status, offsets, {"[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0.0 S0]"}, inch_axes(values));
  ASSERT_TRUE(state);
  EXPECT_EQ(state->machine_e7,
            (program::Place{254'000'000, 508'000'000, 762'000'000, 900'000'000}));
  EXPECT_EQ(state->parameters.systems_e7[0], (program::Place{25'400'000, 0, 0, 450'000'000}));
}

TEST(ProgramParts, RefuseToOmitWhatCannotBeReplaced) {
  const auto refusal = [](const std::string& text, std::size_t first) {
    return error_of([&] {
      program_run::start_at(link::program_lines(text, "part.ngc"), first, laser_settings(),
                            "part.ngc");
    });
  };
  EXPECT_THAT(refusal("G92 X0\nG0 X1\n", 2),
              HasSubstr("part.ngc:1: --from cannot leave 'G92' out"));
  EXPECT_THAT(refusal("$H\nG0 X1\n", 2), HasSubstr("line for the board"));
  EXPECT_THAT(refusal("G91\nG0 X1\nG0 X1\n", 3), HasSubstr("part.ngc:2: moves X by a distance"));
  EXPECT_THAT(refusal("G0 X1\n", 9), HasSubstr("--from 9"));
  EXPECT_THAT(refusal("G0 X0 Y0\nG2 X1 I0.5 F100\nX0 I-0.5\n", 3), HasSubstr("curve or cycle"));
  EXPECT_THAT(refusal("G0 X0 Y0\nG1 X1\nX0\n", 3), HasSubstr("part.ngc:2"));  // no feed
}

TEST(ProgramParts, AreDarkWhenTheyAreDry) {
  std::mt19937_64 random(9);
  for (int round = 0; round < scaled(100); ++round) {
    const auto lines =
        link::program_lines(random_program(random, 30) + "G1 X0 S5:0:7*2\n", "p.ngc");
    const auto dark = program_run::without_laser(lines, "p.ngc");
    const auto pieces = pieces_of(text_of(dark));
    for (const Piece& piece : pieces) ASSERT_EQ(piece.power, 0) << text_of(dark);
    ASSERT_EQ(pieces.back().to, pieces_of(text_of(lines)).back().to);
  }
  EXPECT_THAT(error_of([] {
                program_run::without_laser(link::program_lines("M130 P0\n", "p.ngc"), "p.ngc");
              }),
              HasSubstr("p.ngc:1: --dry cannot leave 'M130' out"));
}

}  // namespace
}  // namespace lamplock::test
