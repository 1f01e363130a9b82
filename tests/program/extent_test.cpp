// Extents of lines: no action of a line leaves its box, and the box is no larger than needed.
#include "firmware/program/extent.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::extent_test {
namespace {

using lamplock::test::scaled;
using test::Rig;

/// Rounding of points, in 10^-7 mm, and how far a chord may stay inside of an extreme.
constexpr std::int64_t rounding_e7 = 4, chord_e7 = 60;

std::mt19937_64 random_numbers(4);

std::string one_of(std::initializer_list<const char*> texts) {
  return texts.begin()[random_numbers() % texts.size()];
}
std::string number(int most) {
  const int span = 2 * most * 1000 + 1;
  const int milli = static_cast<int>(random_numbers() % static_cast<unsigned>(span)) - most * 1000;
  return fmt::format("{:.3f}", milli / 1e3);
}
double positive(int most) {
  return static_cast<double>(1 + random_numbers() % static_cast<unsigned>(most * 1000)) / 1e3;
}

/// The end is on the circle, within a hundredth of a micrometre.
std::string arc() {
  const unsigned plane = static_cast<unsigned>(random_numbers() % 3);
  const char* const letters = plane == 0 ? "XYIJZ" : plane == 1 ? "ZXKIY" : "YZJKX";
  const double radius = positive(40), from = positive(6), to = positive(6);
  const double i = std::round(-radius * std::cos(from) * 1e6) / 1e6;
  const double j = std::round(-radius * std::sin(from) * 1e6) / 1e6;
  std::string line = fmt::format("G91 G{} {} {}{:.6f} {}{:.6f}", 17 + plane, one_of({"G2", "G3"}),
                                 letters[2], i, letters[3], j);
  if (random_numbers() % 8 != 0)
    line += fmt::format(" {}{:.6f} {}{:.6f}", letters[0], i + std::hypot(i, j) * std::cos(to),
                        letters[1], j + std::hypot(i, j) * std::sin(to));
  if (random_numbers() % 4 == 0) line += fmt::format(" {}{}", letters[4], number(5));
  if (random_numbers() % 8 == 0) line += " P2";
  return line;
}

std::string spline() {
  const int size = random_numbers() % 4 == 0 ? 1 : 30;
  if (random_numbers() % 4 == 0)
    return fmt::format("G17 G91 G5.1 I{} J{} X{} Y{}", number(size), number(size), number(size),
                       number(size));
  return fmt::format("G17 G91 G5 I{} J{} P{} Q{} X{} Y{}", number(size), number(size), number(size),
                     number(size), number(size), number(size));
}

std::string cycle() {
  const std::string kind = one_of({"G81", "G82 P0", "G83 Q0.9", "G73 Q1.1", "G85", "G86 P0"});
  const std::string plane = one_of({"G17", "G18", "G19"});
  const char normal = plane == "G17" ? 'Z' : plane == "G18" ? 'Y' : 'X';
  std::string line = fmt::format("{} {} {} {} R{} {}-{:.3f}", plane, one_of({"G98", "G99"}),
                                 one_of({"G90", "G91"}), kind, number(3), normal, 3 + positive(9));
  for (const char letter : {'X', 'Y', 'Z', 'A'})
    if (letter != normal && random_numbers() % 2 == 0)
      line += fmt::format(" {}{}", letter, number(9));
  if (random_numbers() % 2 == 0) line += fmt::format(" L{}", 1 + random_numbers() % 4);
  return line;
}

std::string by_way_of() {
  return one_of({"G90 G28", "G91 G30"}) + " X" + number(9) + " Z" + number(9);
}

/// Runs a line at a random place; its actions must be inside its box, and if it is `exact` the box
/// must not be larger.
void expect_box_of(const std::string& line, const std::string& rotation, bool exact) {
  Rig rig;
  rig.options.arc_tolerance_e7 = 50;
  const std::string start =
      fmt::format("F100 X{} Y{} Z{} A{}", number(20), number(20), number(20), number(20));
  ASSERT_EQ(rig.run(start).find('@'), std::string::npos);
  rig.run_all(rotation);
  const Extent before(rig.machine());
  const Fault fault = rig.interpreter.run(line);
  if (fault) return;  // radii may differ by rounding
  ASSERT_TRUE(rig.interpreter.has_extent()) << line;
  const Extent box = rig.interpreter.extent();
  Extent reached = before;
  for (const Action& action : rig.take())
    if (action.kind == ActionKind::move) reached.add(action.target_e7);
  for (std::size_t i = 0; i < 4; ++i) {
    // A line by way of a place has no box at its start, where the machine is in any case.
    const std::int64_t low = std::min(box.low()[i], before.low()[i]);
    const std::int64_t high = std::max(box.high()[i], before.high()[i]);
    ASSERT_LE(low, reached.low()[i] + rounding_e7) << start << "\n" << rotation << "\n" << line;
    ASSERT_GE(high, reached.high()[i] - rounding_e7) << start << "\n" << rotation << "\n" << line;
    if (!exact) continue;
    ASSERT_GE(low, reached.low()[i] - chord_e7) << start << "\n" << rotation << "\n" << line;
    ASSERT_LE(high, reached.high()[i] + chord_e7) << start << "\n" << rotation << "\n" << line;
  }
}

TEST(Extent, OfLinesWithoutRotation) {
  for (int i = 0; i < scaled(600); ++i) {
    expect_box_of(arc(), "", true);
    expect_box_of(spline(), "", true);
    expect_box_of(cycle(), "", true);
    expect_box_of(by_way_of(), "", true);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// A rotated coordinate system, and G68 in it.
TEST(Extent, OfLinesInRotatedSystems) {
  for (int i = 0; i < scaled(400); ++i) {
    const std::string plane = one_of({"G17", "G18", "G19"});
    const std::string rotation = fmt::format("G10 L2 P1 X{} R{}|{}{}", number(9), number(360),
                                             plane, one_of({"", " G68 R33"}));
    const bool flat = plane == "G17" || rotation.find("G68") == std::string::npos;
    std::string line = arc();
    expect_box_of(line, rotation, flat && line.find("G17") != std::string::npos);
    expect_box_of(spline(), rotation, true);
    expect_box_of(by_way_of(), rotation, true);
    line = cycle();
    expect_box_of(line, rotation, flat && line.find("G17") != std::string::npos);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// Turned in its own plane a curve has an exact box, too.
TEST(Extent, OfTurnedLines) {
  for (int i = 0; i < scaled(400); ++i) {
    const std::string plane = one_of({"G17", "G18", "G19"});
    const std::string rotation = fmt::format("{} G68 R{}", plane, number(360));
    std::string line = arc();
    expect_box_of(line, rotation, line.find(plane) != std::string::npos);
    expect_box_of(spline(), rotation, true);
    expect_box_of(by_way_of(), rotation, true);
    line = cycle();
    expect_box_of(line, rotation, line.find(plane) != std::string::npos);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// A spiral counts with its larger radius.
TEST(Extent, OfASpiral) {
  Rig rig;
  ASSERT_FALSE(rig.interpreter.run("G3 X20 Y0.4 I10 F100"));
  const Extent box = rig.interpreter.extent();
  EXPECT_NEAR(static_cast<double>(box.low()[1]), -10.008e7, 1e4);
  EXPECT_EQ(box.high()[1], test::mm(0.4));
}

TEST(Extent, OfAStraightMoveIsItsEnd) {
  Rig rig;
  for (const char* line :
       {"G0 X1", "G1 X2 F100", "G38.2 X3", "G53 G0 X1", "M3 S1", "G4 P1", "G28"}) {
    rig.interpreter.run(line);
    EXPECT_FALSE(rig.interpreter.has_extent()) << line;
    rig.take();
  }
}

}  // namespace
}  // namespace lamplock::program::extent_test
