// Plans of cuts: lengths of the document, sides of the beam, order, and the programs of
// post-processors, read back.
#include "host/cutting/cut_plan.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "host/cutting/plan_picture.hpp"
#include "host/cutting/post_file.hpp"
#include "host/error.hpp"
#include "tests/cutting/plans.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::cut_plan_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using testing::HasSubstr;
using namespace lamplock::test;

double length_with_light(const CutPlan& plan) {
  double length = 0;
  for (const PlannedCut& cut : plan.cuts)
    for (const Stroke& stroke : cut.strokes)
      for (const CutMove& move : stroke) length += move.power > 0 ? length_of(move.edge) : 0;
  return length;
}

const Contour rounded = rounded_rectangle({5, 5}, 60, 20, 3);
const Contour ten = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}});
const Contour ell = polygon({{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}});

/// Printed digits of the document.
constexpr double printed = 0.00005;

// Its two triangles have the same area, one on the left and one on the right.
TEST(cut_plan, a_symmetric_bow_tie_has_an_outside) {
  const Contour bow = polygon({{0, 0}, {10, 10}, {10, 0}, {0, 10}});
  for (const Contour& contour : {bow, reversed(bow)}) {
    for (const Compensation compensation : {Compensation::outside, Compensation::automatic}) {
      const CutPlan plan = plan_of({contour}, operation(1, compensation));
      Box box;
      for (const PlannedCut& cut : plan.cuts)
        for (const Stroke& stroke : cut.strokes)
          for (const CutMove& move : stroke) box.add(box_of(move.edge));
      EXPECT_NEAR(box.low.x, -0.5, 1e-6);
      EXPECT_NEAR(box.high.x, 10.5, 1e-6);
    }
    EXPECT_LT(length_with_light(plan_of({contour}, operation(1, Compensation::inside))), 40);
  }
}

TEST(cut_plan, lengths_of_the_document) {
  const auto length = [](const Contour& contour, double kerf_mm, Compensation compensation) {
    return length_with_light(plan_of({contour}, operation(kerf_mm, compensation)));
  };
  EXPECT_NEAR(length(rounded, 0.5, Compensation::none), 154.8496, printed);
  EXPECT_NEAR(length(rounded, 0.5, Compensation::outside), 156.4204, printed);
  EXPECT_NEAR(length(rounded, 0.5, Compensation::inside), 153.2788, printed);
  EXPECT_NEAR(length(circle({20, 20}, 4), 0.5, Compensation::inside), 23.5619, printed);
  EXPECT_NEAR(length(ten, 0.5, Compensation::right), 41.5708, printed);
  EXPECT_NEAR(length(ten, 0.5, Compensation::left), 38, printed);
  EXPECT_NEAR(length(ell, 0.5, Compensation::outside), 81.4635, printed);
  EXPECT_NEAR(length(ell, 0.5, Compensation::inside), 77.8927, printed);
  EXPECT_NEAR(length(rounded, 0.5, Compensation::automatic), 156.4204, printed) << "a part";
  // Parts grow by the kerf, holes shrink, by the tree alone, however they were drawn.
  for (const bool is_turned : {false, true}) {
    Contour hole = circle({20, 15}, 4);
    if (is_turned) hole = reversed(hole);
    EXPECT_NEAR(length_with_light(plan_of({rounded, hole}, operation(0.5))), 156.4204 + 23.5619,
                2 * printed);
  }
}

/// Sides are those of the direction in which the contour is cut, as G41 and G42.
TEST(cut_plan, direction_decides_left_and_right) {
  for (const Direction direction : {Direction::drawn, Direction::reversed, Direction::clockwise,
                                    Direction::counter_clockwise}) {
    for (const Contour& drawn : {ten, reversed(ten)}) {
      Operation one = operation(0.5, Compensation::left);
      one.direction = direction;
      const CutPlan plan = plan_of({drawn}, one);
      Contour path{{}, true};
      for (const CutMove& move : plan.cuts.at(0).strokes.at(0)) path.edges.push_back(move.edge);
      const bool was_ccw = signed_area(drawn) > 0, is_ccw = signed_area(path) > 0;
      const bool wanted = direction == Direction::drawn      ? was_ccw
                          : direction == Direction::reversed ? !was_ccw
                                                             : direction != Direction::clockwise;
      EXPECT_EQ(is_ccw, wanted);
      EXPECT_NEAR(length_of(path), is_ccw ? 38 : 41.5708, printed);
    }
  }
}

TEST(cut_plan, every_hole_is_cut_before_its_part_and_every_engraving_before_all) {
  Random random(92);
  for (int i = 0; i < scaled(40, 8); ++i) {
    std::vector<Shape> shapes;
    std::vector<Operation> operations{operation(0.2), operation(0.1), operation(0.1)};
    operations[2].kind = OperationKind::engrave;
    operations[2].hatch_mm = 0.5;
    for (int part = 0; part < 3 + i % 5; ++part) {
      const Vec middle{50.0 * part, 60 * random.uniform()};
      shapes.push_back({random_star(random, middle, 16, 22, 9), {}, 0});
      shapes.push_back({circle(middle + Vec{-6, 0}, 1 + 3 * random.uniform()), {}, 1});
      shapes.push_back({circle(middle + Vec{6, 0}, 1 + 3 * random.uniform()), {}, 0});
      shapes.push_back({polygon({middle, middle + Vec{2, 0}, middle + Vec{0, 2}}), {}, 2});
    }
    place_shapes(shapes, operations);
    const CutPlan plan = plan_cuts(shapes, operations, {0, 0});
    std::map<std::size_t, std::size_t> turn;
    for (std::size_t k = 0; k < plan.cuts.size(); ++k) turn[plan.cuts[k].shape] = k;
    ASSERT_EQ(plan.cuts.front().operation, 2u);
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      if (shapes[s].operation == 2u) continue;
      ASSERT_TRUE(turn.contains(s));
      EXPECT_EQ(shapes[s].place.kind == ContourKind::hole, s % 4 != 0);
      if (const auto parent = shapes[s].place.parent) {
        EXPECT_LT(turn[s], turn[*parent]);
      }
    }
  }
}

TEST(cut_plan, the_beam_keeps_half_its_width_from_what_remains) {
  Random random(93);
  for (int i = 0; i < scaled(40, 8); ++i) {
    const Contour part = random_star(random, {0, 0}, 14, 22, 10);
    const Contour hole = circle({2, 1}, 2 + 4 * random.uniform());
    Operation one = operation(0.1 + 0.6 * random.uniform());
    if (i % 2 == 0) one.lead_in = {LeadShape::line, 0.5, 0.5, 90};
    const CutPlan plan = plan_of({part, hole}, one);
    for (const PlannedCut& cut : plan.cuts) {
      for (const CutMove& move : cut.strokes[0]) {
        const Vec at = point_at(move.edge, random.uniform());
        double nearest = 1e9;
        for (const Contour& contour : {part, hole})
          for (const Edge& edge : contour.edges) nearest = std::min(nearest, distance_to(edge, at));
        EXPECT_GE(nearest, one.kerf_mm / 2 - 1e-6);
        EXPECT_TRUE(!is_inside(part, at) || is_inside(hole, at));
      }
    }
  }
}

/// A corner of a hole has no room for a lead, the middle of its sides has.
TEST(cut_plan, leads_and_tabs_find_another_start_point) {
  Operation one = operation(0.2);
  one.lead_in = {LeadShape::line, 2, 2, 90};
  one.tabs = {4, 1, 0, 1};
  const Contour hole = polygon({{20, 20}, {30, 20}, {30, 30}, {20, 30}});
  const CutPlan plan = plan_of({polygon({{0, 0}, {50, 0}, {50, 50}, {0, 50}}), hole}, one);
  ASSERT_EQ(plan.cuts.size(), 2u);
  for (const PlannedCut& cut : plan.cuts) {
    const Stroke& stroke = cut.strokes[0];
    EXPECT_EQ(stroke.front().kind, CutKind::lead_in);
    EXPECT_EQ(std::count_if(stroke.begin(), stroke.end(),
                            [](const CutMove& m) { return m.kind == CutKind::tab; }),
              4)
        << "no tab is round a corner";
  }
  EXPECT_TRUE(is_inside(hole, plan.cuts[0].strokes[0].front().edge.from)) << "in the waste";
}

std::string refusal(const std::vector<Contour>& contours, const Operation& one) {
  try {
    plan_of(contours, one);
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    return error.what();
  }
}

/// The lead that the message asks for fits: longer than half the kerf, or shorter than the waste.
TEST(cut_plan, the_remedy_of_a_lead_is_one_that_fits) {
  const Contour frame = polygon({{-40, -40}, {50, -40}, {50, 50}, {-40, 50}});
  int remedies = 0;
  for (const LeadShape shape : {LeadShape::line, LeadShape::arc})
    for (const double angle_deg : {30.0, 90.0, 120.0})
      for (const double size_mm : {0.05, 0.2, 0.4, 70.0})
        for (const bool is_hole : {false, true}) {
          std::vector<Contour> contours{ten};
          if (is_hole) contours = {frame, circle({5, 5}, 6)};
          Operation one = operation(1.2);
          one.lead_in = {shape, size_mm, size_mm, angle_deg};
          const std::string text = refusal(contours, one), begin = "; use a lead of ";
          const std::size_t at = text.find(begin);
          if (at == std::string::npos) continue;
          ++remedies;
          const double other_mm = std::stod(text.substr(at + begin.size()));
          one.lead_in = {shape, other_mm, other_mm, angle_deg};
          EXPECT_EQ(refusal(contours, one), "") << size_mm << " " << angle_deg;
        }
  EXPECT_GT(remedies, 24);
  Operation one = operation(1.2);
  one.lead_in = {LeadShape::line, 0.3, 0.3, 90};
  EXPECT_THAT(refusal({ten}, one), HasSubstr("; use a lead of 0.6 mm, which fits there, or none"));
}

TEST(cut_plan, the_error_of_a_lead_names_which_one) {
  Operation one = operation(0.2);
  one.lead_in = {LeadShape::arc, 0.5, 0.5, 90};
  one.lead_out = {LeadShape::line, 4.5, 4.5, 90};
  const std::vector<Contour> contours{polygon({{-7, -7}, {8, -7}, {8, 8}, {-7, 8}}),
                                      circle({0, 0}, 2)};
  EXPECT_THAT(refusal(contours, one), HasSubstr("lead-out: the lead at"));
  std::swap(one.lead_in, one.lead_out);
  EXPECT_THAT(refusal(contours, one), HasSubstr("lead-in: the lead at"));
}

/// An island falls with its ring, so it is cut before: also where the beams of both cross.
TEST(cut_plan, an_island_is_cut_before_the_hole_around_it_whatever_their_gap) {
  const Contour part = polygon({{0, 0}, {50, 0}, {50, 50}, {0, 50}});
  const Contour hole = polygon({{10, 10}, {40, 10}, {40, 40}, {10, 40}});
  for (const double gap_mm : {0.0, 0.05, 0.1, 0.19, 0.3}) {
    const double low = 10 + gap_mm, high = 40 - gap_mm;
    for (const Contour& island : {polygon({{low, 15}, {20, 15}, {20, 25}, {low, 25}}),
                                  polygon({{low, low}, {high, low}, {high, high}, {low, high}}),
                                  polygon({{20, high}, {25, 30}, {30, high}})}) {
      const CutPlan plan = plan_of({part, hole, island}, operation(0.2));
      ASSERT_EQ(plan.cuts.size(), 3u);
      EXPECT_EQ(plan.cuts[0].shape, 2u) << gap_mm;
      EXPECT_EQ(plan.cuts[1].shape, 1u) << gap_mm;
      EXPECT_EQ(plan.cuts[2].shape, 0u) << gap_mm;
    }
  }
}

/// Of a contour that crosses itself the pieces that are smaller than the beam are left out.
TEST(cut_plan, a_small_lobe_of_a_contour_is_left_out_with_a_warning) {
  const Contour lobed = polygon({{10, 10}, {50.4, 30.4}, {50.4, 29.6}, {10, 50}});
  for (const double kerf_mm : {0.3, 1.0}) {
    const CutPlan plan = plan_of({lobed}, operation(kerf_mm, Compensation::inside));
    EXPECT_EQ(plan.cuts.size(), kerf_mm < 0.5 ? 2u : 1u);
    EXPECT_EQ(count_of(plan.faults, FaultKind::vanished), kerf_mm < 0.5 ? 0u : 1u);
    if (plan.faults.empty()) continue;
    EXPECT_NEAR(plan.faults.back().at.x, 50, 1);
    EXPECT_EQ(plan.faults.back().contour, 0u);
  }
  // As a hole, whose beam is inside. A controller would run around the lobe as well.
  const Contour frame = polygon({{0, 0}, {60, 0}, {60, 60}, {0, 60}});
  EXPECT_EQ(plan_of({frame, lobed}, operation(1)).cuts.size(), 2u);
  EXPECT_THAT(refusal({frame, lobed}, operation(1, Compensation::controller)),
              HasSubstr("does not fit everywhere"));
}

/// The turn of the first cut of a plan: positive counter-clockwise.
double area_of_first(const CutPlan& plan) {
  Contour cut;
  cut.closed = true;
  for (const CutMove& move : plan.cuts.front().strokes.front()) cut.edges.push_back(move.edge);
  return signed_area(cut);
}

TEST(cut_plan, a_symmetric_bow_tie_has_a_direction) {
  const Contour bow = polygon({{0, 0}, {10, 10}, {10, 0}, {0, 10}});
  for (const Contour& tie : {bow, reversed(bow)}) {
    Operation one = operation(0.2, Compensation::outside);
    one.direction = Direction::clockwise;
    EXPECT_LT(area_of_first(plan_of({tie}, one)), -50);
    one.direction = Direction::counter_clockwise;
    EXPECT_GT(area_of_first(plan_of({tie}, one)), 50);
    // The left of one direction is the right of the other.
    one.compensation = Compensation::left;
    one.direction = Direction::drawn;
    const std::size_t drawn = plan_of({tie}, one).cuts.size();
    one.direction = Direction::reversed;
    EXPECT_EQ(drawn + plan_of({tie}, one).cuts.size(), 3u) << "one beam outside, two inside";
  }
  const CutPlan hole =
      plan_of({polygon({{-9, -9}, {19, -9}, {19, 19}, {-9, 19}}), bow}, operation(0.2));
  EXPECT_LT(area_of_first(hole), 0) << "holes are cut clockwise";
}

/// The best start point is a notch where no lead fits; at another point a smaller one does.
TEST(cut_plan, a_lead_that_fits_at_another_point_is_advised) {
  const Contour star = polygon({{0.88, 0},
                                {1.270171, 0.733333},
                                {0.44, 0.762102},
                                {0, 1.466667},
                                {-0.44, 0.762102},
                                {-1.270171, 0.733333},
                                {-0.88, 0},
                                {-1.270171, -0.733333},
                                {-0.44, -0.762102},
                                {0, -1.466667},
                                {0.44, -0.762102},
                                {1.270171, -0.733333}});
  const std::vector<Contour> contours{star, circle({0, 0}, 3.3),
                                      polygon({{-9, -9}, {9, -9}, {9, 9}, {-9, 9}})};
  Operation one = operation(0.2);
  one.lead_out = {LeadShape::arc, 2, 2, 90};
  const std::string text = refusal(contours, one), begin = "; use a lead of ";
  const std::size_t at = text.find(begin);
  ASSERT_NE(at, std::string::npos) << text;
  const double other_mm = std::stod(text.substr(at + begin.size()));
  one.lead_out = {LeadShape::arc, other_mm, other_mm, 90};
  EXPECT_EQ(refusal(contours, one), "") << other_mm;
}

TEST(cut_plan, refuses_what_cannot_be_cut) {
  Contour open = ten;
  open.edges.pop_back();
  open.closed = false;
  EXPECT_THAT(refusal({open}, operation(0.5, Compensation::outside)),
              HasSubstr("the open contour of 30.000 mm at (5.000, 5.000) has no outside"));
  EXPECT_THAT(refusal({circle({3, 4}, 0.2)}, operation(0.5, Compensation::inside)),
              HasSubstr("is smaller than the beam of 0.5 mm"));
  EXPECT_THAT(refusal({circle({3, 4}, 0.2)}, operation(0.5)),
              HasSubstr("is smaller than the beam of 0.5 mm"));
  EXPECT_EQ(refusal({circle({3, 4}, 0.26)}, operation(0.5)), "");
  Operation one = operation(0.5);
  one.lead_in = {LeadShape::line, 20, 20, 90};
  EXPECT_THAT(refusal({ten, circle({5, 5}, 3)}, one), HasSubstr("does not fit"));
  one = operation(0.5);
  one.tabs = {1, 12, 0, 0};
  EXPECT_THAT(refusal({ten}, one), HasSubstr("tabs of 12 mm do not fit"));
  one.kind = OperationKind::engrave;
  one.hatch_mm = 1;
  EXPECT_THAT(refusal({open}, one), HasSubstr("has no area"));
  one.hatch_mm = 25;
  EXPECT_THAT(refusal({ten}, one), HasSubstr("no line of a hatch of 25 mm crosses the contour of"));
  EXPECT_EQ(refusal({open, ten}, operation(0.5)), "");
}

/// Lines are at 1, 3, 5 ... mm: the dot between two of them is a warning.
TEST(cut_plan, names_areas_that_no_line_of_the_hatch_crosses) {
  Operation one = operation(0);
  one.kind = OperationKind::engrave;
  one.hatch_mm = 2;
  const CutPlan plan = plan_of(
      {polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}}), circle({20, 4}, 0.4), circle({30, 3}, 0.4)},
      one);
  ASSERT_EQ(plan.faults.size(), 1u);
  EXPECT_EQ(plan.faults[0].kind, FaultKind::unhatched);
  EXPECT_EQ(plan.faults[0].contour, 1u);
  EXPECT_NEAR(plan.faults[0].at.x, 20, 1e-9);
  EXPECT_NEAR(plan.faults[0].size_mm, 0.8, 1e-9);
}

TEST(cut_plan, open_contours_are_cut_on_their_line) {
  Contour open = ten;
  open.edges.pop_back();
  open.closed = false;
  EXPECT_EQ(refusal({open, ten}, operation(0.5)), "");
}

/// Words of a program, with the modal state that lines leave out.
struct Line {
  std::map<char, double> words;
  std::string text;
};

std::vector<Line> lines_of(const std::string& program) {
  std::vector<Line> lines;
  std::istringstream in(program);
  for (std::string text; std::getline(in, text);) {
    Line line{{}, text};
    std::istringstream words(text.substr(0, text.find('(')));
    for (std::string word; words >> word;) line.words[word[0]] = std::stod(word.substr(1));
    lines.push_back(line);
  }
  return lines;
}

/// Edges with light of a program of `grbl`, and with their S words.
std::vector<std::pair<Edge, double>> lit_edges(const std::string& program) {
  std::vector<std::pair<Edge, double>> edges;
  Vec at;
  double s = 0;
  for (const Line& line : lines_of(program)) {
    const auto word = [&](char c, double otherwise) {
      const auto found = line.words.find(c);
      return found == line.words.end() ? otherwise : found->second;
    };
    s = word('S', s);
    const bool moves = line.words.contains('X') || line.words.contains('Y');
    if (!moves || !line.words.contains('G')) continue;
    const Vec to{word('X', at.x), word('Y', at.y)};
    const double g = word('G', 0);
    Edge edge{at, to, {}, 0};
    if (g >= 2) {
      edge.centre = at + Vec{word('I', 0), word('J', 0)};
      const Vec from = at - edge.centre, end = to - edge.centre;
      double sweep = std::atan2(cross(from, end), dot(from, end));
      if (g == 3 && sweep <= 0) sweep += 2 * pi;
      if (g == 2 && sweep >= 0) sweep -= 2 * pi;
      edge.sweep = sweep;
      EXPECT_NEAR(norm(from), norm(end), 2e-4) << line.text;
    }
    at = to;
    if (g == 0) {
      EXPECT_EQ(s, 0) << line.text;
    } else if (s > 0) {
      edges.emplace_back(edge, s);
    }
  }
  return edges;
}

TEST(cut_plan, the_program_of_grbl_is_the_plan) {
  Random random(94);
  const Post post = post_of("grbl");
  for (int i = 0; i < scaled(40, 8); ++i) {
    Operation one = operation(0.3 * random.uniform());
    one.passes = 1 + i % 3;
    one.tabs = {i % 3, 0.4, i % 2 == 0 ? 0.0 : 0.5, 0};
    one.overcut_mm = i % 4 == 0 ? 0.5 : 0;
    const CutPlan plan = plan_of({random_star(random, {0, 0}, 14, 22, 10), circle({1, 2}, 3),
                                  random_star(random, {60, 0}, 14, 22, 10)},
                                 one);
    const std::string program = cut_program(plan, {one}, post, {"title", {"a", "b", "c"}, 1000});
    std::vector<CutMove> wanted;
    for (const PlannedCut& cut : plan.cuts)
      for (int pass = 0; pass < one.passes; ++pass)
        for (const CutMove& move : cut.strokes[0])
          if (move.power > 0) wanted.push_back(move);
    const auto edges = lit_edges(program);
    double length = 0, wanted_length = 0;
    for (const CutMove& move : wanted) wanted_length += length_of(move.edge);
    for (const auto& [edge, s] : edges) {
      length += length_of(edge);
      // The middle of each edge is on a move of the plan with its power.
      const Vec middle = point_at(edge, 0.5);
      const double power = s / 800;
      EXPECT_TRUE(std::any_of(wanted.begin(), wanted.end(),
                              [&](const CutMove& move) {
                                return std::abs(move.power - power) < 1e-9 &&
                                       distance_to(move.edge, middle) < 2e-4;
                              }))
          << middle.x << " " << middle.y;
    }
    EXPECT_NEAR(length, wanted_length, 2e-4 * static_cast<double>(wanted.size() + 1));
  }
}

TEST(cut_plan, the_table_of_the_document_line_by_line) {
  Operation one = operation(0);
  one.passes = 1;
  const CutPlan plan = plan_of({polygon({{0, 0}, {10, 0}, {10, 5}, {0, 5}})}, one);
  EXPECT_EQ(cut_program(plan, {one}, post_of("cut"), {"part", {"cut outside"}, 1000}),
            "(part)\n"
            "G21 G90 G17\n"
            "G40\n"
            "T1 M6\n"
            "S800\n"
            "F600\n"
            "(1: cut outside)\n"
            "G0 X0 Y0\n"
            "G1 M3 M8\n"
            "G1 X10 Y0\n"
            "G1 X10 Y5\n"
            "G1 X0 Y5\n"
            "G1 X0 Y0\n"
            "M9 M5\n"
            "M2\n");
}

/// A laser that is on from M3 to M5 is dark in the run-up of an engraving, also before it moves.
TEST(cut_plan, run_ups_are_dark_for_a_spindle_too) {
  Operation one = operation(0);
  one.kind = OperationKind::engrave;
  one.hatch_mm = 2;
  one.overscan_mm = 3;
  const Contour area = polygon({{10, 10}, {20, 10}, {20, 16}, {10, 16}});
  const std::string program =
      cut_program(plan_of({area}, one), {one}, post_of("cut"), {"", {""}, 1000});
  Vec at;
  double s = 0;
  bool is_on = false;
  int lit = 0;
  for (const Line& line : lines_of(program)) {
    if (line.words.contains('S')) s = line.words.at('S');
    if (line.text == "M9 M5") is_on = false;
    if (line.text == "G1 M3 M8") {
      is_on = true;
      EXPECT_EQ(s, 0) << "light at rest";
    }
    if (!line.words.contains('X')) continue;
    const Vec to{line.words.at('X'), line.words.at('Y')};
    if (is_on && s > 0) {
      EXPECT_TRUE(is_inside(area, (at + to) * 0.5)) << line.text;
      ++lit;
    }
    at = to;
  }
  EXPECT_EQ(lit, 3);
}

/// Arcs whose ends are one place after rounding never become full circles.
TEST(cut_plan, small_arcs_and_circles_keep_their_turn) {
  const Post post = post_of("grbl");
  const Operation one = operation(0);
  for (const double radius : {1e-5, 4e-5, 1e-4, 1e-3, 0.1, 100.0}) {
    const CutPlan plan = plan_of({circle({1, 1}, radius)}, one);
    double length = 0;
    for (const auto& [edge, s] : lit_edges(cut_program(plan, {one}, post, {"", {""}, 1000})))
      length += length_of(edge);
    EXPECT_LE(length, 2 * pi * radius + 4e-4);
    if (radius >= 1e-3) {
      EXPECT_NEAR(length, 2 * pi * radius, 4e-4);
    }
  }
  // A short arc of a large radius.
  const Contour short_arc{{arc_from({0, -1000}, {0, 0}, -1e-7)}, false};
  std::vector<Shape> shapes{Shape{short_arc, {}, 0}};
  place_shapes(shapes, {one});
  const CutPlan plan = plan_cuts(shapes, {one}, {5, 5});
  double length = 0;
  for (const auto& [edge, s] : lit_edges(cut_program(plan, {one}, post, {"", {""}, 1000})))
    length += length_of(edge);
  EXPECT_LE(length, 2e-4);
}

TEST(cut_plan, templates_with_faults_are_named) {
  EXPECT_EQ(template_fault("G1[ X{x}][ F{feed}] S{power}"), "");
  EXPECT_THAT(template_fault("G1 X{xx}"), HasSubstr("there is no value 'xx'"));
  for (const char* wrong :
       {"G1 X{x", "G1 X}", "G1 [X{x}", "G1 X{x}]", "G1 [[X{x}]]", "G1 [X]", "G1 {", "a\nb"})
    EXPECT_NE(template_fault(wrong), "") << wrong;
  EXPECT_THAT(post_names(), testing::UnorderedElementsAre("grbl", "cut", "mill", "knife", "lathe"));
  EXPECT_THROW(post_of("gerbil"), Error);
}

TEST(cut_plan, the_picture_has_every_number_and_the_kerf_to_scale) {
  Operation one = operation(1);
  one.lead_in = {LeadShape::line, 2, 2, 90};
  std::vector<Shape> shapes{{polygon({{0, 0}, {100, 0}, {100, 50}, {0, 50}}), {}, 0},
                            {circle({50, 25}, 10), {}, 0}};
  place_shapes(shapes, {one});
  const CutPlan plan = plan_cuts(shapes, {one}, {0, 0});
  const std::string svg = plan_svg(plan, shapes, {one}, "a < b");
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  EXPECT_THAT(svg, HasSubstr(">1</text>"));
  EXPECT_THAT(svg, HasSubstr(">2</text>"));
  // 880 pixels for about 110 mm with margins: 8 pixels for the kerf of 1 mm.
  const std::size_t at = svg.find("stroke-opacity");
  const std::size_t width = svg.rfind("stroke-width=\"", at);
  EXPECT_NEAR(std::stod(svg.substr(width + 14)), 8, 0.5);
}

}  // namespace
}  // namespace lamplock::cutting::cut_plan_test
