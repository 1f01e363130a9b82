// Order of cutting: holes before their parts, the rapid way against nearest neighbour and all
// orders.
#include "host/cutting/cut_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/error.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::cut_order_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

/// A sheet of parts in rows, each with some holes, some holes with islands, some marks.
std::vector<Contour> random_sheet(Random& random, int rows, int columns) {
  std::vector<Contour> contours;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vec centre =
          Vec{50.0 * column, 50.0 * row} + Vec{8 * random.uniform(), 8 * random.uniform()};
      contours.push_back(random_star(random, centre, 17, 20, 6 + int(random.next() % 20)));
      for (auto hole = random.next() % 6; hole > 0; --hole) {
        const double turn = 2 * pi * double(hole) / 5;
        const Vec at = centre + Vec{std::cos(turn), std::sin(turn)} * 9;
        if (random.uniform() < 0.2) {
          contours.push_back({{{at, at + Vec{3 * random.uniform(), 1}, {}, 0}}, false});
          continue;
        }
        contours.push_back(circle(at, 2 + random.uniform()));
        if (random.uniform() < 0.3) contours.push_back(circle(at, 1));
      }
    }
  }
  for (std::size_t i = contours.size(); i > 1; --i)
    std::swap(contours[i - 1], contours[random.next() % i]);
  return contours;
}

/// Fails unless each contour is cut once, before its parent; returns the rapid way.
double checked_way(const std::vector<Contour>& contours, const std::vector<ContourPlace>& places,
                   const CutOrder& order, Vec at) {
  std::vector<std::size_t> cut_at(contours.size(), contours.size());
  double way = 0;
  for (std::size_t i = 0; i < order.steps.size(); ++i) {
    const CutStep& step = order.steps[i];
    EXPECT_EQ(cut_at[step.contour], contours.size()) << "cut twice";
    cut_at[step.contour] = i;
    const Contour cut = as_cut(contours[step.contour], step);
    way += distance(at, cut.edges.front().from);
    at = cut.edges.back().to;
  }
  EXPECT_EQ(order.steps.size(), contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (places[i].parent) {
      EXPECT_LT(cut_at[i], cut_at[*places[i].parent]) << "the part is free already";
    }
  }
  EXPECT_NEAR(way, order.rapid_mm, 1e-6 * (1 + way));
  return way;
}

TEST(cut_order, holes_before_parts_and_a_short_way_on_random_nestings) {
  Random random(31);
  const int sheets = scaled(500, 20);
  double nearest = 0, improved = 0;
  for (int i = 0; i < sheets; ++i) {
    const std::vector<Contour> contours =
        random_sheet(random, 1 + int(random.next() % 3), 2 + int(random.next() % 3));
    const std::vector<ContourPlace> places = contour_tree(contours);
    const Vec position{-20, -20};
    const CutOrder order = cut_order(contours, places, position);
    const CutOrder near = cut_order(contours, places, position, {OrderSearch::nearest});
    const double way = checked_way(contours, places, order, position);
    const double near_way = checked_way(contours, places, near, position);
    EXPECT_LE(way, near_way * (1 + 1e-12));
    nearest += near_way;
    improved += way;
  }
  EXPECT_LE(improved / nearest, 0.85);
}

TEST(cut_order, a_sheet_of_many_parts) {
  Random random(32);
  const std::vector<Contour> contours = random_sheet(random, 8, 12);
  const std::vector<ContourPlace> places = contour_tree(contours);
  const CutOrder order = cut_order(contours, places, {0, 0});
  const double way = checked_way(contours, places, order, {0, 0});
  EXPECT_LE(way / cut_order(contours, places, {0, 0}, {OrderSearch::nearest}).rapid_mm, 0.85);
}

/// The shortest way over all orders of contours, each with all its start points.
class AllOrders {
 public:
  AllOrders(const std::vector<Contour>& contours, const std::vector<ContourPlace>& places)
      : contours_(contours), places_(places), is_cut_(contours.size(), false) {}

  double shortest(Vec position) {
    best_ = std::numeric_limits<double>::infinity();
    extend({{position, 0.0}}, 0);
    return best_;
  }

 private:
  struct End {
    Vec at;
    double way;
  };

  /// Start and end points of a contour: 16 on the edges of a closed one.
  std::vector<std::pair<Vec, Vec>> ways_through(const Contour& contour) const {
    if (!contour.closed) {
      const Vec from = contour.edges.front().from, to = contour.edges.back().to;
      return {{from, to}, {to, from}};
    }
    std::vector<std::pair<Vec, Vec>> ways;
    const std::size_t count = contour.edges.size();
    for (std::size_t i = 0; count >= 16 && i < 16; ++i) {
      const Vec at = contour.edges[i * count / 16].from;
      ways.emplace_back(at, at);
    }
    const std::size_t parts = (16 + count - 1) / count;
    for (std::size_t i = 0; count < 16 && i < count * parts; ++i) {
      const Vec at = point_at(contour.edges[i / parts], double(i % parts) / double(parts));
      ways.emplace_back(at, at);
    }
    return ways;
  }

  void extend(const std::vector<End>& ends, std::size_t depth) {
    if (depth == contours_.size()) {
      for (const End& end : ends) best_ = std::min(best_, end.way);
      return;
    }
    for (std::size_t i = 0; i < contours_.size(); ++i) {
      if (is_cut_[i] || !may_cut(i)) continue;
      std::vector<End> next;
      for (const auto& [start, end] : ways_through(contours_[i])) {
        double way = std::numeric_limits<double>::infinity();
        for (const End& before : ends) way = std::min(way, before.way + distance(before.at, start));
        if (way < best_) next.push_back({end, way});
      }
      if (next.empty()) continue;
      is_cut_[i] = true;
      extend(next, depth + 1);
      is_cut_[i] = false;
    }
  }

  bool may_cut(std::size_t number) const {
    for (std::size_t i = 0; i < contours_.size(); ++i) {
      if (places_[i].parent == number && !is_cut_[i]) return false;
    }
    return true;
  }

  const std::vector<Contour>& contours_;
  const std::vector<ContourPlace>& places_;
  std::vector<bool> is_cut_;
  double best_ = 0;
};

TEST(cut_order, equals_the_best_of_all_orders_of_few_contours) {
  Random random(33);
  int equal = 0, count = 0;
  for (int i = 0; i < scaled(60, 10); ++i) {
    std::vector<Contour> contours = random_sheet(random, 1, 1 + int(random.next() % 3));
    if (contours.size() > max_exact) contours.resize(max_exact);
    const std::vector<ContourPlace> places = contour_tree(contours);
    const CutOrder order = cut_order(contours, places, {-30, 10});
    const double way = checked_way(contours, places, order, {-30, 10});
    const double best = AllOrders(contours, places).shortest({-30, 10});
    EXPECT_GE(way, best * (1 - 1e-9));
    equal += way <= best * (1 + 1e-9) ? 1 : 0;
    ++count;
  }
  EXPECT_EQ(equal, count);
}

TEST(cut_order, the_genetic_one_is_the_best_of_few_contours_and_never_longer_than_nearest) {
  Random random(36);
  int equal = 0, count = 0;
  double nearest = 0, genetic = 0;
  for (int i = 0; i < scaled(30, 5); ++i) {
    std::vector<Contour> contours = random_sheet(random, 1 + i % 2, 1 + int(random.next() % 3));
    if (i % 2 == 0 && contours.size() > max_exact) contours.resize(max_exact);
    const std::vector<ContourPlace> places = contour_tree(contours);
    const CutOrder order = cut_order(contours, places, {-30, 10}, {OrderSearch::genetic, 40});
    const double way = checked_way(contours, places, order, {-30, 10});
    const double near = cut_order(contours, places, {-30, 10}, {OrderSearch::nearest}).rapid_mm;
    EXPECT_LE(way, near * (1 + 1e-12));
    nearest += near;
    genetic += way;
    if (contours.size() > max_exact) continue;
    ++count;
    equal += way <= cut_order(contours, places, {-30, 10}).rapid_mm * (1 + 1e-9) ? 1 : 0;
  }
  // Start points are the nearest ones during the search: some orders stay a little longer.
  EXPECT_GE(equal, count / 2);
  EXPECT_LE(genetic / nearest, 0.95);
}

TEST(cut_order, a_contour_that_begins_elsewhere_is_the_same) {
  Random random(34);
  for (int i = 0; i < scaled(200, 10); ++i) {
    const Contour star = random_star(random, {3, 4}, 5, 20, 9);
    CutStep step;
    step.edge = random.next() % star.edges.size();
    step.part = i % 2 == 0 ? 0 : random.uniform();
    const Contour cut = as_cut(star, step);
    EXPECT_NEAR(length_of(cut), length_of(star), 1e-9);
    EXPECT_NEAR(signed_area(cut), signed_area(star), 1e-9);
    EXPECT_EQ(cut.edges.front().from, cut.edges.back().to);
    EXPECT_EQ(cut.edges.front().from, point_at(star.edges[step.edge], step.part));
  }
}

TEST(cut_order, open_contours_are_cut_from_the_nearer_end) {
  std::vector<Contour> lines;
  for (int i = 0; i < 30; ++i)
    lines.push_back({{{{0.0, double(i)}, {50.0, double(i)}, {}, 0}}, false});
  const CutOrder order = cut_order(lines, contour_tree(lines), {0, 0});
  EXPECT_NEAR(order.rapid_mm, 29, 1e-9);
  for (std::size_t i = 0; i < order.steps.size(); ++i)
    EXPECT_EQ(order.steps[i].backwards, i % 2 == 1);
}

TEST(cut_order, nothing_and_wrong_trees) {
  EXPECT_TRUE(cut_order({}, {}, {0, 0}).steps.empty());
  const std::vector<Contour> two{circle({0, 0}, 1), circle({5, 0}, 1)};
  EXPECT_THROW(cut_order(two, {}, {0, 0}), Error);
  std::vector<ContourPlace> places(2);
  places[0].parent = 1;
  places[1].parent = 0;
  EXPECT_THROW(cut_order(two, places, {0, 0}), Error);
  places[1].parent = 7;
  EXPECT_THROW(cut_order(two, places, {0, 0}, {OrderSearch::nearest}), Error);
}

}  // namespace
}  // namespace lamplock::cutting::cut_order_test
