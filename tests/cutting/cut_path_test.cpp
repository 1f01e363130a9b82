// Leads in the waste, tabs away from corners, overcut, passes: against sampled points.
#include "host/cutting/cut_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/cutting/contour_walk.hpp"
#include "host/cutting/cut_order.hpp"
#include "host/cutting/cut_plan.hpp"
#include "host/error.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::cut_path_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

const Contour square = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}});

Lead line_lead(double length_mm, double angle_deg = 90) {
  return {LeadShape::line, length_mm, 0, angle_deg};
}
Lead arc_lead(double radius_mm, double angle_deg = 90) {
  return {LeadShape::arc, 0, radius_mm, angle_deg};
}

/// The polyline of is_around() is nearer than this to its contour: 0.017 mm for half a circle of 22
/// mm.
constexpr double polyline_mm = 0.02;

/// By the angles under which a fine polyline is seen.
bool is_around(const Contour& contour, const Vec& at) {
  double sum = 0;
  for (const Edge& edge : contour.edges) {
    for (int i = 0; i < 40; ++i) {
      const Vec p = point_at(edge, i / 40.0) - at, q = point_at(edge, (i + 1) / 40.0) - at;
      sum += std::atan2(cross(p, q), dot(p, q));
    }
  }
  return std::abs(sum) > pi;
}

double nearest_edge(const Contour& contour, const Vec& at) {
  double nearest = 1e9;
  for (const Edge& edge : contour.edges) nearest = std::min(nearest, distance_to(edge, at));
  return nearest;
}

void expect_connected(const std::vector<CutMove>& moves) {
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Edge& edge = moves[i].edge;
    if (i + 1 < moves.size()) {
      EXPECT_EQ(edge.to, moves[i + 1].edge.from);
    }
    EXPECT_GT(length_of(edge), 0);
    if (edge.is_line()) continue;
    EXPECT_NEAR(distance(edge.to, edge.centre), radius_of(edge), 1e-8);
    EXPECT_NEAR(distance(arc_from(edge.centre, edge.from, edge.sweep).to, edge.to), 0, 1e-8);
  }
}

double length_of_kind(const std::vector<CutMove>& moves, CutKind kind) {
  double length = 0;
  for (const CutMove& move : moves) length += move.kind == kind ? length_of(move.edge) : 0;
  return length;
}

TEST(cut_path, points_inside_are_those_that_a_contour_runs_around) {
  Random random(71);
  for (int i = 0; i < scaled(20, 8); ++i) {
    const Contour star = random_star(random, {3, -2}, 4, 12, 9);
    for (int k = 0; k < 30; ++k) {
      const Vec at{3 + 26 * (random.uniform() - 0.5), -2 + 26 * (random.uniform() - 0.5)};
      if (nearest_edge(star, at) < polyline_mm) continue;
      EXPECT_EQ(is_inside(star, at), is_around(star, at));
      EXPECT_EQ(is_inside(reversed(star), at), is_around(star, at));
    }
  }
}

TEST(cut_path, leads_of_a_square) {
  const CutSheet sheet({square});
  CutPathOptions options;
  options.lead_in = line_lead(2);
  options.lead_out = arc_lead(1);
  options.overcut_mm = 3;
  // Counter-clockwise, the waste is outside: below the first side.
  const std::vector<CutMove> moves = cut_path(square, options, sheet);
  expect_connected(moves);
  EXPECT_NEAR(distance(moves.front().edge.from, {0, -2}), 0, 1e-12);
  EXPECT_EQ(moves.front().kind, CutKind::lead_in);
  EXPECT_NEAR(length_of_kind(moves, CutKind::cut), 40, 1e-9);
  EXPECT_NEAR(length_of_kind(moves, CutKind::overcut), 3, 1e-9);
  EXPECT_EQ(moves.back().kind, CutKind::lead_out);
  EXPECT_NEAR(distance(moves.back().edge.to, {4, -1}), 0, 1e-9);
  // Without an overcut it leaves in the direction in which the last side arrives.
  options.overcut_mm = 0;
  EXPECT_NEAR(distance(cut_path(square, options, sheet).back().edge.to, {-1, -1}), 0, 1e-9);
  // An arc touches the contour: it arrives in its direction.
  options.lead_in = arc_lead(1);
  const Edge arc = cut_path(square, options, sheet).front().edge;
  EXPECT_NEAR(distance(arc.from, {-1, -1}), 0, 1e-9);
  EXPECT_NEAR(distance(direction_at(arc, 1), {1, 0}), 0, 1e-9);
  // A line at 30 degrees to the contour.
  options.lead_in = line_lead(2, 30);
  EXPECT_NEAR(distance(cut_path(square, options, sheet).front().edge.from, {-std::sqrt(3.0), -1}),
              0, 1e-9);
  // The waste inside: the corner is concave there, so the lead begins in the middle of a side.
  options.waste = WasteSide::left;
  options.lead_in = line_lead(2);
  options.overcut_mm = 0;
  const Contour from_middle = as_cut(square, {0, false, 0, 0.5});
  EXPECT_NEAR(distance(cut_path(from_middle, options, sheet).front().edge.from, {5, 2}), 0, 1e-9);
}

TEST(cut_path, leads_are_in_the_waste_or_refused) {
  Random random(72);
  int fitting = 0, refused = 0;
  for (int i = 0; i < scaled(200, 40); ++i) {
    // A part with two holes, cut clockwise, and a neighbour.
    std::vector<Contour> sheet{random_star(random, {0, 0}, 14, 22, 12),
                               reversed(random_star(random, {5, 0}, 2, 4.5, 7)),
                               reversed(circle({-6, 0}, 1 + 3 * random.uniform())),
                               random_star(random, {44, 0}, 14, 20, 10)};
    const std::size_t number = random.next() % sheet.size();
    if (!contour_faults(sheet).empty()) continue;
    CutStep step;
    step.edge = random.next() % sheet[number].edges.size();
    step.part = i % 3 == 0 ? 0 : random.uniform();
    const Contour contour = sheet[number] = as_cut(sheet[number], step);
    const bool is_hole = number == 1 || number == 2;
    const double size = 0.2 + 5 * random.uniform();
    LeadOptions options;
    options.shape = i % 2 == 0 ? line_lead(size, 20 + 140 * random.uniform())
                               : arc_lead(size, 30 + 200 * random.uniform());
    options.clearance_mm = 0.3 * random.uniform();
    const double along = length_of(contour) * random.uniform();
    const bool is_in = random.uniform() < 0.5;
    std::vector<Edge> lead;
    try {
      lead = is_in ? lead_in(contour, options, CutSheet(sheet))
                   : lead_out(contour, along, options, CutSheet(sheet));
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("does not fit"), std::string::npos);
      ++refused;
      continue;
    }
    ++fitting;
    ASSERT_EQ(lead.size(), 1u);
    const ContourPoint out = point_along(contour, along);
    const Vec touch =
        is_in ? contour.edges.front().from : point_at(contour.edges[out.edge], out.part);
    const Vec end = is_in ? lead[0].from : lead[0].to;
    EXPECT_EQ(is_in ? lead[0].to : lead[0].from, touch);
    for (int k = 0; k < 15; ++k) {
      const Vec at = point_at(lead[0], k / 15.0);
      if (nearest_edge(contour, at) > polyline_mm) {
        ASSERT_EQ(is_around(contour, at), is_hole) << "in the part " << i;
      }
      for (std::size_t j = 0; j < sheet.size(); ++j) {
        if (j == number || (number == 1 && j == 0) || (number == 2 && j == 0)) continue;
        if (nearest_edge(sheet[j], at) > polyline_mm) {
          ASSERT_FALSE(is_around(sheet[j], at)) << "in another part " << i;
        }
      }
    }
    for (const Contour& other : sheet)
      ASSERT_GE(nearest_edge(other, end), options.clearance_mm * (1 - 1e-9));
  }
  EXPECT_GT(fitting, refused / 4);
  EXPECT_GT(refused, fitting / 20);
}

TEST(cut_path, leads_that_do_not_fit_and_wrong_ones) {
  const Contour hole = reversed(circle({5, 5}, 2));
  const CutSheet sheet({square, hole});
  EXPECT_NO_THROW(lead_in(hole, {line_lead(1.9)}, sheet));
  EXPECT_THROW(lead_in(hole, {line_lead(4)}, sheet), Error) << "ends on the other side";
  EXPECT_THROW(lead_in(hole, {line_lead(5)}, sheet), Error) << "through the hole";
  EXPECT_NO_THROW(lead_in(hole, {arc_lead(1, 180)}, sheet));
  EXPECT_THROW(lead_in(hole, {arc_lead(2.5)}, sheet), Error) << "turns less than the hole";
  EXPECT_NO_THROW(lead_in(hole, {line_lead(3.9)}, sheet));
  EXPECT_THROW(lead_in(hole, {line_lead(3.9), WasteSide::right, 0.2}, sheet), Error);
  EXPECT_THROW(lead_in(hole, {line_lead(0)}, sheet), Error);
  EXPECT_THROW(lead_in(hole, {line_lead(1, 180)}, sheet), Error);
  EXPECT_THROW(lead_in(hole, {arc_lead(1, 280)}, sheet), Error);
  EXPECT_TRUE(lead_in(hole, {Lead{}}, sheet).empty());
  const Contour slit{{{{0, 0}, {5, 0}, {}, 0}}, false};
  EXPECT_THROW(lead_in(slit, {line_lead(1)}, CutSheet({slit})), Error);
  // Another contour in the way, even if it is only touched.
  const Contour frame = polygon({{-1, -1}, {11, -1}, {11, 11}, {-1, 11}});
  EXPECT_THROW(lead_in(square, {line_lead(1)}, CutSheet({square, frame})), Error);
  EXPECT_NO_THROW(lead_in(square, {line_lead(0.9)}, CutSheet({square, frame})));
}

TEST(cut_path, tabs_are_even_and_away_from_corners) {
  Random random(73);
  int fitting = 0, refused = 0;
  for (int i = 0; i < scaled(300, 40); ++i) {
    const Contour contour = i % 3 == 0   ? rounded_rectangle({0, 0}, 30, 20, 4)
                            : i % 3 == 1 ? random_star(random, {0, 0}, 12, 16, 8)
                                         : circle({0, 0}, 2 + 8 * random.uniform());
    const double length = length_of(contour);
    TabOptions options;
    options.count = 1 + static_cast<int>(random.next() % 5);
    options.width_mm = 0.2 + 2 * random.uniform();
    options.corner_distance_mm = random.uniform();
    options.kerf_mm = i % 4 == 0 ? 0 : 0.8 * random.uniform();
    options.power = 0.2;
    const double skipped = i % 2 == 0 ? 0 : 2 * random.uniform();
    std::vector<Tab> tabs;
    try {
      tabs = tabs_of(contour, options, skipped);
    } catch (const Error&) {
      ++refused;
      continue;
    }
    ++fitting;
    ASSERT_EQ(tabs.size(), static_cast<std::size_t>(options.count));
    double along = 0, last = -1e9;
    std::vector<double> corners{0, length};
    for (std::size_t k = 0; k + 1 < contour.edges.size(); ++k) {
      along += length_of(contour.edges[k]);
      const double turn =
          dot(direction_at(contour.edges[k], 1), direction_at(contour.edges[k + 1], 0));
      if (turn < std::cos(min_corner_deg * pi / 180)) corners.push_back(along);
    }
    for (const Tab& tab : tabs) {
      EXPECT_NEAR(tab.end_mm - tab.begin_mm, options.width_mm + options.kerf_mm, 1e-9);
      EXPECT_GE(tab.begin_mm - last, options.width_mm + options.kerf_mm - 1e-6);
      EXPECT_GE(tab.begin_mm, skipped + options.corner_distance_mm - 1e-6);
      for (const double corner : corners)
        EXPECT_TRUE(tab.begin_mm >= corner + options.corner_distance_mm - 1e-6 ||
                    tab.end_mm <= corner - options.corner_distance_mm + 1e-6);
      last = tab.end_mm;
    }
    EXPECT_GE(length - tabs.back().end_mm + tabs.front().begin_mm,
              options.width_mm + options.kerf_mm - 1e-6);
    // Without corners, all at their even places.
    if (i % 3 == 0 && skipped == 0 && options.count == 1) {
      EXPECT_NEAR(tabs[0].begin_mm + tabs[0].end_mm, length, 1e-6);
    }
  }
  EXPECT_GT(fitting, 4 * refused);
}

/// The largest number of tabs that fit, by trying all places on a grid from left to right.
int max_count(const Contour& contour, const TabOptions& options) {
  double along = 0;
  std::vector<double> corners{0};
  for (const Edge& edge : contour.edges) corners.push_back(along += length_of(edge));
  int count = 0;
  const double step = 0.001, away = options.corner_distance_mm, half = options.width_mm / 2;
  for (double begin = std::max(away, half); begin < along; begin += step) {
    const double end = begin + options.width_mm;
    if (end > along - std::max(away, half)) break;
    if (std::any_of(corners.begin(), corners.end(),
                    [&](double corner) { return begin < corner + away && end > corner - away; }))
      continue;
    ++count;
    begin += 2 * options.width_mm - step;
  }
  return count;
}

TEST(cut_path, as_many_tabs_as_fit) {
  Random random(74);
  for (int i = 0; i < scaled(30, 6); ++i) {
    const double a = 3 + 10 * random.uniform(), b = 3 + 10 * random.uniform();
    const Contour triangle = polygon({{0, 0}, {a, 0}, {0.3 * a, b}});
    TabOptions options;
    options.width_mm = 0.5 + random.uniform();
    options.corner_distance_mm = 0.4 * random.uniform();
    options.count = max_count(triangle, options);
    if (options.count > 0) {
      EXPECT_EQ(tabs_of(triangle, options).size(), static_cast<std::size_t>(options.count));
    }
    // The grid finds one less at most.
    options.count += 2;
    EXPECT_THROW(tabs_of(triangle, options), Error);
  }
  TabOptions wrong{1, 11, 0, 0};
  EXPECT_THROW(tabs_of(square, wrong), Error) << "longer than the side";
  wrong = {1, 1, 1.5, 0};
  EXPECT_THROW(tabs_of(square, wrong), Error);
  wrong = {-1, 1, 0.5, 0};
  EXPECT_THROW(tabs_of(square, wrong), Error);
  wrong = {1, 1, 0.5, -1};
  EXPECT_THROW(tabs_of(square, wrong), Error);
  wrong = {1, 1, 0.5, 0, -1};
  EXPECT_THROW(tabs_of(square, wrong), Error);
  wrong = {1, 6, 0.5, 0, 4.5};
  EXPECT_THROW(tabs_of(square, wrong), Error) << "longer than the side with the kerf";
}

/// The beam is a disc: what it leaves between the two ends of the cut is as wide as the tab.
TEST(cut_path, the_beam_leaves_the_width_of_the_tab) {
  for (const double kerf_mm : {0.0, 0.2, 0.6, 3.175}) {
    Operation one;
    one.kerf_mm = kerf_mm;
    one.tabs = {2, 0.5, 0, 1};
    const CutPlan plan =
        plan_cuts({{polygon({{0, 0}, {30, 0}, {30, 20}, {0, 20}}), {}, 0}}, {one}, {0, 0});
    const Stroke& stroke = plan.cuts.at(0).strokes.at(0);
    int tabs = 0;
    for (const CutMove& tab : stroke) {
      if (tab.kind != CutKind::tab) continue;
      ++tabs;
      const Vec way = tab.edge.to - tab.edge.from;
      int left = 0;
      constexpr int samples = 10'000;
      for (int i = 0; i < samples; ++i) {
        const Vec at = tab.edge.from + way * ((i + 0.5) / samples);
        left += std::none_of(stroke.begin(), stroke.end(), [&](const CutMove& move) {
          return move.power > 0 && distance_to(move.edge, at) <= kerf_mm / 2;
        });
      }
      EXPECT_NEAR(norm(way) * left / samples, 0.5, 2e-3) << kerf_mm;
    }
    EXPECT_EQ(tabs, 2);
  }
}

TEST(cut_path, the_cut_is_the_contour_with_tabs_and_overcut) {
  Random random(75);
  for (int i = 0; i < scaled(100, 15); ++i) {
    const Contour star = as_cut(random_star(random, {0, 0}, 12, 16, 8),
                                {0, false, random.next() % 8, random.uniform()});
    CutPathOptions options;
    options.tabs = {static_cast<int>(random.next() % 4), 0.3, 0.25, 0.1};
    options.overcut_mm = 4 * random.uniform();
    const std::vector<CutMove> moves = cut_path(star, options, CutSheet({star}));
    expect_connected(moves);
    const double tabs = 0.3 * options.tabs.count;
    EXPECT_NEAR(length_of_kind(moves, CutKind::tab), tabs, 1e-6);
    EXPECT_NEAR(length_of_kind(moves, CutKind::cut), length_of(star) - tabs, 1e-6);
    EXPECT_NEAR(length_of_kind(moves, CutKind::overcut), options.overcut_mm, 1e-6);
    EXPECT_EQ(moves.front().edge.from, star.edges.front().from);
    double along = 0;
    for (const CutMove& move : moves) {
      EXPECT_EQ(move.power, move.kind == CutKind::tab ? 0.25 : 1);
      const ContourPoint at = point_along(star, along + length_of(move.edge) / 2);
      EXPECT_NEAR(distance(point_at(move.edge, 0.5), point_at(star.edges[at.edge], at.part)), 0,
                  1e-6);
      along += length_of(move.edge);
    }
    options.overcut_mm = 1.01 * length_of(star);
    EXPECT_THROW(cut_path(star, options, CutSheet({star})), Error);
  }
  // An open contour is cut once, without overcut.
  const Contour slit{{{{0, 0}, {5, 0}, {}, 0}}, false};
  CutPathOptions options;
  options.overcut_mm = 2;
  EXPECT_EQ(cut_path(slit, options, CutSheet({slit})).size(), 1u);
}

TEST(cut_path, the_laser_is_dark_at_both_ends_where_it_is_on_late_and_off_early) {
  Random random(76);
  for (int i = 0; i < scaled(100, 15); ++i) {
    const Contour star = as_cut(random_star(random, {0, 0}, 12, 16, 8),
                                {0, false, random.next() % 8, random.uniform()});
    CutPathOptions options;
    options.tabs = {static_cast<int>(random.next() % 4), 0.3, 0.25, 0.1};
    options.overcut_mm = 2 * random.uniform();
    const std::vector<CutMove> lit = cut_path(star, options, CutSheet({star}));
    const double length = length_of(star) + options.overcut_mm;
    options.dark_begin_mm = i % 3 == 0 ? 0 : length / 2 * random.uniform();
    options.dark_end_mm = i % 4 == 0 ? 0 : length / 2 * random.uniform();
    const std::vector<CutMove> moves = cut_path(star, options, CutSheet({star}));
    expect_connected(moves);
    // The same path, with the power of the lit one or none.
    double along = 0;
    std::size_t before = 0;
    double before_end = length_of(lit[0].edge);
    for (const CutMove& move : moves) {
      const double middle = along + length_of(move.edge) / 2;
      while (before_end < middle) before_end += length_of(lit[++before].edge);
      const bool is_dark = middle < options.dark_begin_mm || middle > length - options.dark_end_mm;
      EXPECT_EQ(move.power, is_dark ? 0 : lit[before].power) << middle;
      EXPECT_EQ(move.kind, lit[before].kind);
      const double part = 1 - (before_end - middle) / length_of(lit[before].edge);
      EXPECT_NEAR(distance(point_at(move.edge, 0.5), point_at(lit[before].edge, part)), 0, 1e-6);
      along += length_of(move.edge);
    }
    EXPECT_NEAR(along, length, 1e-6);
    options.dark_begin_mm = length - options.dark_end_mm;
    EXPECT_THROW(cut_path(star, options, CutSheet({star})), Error);
  }
}

TEST(cut_path, passes_of_tools_and_of_the_focus) {
  EXPECT_EQ(tool_passes(3, 1), (std::vector<double>{-1, -2, -3}));
  EXPECT_EQ(tool_passes(2.5, 1), (std::vector<double>{-1, -2, -2.5}));
  EXPECT_EQ(tool_passes(0.5, 1), (std::vector<double>{-0.5}));
  // N. Ausmanas (depth_model.hpp): acrylic of 3 mm is cut 1.6 mm deep at 60 mm/min, in two passes.
  EXPECT_EQ(focus_passes(3, 1.6), (std::vector<double>{0, -1.6}));
  EXPECT_EQ(focus_passes(1.5, 1.6), (std::vector<double>{0}));
  EXPECT_THROW(tool_passes(3, 0), Error);
  EXPECT_THROW(tool_passes(1e9, 1e-3), Error);
  EXPECT_THROW(focus_passes(-1, 1), Error);
}

}  // namespace
}  // namespace lamplock::cutting::cut_path_test
