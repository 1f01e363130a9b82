#include "host/points/blue_noise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>
#include <ctime>
#include <limits>
#include <numbers>

#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using model::Mesh;
using points::blue_noise;
using test::error_of;
using ::testing::HasSubstr;

Mesh some_mesh(std::mt19937_64& random) {
  switch (test::below(random, 4)) {
    case 0:
      return test::sphere(3, 3 + test::below(random, 60), 4 + test::below(random, 60));
    case 1:
      return test::torus(3, 1, 4 + test::below(random, 60), 4 + test::below(random, 30), 0.1);
    case 2:
      return test::box(3, 2, 1);
    default:
      break;
  }
  Mesh mesh;  // triangles that may intersect
  mesh.vertices = test::random_cloud(random, 30, 2);
  for (std::uint32_t i = 0; i < 30; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

Mesh plate(double side, std::uint32_t cells) {
  Mesh mesh;
  test::add_plate(mesh, 0, 0, side, side, cells, cells);
  return mesh;
}

TEST(BlueNoise, NoTwoPointsAreCloserThanTheDistance) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(40); ++i) {
    const Mesh mesh = some_mesh(random);
    const double distance = 0.15 + static_cast<double>(test::below(random, 100)) / 100;
    const PointCloud cloud = blue_noise(mesh, {.distance_mm = distance, .seed = random()});
    EXPECT_GE(test::min_square(cloud), distance * distance);
    EXPECT_GT(cloud.size(), 3u);
  }
}

TEST(BlueNoise, EveryPlaceOfTheSurfaceIsNearAPoint) {
  std::mt19937_64 random(2);
  for (int i = 0; i < test::scaled(20); ++i) {
    const Mesh mesh = some_mesh(random);
    const double distance = 0.2 + static_cast<double>(test::below(random, 100)) / 100;
    const PointCloud cloud = blue_noise(mesh, {.distance_mm = distance, .seed = random()});
    for (const auto& place : test::random_places(mesh, 300, random)) {
      ASSERT_LT(test::nearest_distance(place, cloud), 1.04 * distance);
    }
  }
}

TEST(BlueNoise, PointsLieOnTheSurface) {
  for (const auto& point : blue_noise(test::sphere(10, 199, 400), {.distance_mm = 0.7})) {
    EXPECT_NEAR(std::hypot(point.x, point.y, point.z), 10, 0.005);
  }
  for (const auto& p : blue_noise(test::box(2, 3, 4), {.distance_mm = 0.3})) {
    const double off = std::min(
        {std::abs(std::abs(p.x) - 2), std::abs(std::abs(p.y) - 3), std::abs(std::abs(p.z) - 4)});
    EXPECT_LT(off, 1e-12);
  }
}

// Random sequential adsorption ends at 0.547 / (pi / 4) = 0.696 points per square distance; on a
// curved surface at a little more.
TEST(BlueNoise, CountGrowsWithTheInverseSquareOfTheDistance) {
  const Mesh mesh = test::sphere(5, 60, 120);
  for (const double distance : {0.8, 0.4, 0.2}) {
    const auto count = static_cast<double>(blue_noise(mesh, {.distance_mm = distance}).size());
    EXPECT_NEAR(count * distance * distance / test::area(mesh), 0.697, 0.017) << distance;
  }
}

TEST(BlueNoise, TheTrianglesAreNotVisible) {
  // One half consists of two triangles, the other of ten thousand smaller than the distance.
  Mesh mesh;
  test::add_plate(mesh, 0, 0, 20, 40, 1, 1);
  test::add_plate(mesh, 20, 0, 20, 40, 50, 100);
  const double distance = 0.5;
  std::array<double, 2> half{};
  double on_diagonal = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const auto& p : blue_noise(mesh, {.distance_mm = distance, .seed = seed})) {
      ++half[p.x < 20 ? 0 : 1];
      // Within 0.2 of the edge from (0, 0) to (20, 40).
      if (p.x < 20 && std::abs(2 * p.x - p.y) / std::sqrt(5) < 0.2) ++on_diagonal;
      ++all;
    }
  }
  EXPECT_NEAR(half[0] / half[1], 1, 0.015);
  const double strip = 0.4 * std::hypot(20, 40) / 1600;
  EXPECT_NEAR(on_diagonal / all / strip, 1, 0.1);
}

TEST(BlueNoise, TheBlocksAreNotVisible) {
  // Position of the points within a block (16 distances wide).
  const double distance = 0.25, block = 16 * distance;
  std::array<double, 16> in_block{};
  double all = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (const auto& p :
         blue_noise(plate(10 * block, 1), {.distance_mm = distance, .seed = seed})) {
      if (p.x < block || p.x > 9 * block) continue;  // the rim has more points
      ++in_block[static_cast<std::size_t>(std::fmod(p.x, block) / block * 16) % 16];
      ++all;
    }
  }
  for (const double count : in_block) EXPECT_NEAR(count / all * 16, 1, 0.03);
}

// The power of low frequencies: 1 for random points, 0.06 for random sequential adsorption.
TEST(BlueNoise, LowFrequenciesAreMissing) {
  const double side = 30;
  const PointCloud cloud = blue_noise(plate(side, 3), {.distance_mm = 0.4});
  std::mt19937_64 random(3);
  PointCloud white;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto place = test::random_cloud(random, 1, side / 2).front();
    white.push_back({place.x + side / 2, place.y + side / 2, 0});
  }
  const auto power = [&](const PointCloud& points) {
    double sum = 0;
    int count = 0;
    for (int n = -8; n <= 8; ++n) {
      for (int m = 1; m <= 8; ++m) {
        std::complex<double> wave = 0;
        for (const auto& p : points) {
          wave += std::polar(1.0, 2 * std::numbers::pi * (n * p.x + m * p.y) / side);
        }
        sum += std::norm(wave) / static_cast<double>(points.size());
        ++count;
      }
    }
    return sum / count;
  };
  EXPECT_NEAR(power(white), 1, 0.4);
  EXPECT_LT(power(cloud), 0.15);
}

TEST(BlueNoise, NearestNeighboursAreEvenButNotALattice) {
  const double distance = 0.4;
  const PointCloud cloud = blue_noise(plate(16, 3), {.distance_mm = distance});
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    PointCloud others = cloud;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double nearest = test::nearest_distance(cloud[i], others) / distance;
    sum += nearest;
    squares += nearest * nearest;
  }
  const auto count = static_cast<double>(cloud.size());
  const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
  EXPECT_NEAR(mean, 1.06, 0.03);       // random points of this density: 0.6
  EXPECT_NEAR(deviation, 0.06, 0.03);  // random points: 0.31
}

TEST(BlueNoise, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = test::torus(10, 3, 40, 20);
  const PointCloud one = blue_noise(mesh, {.distance_mm = 0.3, .seed = 5, .threads = 1});
  for (const unsigned threads : {0u, 2u, 7u}) {
    EXPECT_EQ(blue_noise(mesh, {.distance_mm = 0.3, .seed = 5, .threads = threads}), one);
  }
  EXPECT_NE(blue_noise(mesh, {.distance_mm = 0.3, .seed = 6, .threads = 1}), one);
}

TEST(BlueNoise, DensityFollowsTheTone) {
  // Four strips of different brightness, gamma 1.
  Mesh mesh = plate(40, 4);
  const std::array<double, 4> lights{1, 0.25, 0.01, 0};
  test::set_brightness(mesh,
                       [&](double x, double) { return lights[static_cast<std::size_t>(x / 10)]; });
  const points::ToneCurve tone{.gamma = 1, .lowest = 0};
  std::array<double, 4> counts{};
  const PointCloud cloud = blue_noise(mesh, {.distance_mm = 0.25, .tone = tone});
  for (const auto& p : cloud) ++counts[static_cast<std::size_t>(p.x / 10)];
  EXPECT_GE(test::min_square(cloud), 0.25 * 0.25);
  const double full = 0.697 * 400 / 0.0625;
  EXPECT_NEAR(counts[0] / full, 1, 0.03);
  EXPECT_NEAR(counts[1] / full, 0.25, 0.015);
  EXPECT_NEAR(counts[2] / full, 0.01, 0.006);
  EXPECT_EQ(counts[3], 0);
  // Without a tone, and without brightness, the whole surface has full density.
  EXPECT_NEAR(static_cast<double>(blue_noise(mesh, {.distance_mm = 0.25}).size()) / full, 4, 0.1);
  mesh.brightness.reset();
  EXPECT_NEAR(
      static_cast<double>(blue_noise(mesh, {.distance_mm = 0.25, .tone = tone}).size()) / full, 4,
      0.1);
}

/// Four sheets with a dark strip between bright ones: round each place of the strip are hundreds of
/// darts, more than the list of a piece can hold.
TEST(BlueNoise, DistancesHoldWhereManyDartsAreNear) {
  const double distance = 0.25, dark_from = 3, dark_to = 4, dark = 0.04;
  Mesh sheets;
  for (int sheet = 0; sheet < 4; ++sheet) {
    const std::size_t first = sheets.vertices.size();
    test::add_plate(sheets, 0, 0, 7, 6, 7, 6);
    for (std::size_t i = first; i < sheets.vertices.size(); ++i) sheets.vertices[i].z = 0.3 * sheet;
  }
  const auto light = [&](double x, double) { return x > dark_from && x < dark_to ? dark : 1; };
  test::set_brightness(sheets, light);
  const auto radius = [&](const geometry::Point& place) {
    return distance / std::sqrt(light(place.x, 0));
  };
  const auto apart = [](const geometry::Point& p, const geometry::Point& q) {
    return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
  };
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(4); ++i) {
    const points::ToneCurve tone{.gamma = 1, .lowest = 0};
    const PointCloud cloud =
        blue_noise(sheets, {.distance_mm = distance, .seed = random(), .tone = tone});
    for (std::size_t p = 0; p < cloud.size(); ++p) {
      for (std::size_t q = 0; q < p; ++q)
        ASSERT_GE(apart(cloud[p], cloud[q]), std::min(radius(cloud[p]), radius(cloud[q])));
    }
    for (const auto& place : test::random_places(sheets, 1000, random)) {
      ASSERT_TRUE(std::any_of(cloud.begin(), cloud.end(),
                              [&](const geometry::Point& point) {
                                return apart(place, point) <
                                       1.04 * std::min(radius(place), radius(point));
                              }))
          << place.x << ' ' << place.y;
    }
  }
}

/// Plates at 0.3 distances, of triangles as large as a piece that is searched at once: such a piece
/// has twice as many darts near it as a list holds. A search that divides what only the others
/// cover takes 200 times as long as for plates far apart.
TEST(BlueNoise, TakesNotLongerWherePlatesAreNear) {
  const double distance = 0.4, side = 2.9 * distance, height = side * std::sqrt(3.0) / 2;
  const std::uint32_t columns = 8, rows = 8;
  const auto stack = [&](int plates, double apart_mm) {
    Mesh mesh;
    for (int plate = 0; plate < plates; ++plate) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (std::uint32_t j = 0; j <= rows; ++j)
        for (std::uint32_t i = 0; i <= columns; ++i)
          mesh.vertices.push_back({(i + 0.5 * (j % 2)) * side, j * height, plate * apart_mm});
      for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
          const std::uint32_t a = first + j * (columns + 1) + i, b = a + columns + 1;
          if (j % 2 == 0) {
            mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b}, {a + 1, b + 1, b}});
          } else {
            mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
          }
        }
    }
    return mesh;
  };
  const auto seconds_of = [&](const Mesh& mesh, PointCloud& cloud) {
    double least = 1e9;
    for (int i = 0; i < 3; ++i) {
      const std::clock_t start = std::clock();
      cloud = blue_noise(mesh, {.distance_mm = distance, .seed = 4, .threads = 1});
      least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return least;
  };
  const Mesh near = stack(30, 0.3 * distance), apart = stack(30, 5 * distance);
  PointCloud cloud, plain;
  const double ratio = seconds_of(near, cloud) / seconds_of(apart, plain);
  EXPECT_LT(ratio, 4);
  EXPECT_GE(test::min_square(cloud), distance * distance);
  std::mt19937_64 random(6);
  for (const auto& place : test::random_places(near, 2000, random)) {
    EXPECT_TRUE(std::any_of(cloud.begin(), cloud.end(), [&](const geometry::Point& p) {
      return std::hypot(p.x - place.x, p.y - place.y, p.z - place.z) < 1.04 * distance;
    }));
  }
}

/// Faces in the plane between two blocks, of sizes at which a quotient is rounded across it.
TEST(BlueNoise, FacesBetweenBlocksAreNotLost) {
  struct Case {
    double half_mm, distance_mm;
  };
  for (const Case& c : {Case{13.6, 0.1}, {15.6, 0.13}, {6.8, 0.05}, {13.6, 0.05}, {27.2, 0.2}}) {
    SCOPED_TRACE(c.half_mm);
    const double thin = 5 * c.distance_mm;
    const model::Mesh mesh = test::box(c.half_mm, thin, thin);
    int low = 0, high = 0;
    for (const auto& p : blue_noise(mesh, {.distance_mm = c.distance_mm})) {
      low += p.x == -c.half_mm ? 1 : 0;
      high += p.x == c.half_mm ? 1 : 0;
    }
    EXPECT_GT(low, 40);
    EXPECT_GT(high, 40);
  }
}

TEST(BlueNoise, ASurfaceSmallerThanTheDistanceGetsOnePoint) {
  Mesh mesh;
  test::add_plate(mesh, 0, 0, 0.1, 0.1, 5, 5);
  EXPECT_EQ(blue_noise(mesh, {.distance_mm = 1}).size(), 1u);
}

TEST(BlueNoise, FlatAndDuplicateTrianglesAreHarmless) {
  EXPECT_TRUE(blue_noise({}, {}).empty());
  Mesh mesh = plate(5, 1);
  mesh.vertices.push_back({2, 2, 0});
  mesh.triangles.push_back({0, 3, 4});               // on the diagonal, without area
  mesh.triangles.push_back(mesh.triangles.front());  // a duplicate
  const PointCloud cloud = blue_noise(mesh, {.distance_mm = 0.5});
  EXPECT_GE(test::min_square(cloud), 0.25);
  const auto expected = static_cast<double>(blue_noise(plate(5, 1), {.distance_mm = 0.5}).size());
  EXPECT_NEAR(static_cast<double>(cloud.size()), expected, 6);
  mesh.triangles = {{0, 3, 4}};
  EXPECT_TRUE(blue_noise(mesh, {.distance_mm = 0.5}).empty());
}

TEST(BlueNoise, WrongInputIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  Mesh mesh = test::box(1, 1, 1);
  for (const double distance : {0.0, -1.0, nan, infinity, 1e-9, 1e-300}) {
    EXPECT_NE(error_of([&] { blue_noise(mesh, {.distance_mm = distance}); }), "");
  }
  EXPECT_THAT(error_of([&] { blue_noise(mesh, {.distance_mm = 1e-4}); }), HasSubstr("points"));
  EXPECT_NE(error_of([&] { blue_noise(mesh, {.tone = points::ToneCurve{.gamma = 0}}); }), "");
  mesh.vertices[3].y = nan;
  EXPECT_THAT(error_of([&] { blue_noise(mesh, {}); }), HasSubstr("vertex 3"));
  mesh = test::box(1e300, 1e300, 1e300);
  EXPECT_NE(error_of([&] { blue_noise(mesh, {}); }), "");
  mesh = test::box(1, 1, 1);
  for (auto& vertex : mesh.vertices) vertex.y -= 1e8;
  EXPECT_THAT(error_of([&] { blue_noise(mesh, {.distance_mm = 0.5}); }),
              HasSubstr("1e+08 mm from the origin is too far away"));
  mesh = test::box(1, 1, 1);
  mesh.triangles.push_back({0, 1, 8});
  EXPECT_THAT(error_of([&] { blue_noise(mesh, {}); }), HasSubstr("vertex 8, but the model has 8"));
  // A needle of ten metres has hardly any area.
  mesh.vertices = {{0, 0, 0}, {1e4, 0, 0}, {1e4, 1e-9, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_NEAR(static_cast<double>(blue_noise(mesh, {.distance_mm = 1}).size()), 7'500, 400);
}

}  // namespace
}  // namespace lamplock
