// Surface without points is reported with its share, and a finely divided mesh is filled as a
// coarse one.
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test::empty_surface {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A cube from -1 to 1, each side of n x n squares of two triangles, as OBJ.
std::string cube_obj(int n) {
  std::string vertices, faces;
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int first = count + 1;
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j, ++count) {
          const double u = 2.0 * i / n - 1, v = (2.0 * j / n - 1) * side;
          std::array<double, 3> at{};
          at[static_cast<std::size_t>(axis)] = side;
          at[static_cast<std::size_t>((axis + 1) % 3)] = u;
          at[static_cast<std::size_t>((axis + 2) % 3)] = v;
          vertices += fmt::format("v {} {} {}\n", at[0], at[1], at[2]);
        }
      }
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const int a = first + i * (n + 1) + j, b = a + n + 1;
          faces += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, b + 1, a, b + 1, a + 1);
        }
      }
    }
  }
  return vertices + faces;
}

Json points_of(const Folder& folder, const std::string& mesh, const std::string& method) {
  return run_json({"points", mesh, "--method", method, "--size", "4", "--spacing", "0.1", "-o",
                   folder / "o.xyz"});
}

TEST(EmptySurface, IsReportedWithItsShareAndARemedy) {
  const Folder folder;
  const std::string mesh = folder.write("cube.obj", cube_obj(1));
  // The sides but for three spacings at their ends; the caps but for three spacings round them.
  const Json rays = points_of(folder, mesh, "rays");
  EXPECT_NEAR(rays["empty_share"].get<double>(), 4.0 / 6 * 3.4 / 4, 0.03);
  EXPECT_THAT(rays["warnings"].dump(),
              AllOf(HasSubstr("% of the surface has no point within 0.3 mm"), HasSubstr("turn")));
  const Json slices = points_of(folder, mesh, "slice");
  EXPECT_NEAR(slices["empty_share"].get<double>(), 2.0 / 6 * 3.4 * 3.4 / 16, 0.03);
  EXPECT_THAT(slices["warnings"].dump(), HasSubstr("faces along the planes"));
  for (const std::string method : {"blue-noise", "faces", "solid"}) {
    const Json made = points_of(folder, mesh, method);
    EXPECT_EQ(made["empty_share"], 0) << method;
    EXPECT_EQ(made["warnings"].dump().find("surface"), std::string::npos) << method;
  }
}

TEST(EmptySurface, OfAFinelyDividedMeshIsNone) {
  const Folder folder;
  const Json coarse = points_of(folder, folder.write("a.obj", cube_obj(1)), "faces");
  const Json fine = points_of(folder, folder.write("b.obj", cube_obj(60)), "faces");
  EXPECT_EQ(fine["empty_share"], 0);
  EXPECT_EQ(fine["rejected"], 0);
  EXPECT_NEAR(fine["points"].get<double>() / coarse["points"].get<double>(), 1, 0.03);
}

}  // namespace
}  // namespace lamplock::cli::test::empty_surface
