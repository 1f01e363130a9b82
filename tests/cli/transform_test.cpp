// Places of a small point list after transformations: rotated in the right direction, mirrored
// once, in their order.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/model/read_points.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using geometry::Point;
using geometry::PointCloud;

/// A corner whose three legs have three lengths: no turn of it is a mirror image.
const PointCloud corner{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};

/// The volume of the corner's legs, with its sign: positive while it is right-handed.
double handedness(const PointCloud& c) {
  const auto leg = [&c](std::size_t i) {
    return Point{c[i].x - c[0].x, c[i].y - c[0].y, c[i].z - c[0].z};
  };
  const Point a = leg(1), b = leg(2), d = leg(3);
  return a.x * (b.y * d.z - b.z * d.y) - a.y * (b.x * d.z - b.z * d.x) +
         a.z * (b.x * d.y - b.y * d.x);
}

struct Golden {
  const char* name;
  std::vector<std::string> words;
  PointCloud wanted;
};

class Transforms : public testing::TestWithParam<Golden> {};

TEST_P(Transforms, PutEveryPointWhereTheyShould) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(corner));
  std::vector<std::string> arguments{"points", list, "-o", folder / "o.xyz"};
  for (const std::string& words : GetParam().words)
    arguments.insert(arguments.end(), {"--transform", words});
  const Finished done = run(arguments);
  ASSERT_EQ(done.status, 0) << done.err;
  const PointCloud made = model::read_point_list(folder / "o.xyz");
  const PointCloud& wanted = GetParam().wanted;
  ASSERT_EQ(made.size(), wanted.size());
  for (std::size_t i = 0; i < made.size(); ++i) {
    EXPECT_NEAR(made[i].x, wanted[i].x, 1e-9) << i;
    EXPECT_NEAR(made[i].y, wanted[i].y, 1e-9) << i;
    EXPECT_NEAR(made[i].z, wanted[i].z, 1e-9) << i;
  }
  std::size_t mirrors = 0;
  for (const std::string& words : GetParam().words)
    mirrors += words.starts_with("mirror") ? 1u : 0u;
  EXPECT_EQ(handedness(made) < 0, mirrors % 2 == 1);
}

// Worked out by hand: right-handed axes, turns counterclockwise seen from the tip of the axis,
// around the middle of the work space, which is the origin of the default machine.
INSTANTIATE_TEST_SUITE_P(
    golden, Transforms,
    testing::Values(
        Golden{"rotate_z", {"rotate z 90"}, {{0, 0, 0}, {0, 1, 0}, {-2, 0, 0}, {0, 0, 3}}},
        Golden{"rotate_x", {"rotate x 90"}, {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}, {0, -3, 0}}},
        Golden{"rotate_y", {"rotate y 90"}, {{0, 0, 0}, {0, 0, -1}, {0, 2, 0}, {3, 0, 0}}},
        Golden{"rotate_back", {"rotate z -90"}, {{0, 0, 0}, {0, -1, 0}, {2, 0, 0}, {0, 0, 3}}},
        Golden{"rotate_diagonal",  // x to y, y to z, z to x
               {"rotate 1 1 1 120"},
               {{0, 0, 0}, {0, 1, 0}, {0, 0, 2}, {3, 0, 0}}},
        Golden{"mirror_x", {"mirror x"}, {{0, 0, 0}, {-1, 0, 0}, {0, 2, 0}, {0, 0, 3}}},
        Golden{"mirror_y", {"mirror y"}, {{0, 0, 0}, {1, 0, 0}, {0, -2, 0}, {0, 0, 3}}},
        Golden{"mirror_z", {"mirror z"}, {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, -3}}},
        Golden{"mirror_then_rotate",
               {"mirror x", "rotate z 90"},
               {{0, 0, 0}, {0, -1, 0}, {-2, 0, 0}, {0, 0, 3}}},
        Golden{"rotate_then_mirror",
               {"rotate z 90", "mirror x"},
               {{0, 0, 0}, {0, 1, 0}, {2, 0, 0}, {0, 0, 3}}},
        Golden{"mirror_twice",
               {"mirror x", "mirror y"},
               {{0, 0, 0}, {-1, 0, 0}, {0, -2, 0}, {0, 0, 3}}},
        Golden{"move_then_rotate",
               {"move 10 0 0", "rotate z 90"},
               {{0, 10, 0}, {0, 11, 0}, {-2, 10, 0}, {0, 10, 3}}},
        Golden{"rotate_then_move",
               {"rotate z 90", "move 10 0 0"},
               {{10, 0, 0}, {10, 1, 0}, {8, 0, 0}, {10, 0, 3}}},
        Golden{"scale", {"scale 2"}, {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {0, 0, 6}}}),
    [](const auto& test) { return test.param.name; });

TEST(Transforms, OfDrawingsKeepTheirSide) {
  // An L of three corners: its long leg points up, its foot to the right.
  const Folder folder;
  const std::string svg = folder.write(
      "l.svg",
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"4mm\" height=\"8mm\" "
      "viewBox=\"0 0 4 8\"><path fill=\"none\" stroke=\"red\" d=\"M0 0 V8 H4\"/></svg>");
  struct Case {
    const char* words;
    std::array<Point, 3> wanted;  ///< top, corner and foot, in the middle of the block
  };
  for (const Case& c : {Case{"move 0 0 0", {{{-2, 4, 0}, {-2, -4, 0}, {2, -4, 0}}}},
                        Case{"rotate z 90", {{{-4, -2, 0}, {4, -2, 0}, {4, 2, 0}}}},
                        Case{"mirror x", {{{2, 4, 0}, {2, -4, 0}, {-2, -4, 0}}}},
                        Case{"mirror y", {{{-2, -4, 0}, {-2, 4, 0}, {2, 4, 0}}}}}) {
    const Finished done =
        run({"points", svg, "--spacing", "0.5", "--transform", c.words, "-o", folder / "o.xyz"});
    ASSERT_EQ(done.status, 0) << done.err;
    const PointCloud made = model::read_point_list(folder / "o.xyz");
    for (const Point& end : c.wanted)
      EXPECT_TRUE(std::any_of(made.begin(), made.end(),
                              [&end](const Point& p) {
                                return std::hypot(p.x - end.x, p.y - end.y, p.z - end.z) < 1e-6;
                              }))
          << c.words << " " << end.x << " " << end.y;
    // The long leg has most of the points.
    const auto on_leg = std::count_if(made.begin(), made.end(), [&c](const Point& p) {
      const Point &a = c.wanted[0], &b = c.wanted[1];
      return std::hypot(p.x - a.x, p.y - a.y) + std::hypot(p.x - b.x, p.y - b.y) < 8 + 1e-6;
    });
    EXPECT_GE(on_leg, 16) << c.words;
  }
}

}  // namespace
}  // namespace lamplock::cli::test
