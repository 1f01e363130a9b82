// Cutter compensation of random programs by the board's interpreter and by LinuxCNC's rs274: the
// same moves end in the same places, and the same lines are refused.
//
// Differences that the programs avoid, named in docs/gcode.md: nearly straight corners, which rs274
// passes without a corner up to 0.01 radians; an entry on an arc, which only rs274 has; moves along
// Z directly after G40, which rs274 lets slope to the programmed place. Where the cutter does not
// fit the board refuses more: rs274 checks an inner corner only at the end of the block before it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/program/contour_programs.hpp"
#include "tests/program/rig.hpp"
#include "tests/program/rs274.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::rs274_compensation_test {
namespace {

using lamplock::test::scaled;
using test::CanonicalLine;
using test::CanonicalMove;
using test::Rig;
using test::Rs274;
using Ends = std::vector<std::array<double, 3>>;

/// rs274 prints four decimals of a millimetre.
constexpr double end_tolerance_mm = 1e-4;
constexpr std::string_view reset = "G40 G21 G17 G90 G91.1 G94 G49 G54 G61 G80 M5 F100";

/// The largest of the axes.
double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Without moves of no length, which rs274 prints.
void add(Ends& ends, const std::array<double, 3>& end) {
  if (ends.empty() || distance(ends.back(), end) > end_tolerance_mm) ends.push_back(end);
}

std::string text_of(const Ends& ends) {
  std::string text;
  for (const auto& end : ends)
    text += fmt::format("{:.4f} {:.4f} {:.4f}; ", end[0], end[1], end[2]);
  return text;
}

struct Case {
  Rs274::Program program;
  std::vector<test::ContourBlock> contour;
  double radius;
};

/// Whether the moves of rs274 come nearer to the contour than the radius.
bool gouges(const Case& made, const std::vector<CanonicalLine>& lines) {
  constexpr double gouge_mm = 0.01;
  constexpr int samples = 200;
  std::array<double, 2> at{};
  int feeds = 0;
  for (const CanonicalLine& line : lines)
    for (const CanonicalMove& move : line.moves) {
      if (move.kind == CanonicalMove::Kind::dwell) continue;
      test::ContourBlock path{at, {move.to_mm[0], move.to_mm[1]}, move.centre_mm, 0};
      at = path.to;
      if (move.kind == CanonicalMove::Kind::arc) {
        constexpr double turn = 2 * std::numbers::pi;
        const auto angle = [&](const std::array<double, 2>& place) {
          return std::atan2(place[1] - path.centre[1], place[0] - path.centre[0]);
        };
        path.sweep = angle(path.to) - angle(path.from);
        if (move.turns > 0 && path.sweep <= 0) path.sweep += turn;
        if (move.turns < 0 && path.sweep >= 0) path.sweep -= turn;
      }
      // The first one is the entry.
      if (move.kind == CanonicalMove::Kind::rapid || ++feeds == 1) continue;
      for (int s = 0; s <= samples; ++s) {
        const auto [x, y] = test::contour_place(path, static_cast<double>(s) / samples);
        for (std::size_t k = 1; k < made.contour.size(); ++k)
          if (test::contour_distance(made.contour[k], x, y) < made.radius - gouge_mm) return true;
      }
    }
  return false;
}

/// `gouged`: rs274 cuts into the contour; `stricter`: it passes a short block backwards.
enum class Outcome { same, refused, gouged, stricter };

/// Compares up to the first line that one of them refuses.
Outcome compare(const Case& made, const std::vector<CanonicalLine>& lines) {
  Rig rig;
  rig.options.arc_tolerance_e7 = 100'000;
  rig.run(reset);
  Ends ours, theirs;
  std::string text;
  bool refused = false;
  for (std::size_t i = 0; i < made.program.size() && !refused; ++i) {
    text += made.program[i] + "\n";
    const Fault fault = rig.interpreter.run(made.program[i]);
    refused = static_cast<bool>(fault);
    if (fault.error == GcodeError::cutter_too_large && lines[i].refusal.empty())
      return gouges(made, lines) ? Outcome::gouged : Outcome::stricter;
    EXPECT_EQ(refused, !lines[i].refusal.empty())
        << text << test::text_of(fault) << " / " << lines[i].refusal;
    for (const Action& action : rig.take())
      if (action.kind == ActionKind::move && action.programmed_end)
        add(ours, {static_cast<double>(action.target_e7[0]) / one_e7,
                   static_cast<double>(action.target_e7[1]) / one_e7,
                   static_cast<double>(action.target_e7[2]) / one_e7});
    for (const CanonicalMove& move : lines[i].moves)
      if (move.kind != CanonicalMove::Kind::dwell)
        add(theirs, {move.to_mm[0], move.to_mm[1], move.to_mm[2]});
  }
  // After an error rs274 may still make the move that waited.
  if (refused && theirs.size() > ours.size()) theirs.resize(ours.size());
  bool same = ours.size() == theirs.size();
  for (std::size_t i = 0; same && i < ours.size(); ++i)
    same = distance(ours[i], theirs[i]) <= end_tolerance_mm;
  EXPECT_TRUE(same) << text << text_of(ours) << "\n / " << text_of(theirs);
  return refused ? Outcome::refused : Outcome::same;
}

TEST(Rs274Compensation, RandomContoursMoveAlike) {
  if (!Rs274::available()) GTEST_SKIP() << "toolchain/setup could not unpack rs274";
  constexpr int programs_a_process = 50;
  const int count = scaled(1000, 100);
  Rs274 rs274;
  int same = 0, gouged = 0, stricter = 0;
  for (int done = 0; done < count; done += programs_a_process) {
    test::ContourPrograms random(1 + static_cast<unsigned>(done));
    std::vector<Case> cases;
    std::vector<Rs274::Program> programs;
    for (int i = 0; i < programs_a_process; ++i) {
      programs.push_back(random.any_program());
      cases.push_back({programs.back(), random.contour(), random.radius()});
    }
    const auto results = rs274.run(programs, reset);
    for (std::size_t i = 0; i < programs.size(); ++i) {
      const Outcome outcome = compare(cases[i], results[i]);
      same += outcome == Outcome::same ? 1 : 0;
      gouged += outcome == Outcome::gouged ? 1 : 0;
      stricter += outcome == Outcome::stricter ? 1 : 0;
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(same, count / 5);
  EXPECT_LT(gouged, count / 10);
  EXPECT_LE(stricter, count / 100);
}

}  // namespace
}  // namespace lamplock::program::rs274_compensation_test
