#include "host/points/spacing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using points::spacing_of;
using test::error_of;
using ::testing::HasSubstr;

TEST(Spacing, AgreesWithComparingAllPairs) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(40); ++i) {
    PointCloud cloud = test::random_cloud(random, 2 + test::below(random, 300), 1);
    if (i % 3 == 0) {  // clusters and straight lines
      for (auto& p : cloud) p = {std::pow(p.x, 5), i % 2 == 0 ? 0 : p.y, 0};
    }
    const auto report = spacing_of(cloud);
    EXPECT_EQ(report.points, cloud.size());
    EXPECT_EQ(report.duplicates, 0u);
    EXPECT_DOUBLE_EQ(report.min_mm, std::sqrt(test::min_square(cloud)));
    EXPECT_LT(report.first, report.second);
    EXPECT_NEAR(test::distance(cloud[report.first], cloud[report.second]), report.min_mm, 1e-15);
    double sum = 0, largest = 0;
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      PointCloud others = cloud;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const double nearest = test::nearest_distance(cloud[k], others);
      sum += nearest;
      largest = std::max(largest, nearest);
    }
    EXPECT_NEAR(report.mean_mm, sum / static_cast<double>(cloud.size()), 1e-12);
    EXPECT_DOUBLE_EQ(report.max_mm, largest);
  }
}

TEST(Spacing, AGridHasOneDistance) {
  PointCloud cloud;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) cloud.push_back({i * 0.5, j * 0.5, 0});
  }
  const auto report = spacing_of(cloud);
  EXPECT_EQ(report.min_mm, 0.5);
  EXPECT_EQ(report.max_mm, 0.5);
  ASSERT_FALSE(report.counts.empty());
  EXPECT_EQ(std::accumulate(report.counts.begin(), report.counts.end(), std::size_t{0}), 400u);
  EXPECT_EQ(std::count(report.counts.begin(), report.counts.end(), 400u), 1);
}

TEST(Spacing, DuplicatesAreCountedAndNamed) {
  PointCloud cloud{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}, {1, 0, 0}};
  auto report = spacing_of(cloud);
  EXPECT_EQ(report.duplicates, 3u);
  EXPECT_EQ(report.min_mm, 0);
  EXPECT_EQ(report.first, 1u);
  EXPECT_EQ(report.second, 3u);
  EXPECT_DOUBLE_EQ(report.mean_mm, 4.0 / 3);  // distances of the three positions: 1, 1, 2
  report = spacing_of(PointCloud(5000, {1, 2, 3}));
  EXPECT_EQ(report.duplicates, 4999u);
  EXPECT_TRUE(report.counts.empty());
}

TEST(Spacing, FewPointsAndWrongOnes) {
  EXPECT_EQ(spacing_of({}).points, 0u);
  EXPECT_EQ(spacing_of(PointCloud{{1, 1, 1}}).min_mm, 0);
  // Different positions whose distance is 0 in doubles.
  EXPECT_EQ(spacing_of(PointCloud{{0, 0, 0}, {1e-200, 0, 0}, {2e-200, 0, 0}}).duplicates, 0u);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] {
                spacing_of(PointCloud{{0, 0, 0}, {0, nan, 0}});
              }),
              HasSubstr("point 1"));
  EXPECT_NE(error_of([&] { spacing_of(PointCloud{{0, 0, 1e300}}); }), "");
}

}  // namespace
}  // namespace lamplock
