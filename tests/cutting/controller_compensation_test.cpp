// Programs with the compensation of the controller: the board's interpreter leads the beam where
// the host's own compensation does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "host/cutting/cut_plan.hpp"
#include "host/cutting/post_file.hpp"
#include "host/error.hpp"
#include "tests/cutting/plans.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::controller_compensation_test {
namespace {

using geometry::Random;
using namespace lamplock::test;

constexpr double tolerance_mm = 0.002;

/// Lines with light, as the board's interpreter makes them of a program.
std::vector<Edge> traced(const std::string& text) {
  program::Parameters parameters;
  program::Options options;
  options.laser = true;
  options.arc_tolerance_e7 = 100;
  program::Interpreter interpreter(parameters, options);
  std::vector<Edge> edges;
  Vec at;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(interpreter.run(line).error, GcodeError::none) << line;
    program::Action action;
    while (interpreter.next(action)) {
      if (action.kind != program::ActionKind::move) continue;
      const auto mm = [&](std::size_t axis) {
        return static_cast<double>(action.target_e7[axis]) / program::one_e7;
      };
      const Vec to{mm(0), mm(1)};
      if (!action.rapid && action.spindle != program::Spindle::off && action.speed_milli != 0)
        edges.push_back({at, to, {}, 0});
      at = to;
    }
  }
  return edges;
}

double distance_to_all(const std::vector<Edge>& edges, const Vec& point) {
  double least = 1e9;
  for (const Edge& edge : edges) least = std::min(least, distance_to(edge, point));
  return least;
}

/// Largest distance of a place on one path from the other path.
double apart(const std::vector<Edge>& from, const std::vector<Edge>& to) {
  double most = 0;
  for (const Edge& edge : from)
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0})
      most = std::max(most, distance_to_all(to, point_at(edge, part)));
  return most;
}

void expect_same_path(const std::vector<Contour>& contours, double kerf_mm, const char* post) {
  const Operation by_host = operation(kerf_mm, Compensation::automatic);
  const Operation by_controller = operation(kerf_mm, Compensation::controller);
  std::vector<Edge> wanted;
  for (const PlannedCut& cut : plan_of(contours, by_host).cuts)
    for (const CutMove& move : cut.strokes[0]) wanted.push_back(move.edge);
  const CutPlan plan = plan_of(contours, by_controller);
  const ProgramFrame frame{"", std::vector<std::string>(contours.size(), "cut"), 1000};
  const std::string text = cut_program(plan, {by_controller}, post_of(post), frame);
  EXPECT_NE(text.find("2.1 D"), std::string::npos) << "parts are cut counter-clockwise";
  const std::vector<Edge> path = traced(text);
  double length = 0, wanted_length = 0;
  for (const Edge& edge : path) length += length_of(edge);
  for (const Edge& edge : wanted) wanted_length += length_of(edge);
  EXPECT_NEAR(length, wanted_length, tolerance_mm * static_cast<double>(wanted.size())) << text;
  EXPECT_LT(apart(path, wanted), tolerance_mm) << text;
  EXPECT_LT(apart(wanted, path), tolerance_mm) << text;
}

TEST(controller_compensation, contours_of_the_document) {
  const Contour rounded = rounded_rectangle({5, 5}, 60, 20, 3);
  const Contour ell = polygon({{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}});
  for (const char* post : {"grbl", "cut"}) {
    expect_same_path({rounded}, 0.5, post);
    expect_same_path({ell}, 0.5, post);
    expect_same_path({rounded, circle({20, 15}, 4)}, 0.5, post);
  }
}

/// Polygons of lines and arcs without narrow places, with a round hole.
TEST(controller_compensation, random_parts) {
  Random random(5);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * random.uniform();
  };
  for (int i = scaled(100, 20); i > 0; --i) {
    Contour part;
    part.closed = true;
    std::vector<Vec> corners;
    const int sides = 5 + static_cast<int>(between(0, 8));
    for (int k = 0; k < sides; ++k) {
      const double angle = (k + between(0, 0.4)) * 2 * std::numbers::pi / sides;
      corners.push_back(Vec{40, 40} + Vec{std::cos(angle), std::sin(angle)} * between(12, 20));
    }
    for (std::size_t k = 0; k < corners.size(); ++k)
      part.edges.push_back(bulged(corners[k], corners[(k + 1) % corners.size()],
                                  k % 3 == 0 ? between(-0.2, 0.2) : 0));
    expect_same_path({part, circle({40, 40}, 4)}, between(0.05, 0.6), "grbl");
    if (::testing::Test::HasFailure()) return;
  }
}

/// Sides of a drawing that are nearly straight, down to a deviation of a nanometre.
TEST(controller_compensation, sides_that_are_nearly_straight) {
  Random random(6);
  for (int i = scaled(60, 15); i > 0; --i) {
    const int count = 3 + static_cast<int>(random.next() % 5);
    const auto corner = [&](int k) {
      const double turn = 2 * std::numbers::pi * (k % count) / count;
      return Vec{40, 40} + Vec{std::cos(turn), std::sin(turn)} * 25;
    };
    model::Curves curves = of_one_layer({});
    for (int k = 0; k < count; ++k) {
      const double bulge = std::pow(10, -1 - 7 * random.uniform());
      const Edge side = bulged(corner(k), corner(k + 1), random.uniform() < 0.5 ? bulge : -bulge);
      curves.paths.push_back(path_of(side));
    }
    const JoinedContours joined = join_contours(curves, {});
    ASSERT_EQ(joined.contours.size(), 1u);
    expect_same_path(joined.contours, 0.05 + 0.3 * random.uniform(), "grbl");
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(controller_compensation, narrow_places_are_refused) {
  const Contour comb =
      polygon({{0, 0}, {20, 0}, {20, 10}, {10.2, 10}, {10.2, 2}, {10, 2}, {10, 10}, {0, 10}});
  EXPECT_THROW(plan_of({comb}, operation(0.5, Compensation::controller)), Error);
}

}  // namespace
}  // namespace lamplock::cutting::controller_compensation_test
