// `lamplock cut` engraves what an SVG fills.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test::cut_areas {
namespace {

using nlohmann::json;

class CutAreas : public testing::Test {
 protected:
  /// Area in mm^2 of what is engraved of a page of 100 x 100 mm, by the length of lit lines.
  double engraved(std::string_view content, const std::vector<std::string>& more = {}) const {
    const std::string file = folder_.write(
        "part.svg", fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" "
                                "height=\"100mm\" viewBox=\"0 0 100 100\">{}</svg>",
                                content));
    std::vector<std::string> arguments{"cut",     file,  "--operation", "engrave",
                                       "--hatch", "1",   "--power",     "80",
                                       "--feed",  "600", "--x",         "-40",
                                       "--y",     "-40", "-o",          folder_ / "part.ngc",
                                       "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return json::parse(finished.out, nullptr, false)["cut_mm"].get<double>();
  }

  Folder folder_;
};

constexpr std::string_view star = "M50 10 L73.5 82.4 L12 37.6 L88 37.6 L26.5 82.4 Z";
constexpr std::string_view squares = "M10 10H50V50H10Z M20 20H40V40H20Z";
constexpr std::string_view ring = "M10 10H50V50H10Z M20 20V40H40V20Z";

TEST_F(CutAreas, the_fill_rule_says_what_is_inside) {
  const auto path = [](std::string_view d, std::string_view more) {
    return fmt::format("<path d=\"{}\" {}/>", d, more);
  };
  EXPECT_NEAR(engraved(path(squares, "")), 1600, 0.1) << "nonzero without a rule";
  EXPECT_NEAR(engraved(path(ring, "")), 1200, 0.1) << "the hole runs the other way";
  EXPECT_NEAR(engraved(path(squares, "fill-rule='evenodd'")), 1200, 0.1);
  EXPECT_NEAR(engraved(path(squares, "style='fill-rule:evenodd'")), 1200, 0.1);
  EXPECT_NEAR(engraved("<style>.e{fill-rule:evenodd}</style>" + path(squares, "class='e'")), 1200,
              0.1);
  EXPECT_NEAR(engraved("<g fill-rule='evenodd'>" + path(squares, "") + "</g>"), 1200, 0.1);
  // The centre of the star, which its outline runs around twice.
  const double all = engraved(path(star, "")), tips = engraved(path(star, "fill-rule='evenodd'"));
  EXPECT_NEAR(all, 1795, 20);
  EXPECT_NEAR(all - tips, 557, 20);
}

TEST_F(CutAreas, overlaps_of_areas_are_filled) {
  constexpr std::string_view two =
      "<rect x='60' y='10' width='20' height='20'/><rect x='65' y='15' width='20' height='20'/>";
  EXPECT_NEAR(engraved(two), 575, 0.1);
  EXPECT_NEAR(engraved(fmt::format("<g fill-rule='evenodd'>{}</g>", two)), 575, 0.1);
  EXPECT_NEAR(engraved("<defs><rect id='r' width='20' height='20'/></defs>"
                       "<use href='#r'/><use href='#r' x='10'/>"),
              600, 0.1);
}

constexpr double pi = std::numbers::pi;

TEST_F(CutAreas, later_elements_are_over_those_before) {
  const auto disc = [](double radius, std::string_view fill) {
    return fmt::format("<circle cx='50' cy='50' r='{}' fill='{}'/>", radius, fill);
  };
  EXPECT_NEAR(engraved(disc(30, "black") + disc(20, "white") + disc(10, "black")),
              (900 - 400 + 100) * pi, 10);
  EXPECT_NEAR(engraved(disc(30, "white") + disc(20, "black")), 400 * pi, 10);
  EXPECT_NEAR(engraved(disc(20, "white") + disc(30, "black")), 900 * pi, 10) << "over the white";
  EXPECT_NEAR(engraved("<rect x='10' y='10' width='40' height='40'/>"
                       "<rect x='30' y='30' width='40' height='40' fill='white'/>"),
              1200, 0.1)
      << "white on white is not engraved";
  EXPECT_NEAR(engraved(disc(30, "black") + disc(20, "white"), {"--colour", "black"}), 500 * pi, 10)
      << "white is that of another operation";
  EXPECT_NEAR(engraved("<rect x='5' y='5' width='80' height='80' fill='none' stroke='black'/>" +
                       disc(20, "black")),
              400 * pi, 10)
      << "the frame has no fill";
}

TEST_F(CutAreas, lines_and_white_areas_leave_out_what_is_in_them) {
  constexpr std::string_view square = "<rect x='10' y='10' width='40' height='40'/>";
  EXPECT_NEAR(
      engraved(fmt::format("{}<rect x='20' y='20' width='20' height='20' fill='white'/>", square)),
      1200, 0.1);
  EXPECT_NEAR(engraved("<g fill='none' stroke='black'><rect x='10' y='10' width='40' height='40'/>"
                       "<rect x='20' y='20' width='20' height='20'/></g>"),
              1200, 0.1);
}

}  // namespace
}  // namespace lamplock::cli::test::cut_areas
