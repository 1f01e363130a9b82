// Areas that are far from each other are engraved one after the other, always the nearest next.
#include "host/cutting/engraving.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "host/cutting/contour.hpp"
#include "host/cutting/operation.hpp"
#include "tests/cutting/shapes.hpp"

namespace lamplock::test::engraving_test {
namespace {

using cutting::Contour;
using cutting::Vec;

constexpr double side_mm = 0.5;

Contour square(const Vec& low) {
  return polygon({low, low + Vec{side_mm, 0}, low + Vec{side_mm, side_mm}, low + Vec{0, side_mm}});
}

TEST(Engraving, TheNextAreaIsTheNearest) {
  std::mt19937 random(5);
  const auto moved = [&] { return std::uniform_real_distribution(0.0, 2.0)(random); };
  std::vector<Contour> contours;
  std::vector<Vec> lows;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 15; ++j) lows.push_back({20.0 * i + moved(), 20.0 * j + moved()});
  std::shuffle(lows.begin(), lows.end(), random);
  contours.reserve(lows.size());
  for (const Vec& low : lows) contours.push_back(square(low));
  cutting::Operation operation;
  operation.kind = cutting::OperationKind::engrave;
  operation.hatch_mm = 0.2;
  operation.max_gap_mm = 5;
  const cutting::Engraving engraving = engrave_areas(contours, {}, operation, {0, 0});
  // The square of each stroke, in order.
  std::vector<Vec> visited;
  for (const cutting::Stroke& stroke : engraving.strokes) {
    const Vec at = stroke.front().edge.from;
    const auto own = std::find_if(lows.begin(), lows.end(),
                                  [&](const Vec& low) { return distance(at, low) < 4 * side_mm; });
    ASSERT_NE(own, lows.end());
    if (visited.empty() || visited.back() != *own) visited.push_back(*own);
  }
  ASSERT_EQ(visited.size(), lows.size());
  Vec at{0, 0};
  for (std::size_t i = 0; i < visited.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = i; k < visited.size(); ++k)
      nearest = std::min(nearest, distance(at, visited[k]));
    EXPECT_EQ(distance(at, visited[i]), nearest);
    at = visited[i] + Vec{side_mm, side_mm};
  }
}

}  // namespace
}  // namespace lamplock::test::engraving_test
