// Layers closer than the spacing: all of them stay, unless a stated minimum distance forbids it.
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "host/model/read_points.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test::layer_distance {
namespace {

using geometry::Point;
using geometry::PointCloud;
using ::testing::AllOf;
using ::testing::HasSubstr;

double smallest_distance(const PointCloud& cloud) {
  double smallest = 1e9;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      smallest = std::min(smallest, std::hypot(cloud[i].x - cloud[j].x, cloud[i].y - cloud[j].y,
                                               cloud[i].z - cloud[j].z));
  return smallest;
}

/// Points of each layer, by height in um.
std::map<int, int> layers(const PointCloud& cloud) {
  std::map<int, int> counts;
  for (const Point& p : cloud) ++counts[static_cast<int>(std::lround(p.z * 1000))];
  return counts;
}

struct Made {
  PointCloud points;
  std::string warnings;
  std::size_t welded = 0;
};

Made made_of(const Folder& folder, const std::string& input, std::vector<std::string> options) {
  std::vector<std::string> arguments{"points", input, "-o", folder / "o.xyz"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Json report = run_json(arguments);
  return {model::read_point_list(folder / "o.xyz"), report["warnings"].dump(), report["welded"]};
}

const std::vector<std::string> slices{"--method", "slice", "--size", "4"};

std::vector<std::string> with(std::vector<std::string> options,
                              const std::vector<std::string>& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

TEST(LayerDistance, AllSlicesStayAndOneWarningGivesBothFigures) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  for (const auto& [layer, count] : {std::pair{"0.05", 80}, {"0.02", 200}, {"0.031", 129}}) {
    const Made made = made_of(folder, mesh, with(slices, {"--spacing", "0.2", "--layer", layer}));
    EXPECT_EQ(layers(made.points).size(), static_cast<std::size_t>(count)) << layer;
    EXPECT_THAT(made.warnings,
                AllOf(HasSubstr(std::string(layer) + " mm apart"), HasSubstr("spacing of 0.2 mm")));
    EXPECT_GE(smallest_distance(made.points), std::stod(layer) * (1 - 1e-6));
  }
  // The same number of points in a layer as if the layers were far apart.
  const Made near = made_of(
      folder, mesh, with(slices, {"--spacing", "0.2", "--layer", "0.05", "--first", "0.1"}));
  const Made far =
      made_of(folder, mesh, with(slices, {"--spacing", "0.2", "--layer", "0.4", "--first", "0.1"}));
  EXPECT_EQ(far.warnings, "[]");
  const auto in_near = layers(near.points);
  for (const auto& [height, count] : layers(far.points)) EXPECT_EQ(in_near.at(height), count);
}

TEST(LayerDistance, AStatedMinimumIsKeptBetweenAllPoints) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  struct Case {
    std::vector<std::string> options;
    double minimum_mm;
    const char* source;
  };
  for (const Case& one :
       {Case{{"--spacing", "0.2", "--layer", "0.05", "--weld", "0.17"}, 0.17, "weld"},
        Case{{"--layer", "0.05", "--lens", "f43"}, 0.09, "lens f43"},
        Case{{"--layer", "0.05", "--lens", "f70", "--spacing", "0.3"}, 0.13, "lens f70"},
        Case{{"--layer", "0.03", "--lens", "f43", "--spacing", "0.07"}, 0.07, "spacing"}}) {
    const Made made = made_of(folder, mesh, with(slices, one.options));
    EXPECT_GE(smallest_distance(made.points), one.minimum_mm * (1 - 1e-6)) << one.source;
    EXPECT_GT(made.welded, 0u);
    EXPECT_THAT(made.warnings,
                AllOf(HasSubstr(one.options[0] == "--layer" ? one.options[1] : one.options[3]),
                      HasSubstr(std::string(one.source) + " requires"),
                      HasSubstr(fmt::format("{:g} mm between points", one.minimum_mm))));
  }
}

TEST(LayerDistance, LayersAtTheMinimumStayWithoutAWarning) {
  const Folder folder;
  const std::string mesh = folder.write("m.stl", octahedron_stl());
  const Made made = made_of(folder, mesh, with(slices, {"--lens", "f43"}));
  EXPECT_EQ(layers(made.points).size(), 44u);  // 4 / 0.09
  EXPECT_EQ(made.warnings.find("apart"), std::string::npos) << made.warnings;
}

TEST(LayerDistance, LayersOfFlatDrawingsAndBitmapsStay) {
  const Folder folder;
  const std::string drawing = folder.write(
      "d.svg",
      "<svg xmlns='http://www.w3.org/2000/svg' width='6mm' height='6mm' viewBox='0 0 6 6'>"
      "<path d='M1 1H5V5H1Z' fill='none' stroke='black'/></svg>");
  const std::string bitmap = folder.write("b.bmp", disc_bmp(20));
  const std::vector<std::string> close{"--layers", "5", "--layer",   "0.05",
                                       "--size",   "4", "--spacing", "0.2"};
  for (const std::string& input : {drawing, bitmap}) {
    const Made made = made_of(folder, input, close);
    const auto counts = layers(made.points);
    ASSERT_EQ(counts.size(), 5u) << input;
    EXPECT_EQ(made.welded, 0u);
    for (const auto& [height, count] : counts) EXPECT_EQ(count, counts.begin()->second);
    const Made lens = made_of(folder, input, with(close, {"--lens", "f70"}));
    EXPECT_GE(smallest_distance(lens.points), 0.13 * (1 - 1e-6));
    EXPECT_THAT(lens.warnings, HasSubstr("lens f70 requires 0.13 mm"));
  }
  // Layers of an upright drawing reach into each other.
  const Made upright = made_of(folder, drawing, with(close, {"--transform", "rotate x 90"}));
  EXPECT_GE(smallest_distance(upright.points), 0.18 * (1 - 1e-6));
}

}  // namespace
}  // namespace lamplock::cli::test::layer_distance
