// Paths of mills, drag knives and lathes: properties over random contours; the blade of a knife is
// simulated as a trailing wheel.
#include "host/cutting/tool_path.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/cutting/post_file.hpp"
#include "host/error.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::tool_path_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using testing::HasSubstr;
using namespace lamplock::test;

Stroke stroke_of(const Contour& contour) {
  Stroke stroke;
  for (const Edge& edge : contour.edges) stroke.push_back({edge, CutKind::cut, 1});
  return stroke;
}

double length_of(const Stroke& stroke) {
  double length = 0;
  for (const CutMove& move : stroke) length += cutting::length_of(move.edge);
  return length;
}

TEST(tool_path, a_mill_descends_by_its_angle_and_cuts_the_whole_stroke_at_the_depth) {
  Random random(301);
  for (int i = 0; i < scaled(200, 40); ++i) {
    Stroke stroke = stroke_of(random_star(random, {5, 8}, 6, 11, 9));
    const bool has_tab = i % 2 == 0;
    if (has_tab) {
      stroke[4].kind = CutKind::tab;
      stroke[4].power = 0.25;
    }
    Tooling tooling;
    tooling.ramp_deg = 1 + 80 * random.uniform();
    tooling.surface_mm = -3;
    const PassHeights pass{-4, -6, -8};
    const std::vector<ToolMove> path = mill_path(stroke, pass, tooling);
    const double slope = std::tan(tooling.ramp_deg * pi / 180);
    double z = pass.from_mm, deep = 0;
    Vec at = stroke.front().edge.from;
    for (const ToolMove& move : path) {
      EXPECT_NEAR(distance(move.edge.from, at), 0, 1e-9);
      const double length = cutting::length_of(move.edge);
      // Beside the sides of a tab the height is continuous.
      const bool is_tab = has_tab && (move.z_to_mm > pass.to_mm || z > pass.to_mm) &&
                          move.z_from_mm == move.z_to_mm;
      if (!is_tab) {
        EXPECT_NEAR(move.z_from_mm, z, 1e-9);
      }
      EXPECT_LE(std::abs(move.z_to_mm - move.z_from_mm), slope * length + 1e-6);
      EXPECT_LE(std::abs(move.edge.sweep), pi * (1 + 1e-6)) << "helices are at most half circles";
      if (move.z_from_mm == move.z_to_mm && move.z_to_mm == pass.to_mm) deep += length;
      z = move.z_to_mm;
      at = move.edge.to;
    }
    EXPECT_NEAR(distance(at, stroke.back().edge.to), 0, 1e-9);
    const double tab = has_tab ? cutting::length_of(stroke[4].edge) : 0;
    EXPECT_NEAR(deep, length_of(stroke) - tab, 1e-6);
    const auto is_shallow = [](const ToolMove& move) {
      return move.z_from_mm == -3 + 0.25 * -5 && move.z_to_mm == move.z_from_mm;
    };
    EXPECT_EQ(std::any_of(path.begin(), path.end(), is_shallow), has_tab)
        << "a tab leaves three quarters of the depth";
  }
}

/// Tabs at random places, in all passes: what a pass has not reached yet is entered by a ramp.
TEST(tool_path, a_mill_never_drills_into_the_stock) {
  Random random(303);
  for (int i = 0; i < scaled(200, 40); ++i) {
    Stroke stroke = stroke_of(random_star(random, {5, 8}, 6, 11, 9));
    for (CutMove& move : stroke)
      if (random.uniform() < 0.3) move = {move.edge, CutKind::tab, i % 3 * 0.3};
    Tooling tooling;
    tooling.ramp_deg = 5 + 60 * random.uniform();
    const double slope = std::tan(tooling.ramp_deg * pi / 180);
    for (PassHeights pass{0, -1, -4}; pass.to_mm >= pass.final_mm;
         pass.from_mm = pass.to_mm, pass.to_mm -= 1) {
      double z = tooling.clearance_mm;
      for (const ToolMove& move : mill_path(stroke, pass, tooling)) {
        if (move.z_from_mm < z - 1e-9) {
          EXPECT_GE(move.z_from_mm, pass.from_mm - 1e-9) << "drills below the pass before";
        }
        EXPECT_LE(move.z_from_mm - move.z_to_mm, slope * cutting::length_of(move.edge) + 1e-6);
        z = move.z_to_mm;
      }
    }
  }
}

/// A blade that follows the swivel axis without slip to its sides: its direction turns by the part
/// of the motion across it, divided by the offset. Largest distance of its tip from the stroke.
double error_of_blade(const std::vector<ToolMove>& path, const Stroke& stroke, double offset_mm,
                      Vec heading, Vec& last) {
  constexpr double step_mm = 2e-3;
  double angle = std::atan2(heading.y, heading.x), error = 0;
  for (const ToolMove& move : path) {
    const int steps = 1 + static_cast<int>(cutting::length_of(move.edge) / step_mm);
    Vec axis = move.edge.from;
    for (int i = 1; i <= steps; ++i) {
      const Vec next = point_at(move.edge, static_cast<double>(i) / steps), way = next - axis;
      // The midpoint rule.
      const auto turn = [&](double at) {
        return cross({std::cos(at), std::sin(at)}, way) / offset_mm;
      };
      angle += turn(angle + turn(angle) / 2);
      axis = next;
      last = axis - Vec{std::cos(angle), std::sin(angle)} * offset_mm;
      double nearest = 1e9;
      for (const CutMove& cut : stroke) nearest = std::min(nearest, distance_to(cut.edge, last));
      error = std::max(error, nearest);
    }
  }
  return error;
}

TEST(tool_path, the_blade_of_a_drag_knife_follows_the_contour) {
  Random random(302);
  Vec heading{1, 0};
  for (int i = 0; i < scaled(12, 4); ++i) {
    const Stroke stroke = stroke_of(random_star(random, {0, 0}, 6, 11, 9));
    Tooling tooling;
    tooling.knife_offset_mm = 0.2 + random.uniform();
    const Vec before = heading;
    const std::vector<ToolMove> path = knife_path(stroke, {0, -1, -1}, tooling, heading);
    for (std::size_t k = 1; k < path.size(); ++k)
      EXPECT_NEAR(distance(path[k].edge.from, path[k - 1].edge.to), 0, 1e-9);
    Vec last;
    EXPECT_LE(error_of_blade(path, stroke, tooling.knife_offset_mm, before, last), 2e-4);
    EXPECT_NEAR(distance(last, stroke.back().edge.to), 0, 2e-4);
    EXPECT_NEAR(distance(heading, direction_at(stroke.back().edge, 1)), 0, 1e-12);
    EXPECT_EQ(path.front().z_to_mm, 0) << "the blade turns on the surface";
  }
}

Operation tool_operation(std::vector<double> z_mm) {
  Operation one;
  one.name = "cut";
  one.power = 0.5;
  one.feed_mm_min = 300;
  one.z_mm = std::move(z_mm);
  return one;
}

std::string program_of(const Contour& contour, const Operation& one, const char* post,
                       const Tooling& tooling, bool has_radii = false) {
  std::vector<Shape> shapes{{contour, {}, 0}};
  place_shapes(shapes, {one});
  ProgramFrame frame{"part", {"cut"}, 1000, tooling, has_radii};
  return cut_program(plan_cuts(shapes, {one}, {0, 0}), {one}, post_of(post), frame);
}

/// A line of 20 mm, a ramp of 45 degrees: 1 mm back and forth for a depth of 2 mm.
TEST(tool_path, a_program_of_a_mill_line_by_line) {
  Tooling tooling;
  tooling.ramp_deg = 45;
  const Contour line{{{{0, 0}, {20, 0}, {}, 0}}, false};
  EXPECT_EQ(program_of(line, tool_operation({-2, -3}), "mill", tooling),
            "(part)\nG21 G90 G17 G94 G40\nM3 S500\n(1: cut)\n"
            "G0 Z5\nG0 X0 Y0\nG1 Z0 F300\n"
            "G1 X1 Z-1\nG1 X0 Z-2\nG1 X20\n"
            "G0 Z5\nG0 X0 Y0\nG1 Z-2\n"
            "G1 X0.5 Z-2.5\nG1 X0 Z-3\nG1 X20\n"
            "G0 Z5\nM5\nM2\n");
}

TEST(tool_path, a_program_of_a_knife_line_by_line) {
  Tooling tooling;
  tooling.knife_offset_mm = 0.5;
  const Contour corner{{{{0, 0}, {10, 0}, {}, 0}, {{10, 0}, {10, 10}, {}, 0}}, false};
  EXPECT_EQ(program_of(corner, tool_operation({-1}), "knife", tooling),
            "(part)\nG21 G90 G17 G94 G40\n(1: cut)\n"
            "G0 Z5\nG0 X0.5 Y0\nG1 Z-1 F300\nG1 X10.5\nG3 X10 Y0.5 I-0.5 J0\nG1 Y10.5\n"
            "G0 Z5\nM2\n");
}

/// A shaft: face, diameter 20, shoulder with a radius of 2, diameter 30. The other program has
/// radii, for the interpreter.
TEST(tool_path, a_program_of_a_lathe_line_by_line) {
  const Contour shaft{{{{0, 0}, {0, 10}, {}, 0},
                       {{0, 10}, {-20, 10}, {}, 0},
                       arc_from({-20, 12}, {-20, 10}, -pi / 2),
                       {{-22, 12}, {-22, 15}, {}, 0}},
                      false};
  const std::string head = "(part)\nG21 G90 G18 G94 G40\nM3 S500\n(1: cut)\n";
  EXPECT_EQ(program_of(shaft, tool_operation({}), "lathe", {}),
            head +
                "G0 X40\nG0 Z0\nG1 X0 F300\nG1 X20\nG1 Z-20\nG2 X24 Z-22 I2 K0\nG1 X30\n"
                "G0 X40\nM5\nM2\n");
  EXPECT_THAT(program_of(shaft, tool_operation({}), "lathe", {}, true),
              HasSubstr("G0 X20\nG0 Z0\nG1 X0 F300\nG1 X10\nG1 Z-20\nG2 X12 Z-22 I2 K0\nG1 X15\n"));
  // Two passes: the first one is 0.5 mm farther outside.
  EXPECT_THAT(program_of(shaft, tool_operation({-0.5, -1}), "lathe", {}),
              HasSubstr("G0 X41\nG0 Z0\nG1 X1 F300\nG1 X21\n"));
}

/// The message about a contour that is turned; empty if there is none.
std::string lathe_error(const std::vector<Edge>& edges, bool is_closed = false) {
  try {
    program_of({edges, is_closed}, tool_operation({-0.6, -1.2}), "lathe", {});
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(tool_path, a_lathe_turns_profiles_alone) {
  const auto line = [](Vec from, Vec to) { return Edge{from, to, {}, 0}; };
  EXPECT_THAT(lathe_error({line({0, -1}, {10, 5})}), HasSubstr("beyond the axis"));
  const std::vector<Edge> square{line({0, 0}, {0, 10}), line({0, 10}, {-10, 10}),
                                 line({-10, 10}, {-10, 0}), line({-10, 0}, {0, 0})};
  EXPECT_THAT(lathe_error(square, true), HasSubstr("is closed, and the tool would cut through"));
  EXPECT_THAT(lathe_error({square.begin() + 1, square.end()}), HasSubstr("runs along the axis"));
  EXPECT_THAT(lathe_error({square[3], square[0], square[1]}), HasSubstr("along the axis"));
  EXPECT_EQ(lathe_error({square[0], square[1], square[2]}), "") << "turned and cut off";
  // A groove that is wider at its bottom, in both directions.
  for (const double side : {-1.0, 1.0})
    EXPECT_THAT(lathe_error({line({0, 10}, {side * 10, 10}), line({side * 10, 10}, {side * 9, 5}),
                             line({side * 9, 5}, {side * 20, 5})}),
                HasSubstr("goes back along the axis"));
  // A ball at the end is a profile up to its widest place, and none beyond it or beside it.
  EXPECT_EQ(lathe_error({arc_from({0, 0}, {10, 0}, pi / 2)}), "");
  EXPECT_EQ(lathe_error({arc_from({0, 0}, {10, 0}, pi)}), "") << "the whole ball";
  EXPECT_THAT(lathe_error({arc_from({0, 12}, {0, 2}, pi)}), HasSubstr("goes back"));
  EXPECT_THAT(lathe_error({arc_from({0, 12}, {0, 22}, pi), line({0, 2}, {-5, 2})}),
              HasSubstr("goes back"));
}

}  // namespace
}  // namespace lamplock::cutting::tool_path_test
