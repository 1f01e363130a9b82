// Paths for pages: of programs and rows, thinned where there are too many places; path.open over a
// WebSocket.
#include "host/serve/shown_path.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>

#include "host/job/job_file.hpp"
#include "host/job/profile.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::shown_path_test {
namespace {

using geometry::Point;
using testing::DoubleNear;
using testing::HasSubstr;

struct Shown {
  Point place;
  double share = 0;
  bool is_rapid = false;
};

std::vector<Shown> places_in(const std::string& bytes, const geometry::Bounds& box) {
  const auto number = [&](std::size_t at) {
    return static_cast<unsigned>(static_cast<std::uint8_t>(bytes[at]) |
                                 static_cast<std::uint8_t>(bytes[at + 1]) << 8);
  };
  const auto in_box = [&](std::size_t at, double low, double high) {
    return std::lerp(low, high, number(at) / 65535.0);
  };
  std::vector<Shown> places;
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += ShownPath::bytes_per_place)
    places.push_back({{in_box(at, box.low.x, box.high.x), in_box(at + 2, box.low.y, box.high.y),
                       in_box(at + 4, box.low.z, box.high.z)},
                      (number(at + 6) >> 1) / 32767.0,
                      (number(at + 6) & 1u) != 0});
  return places;
}

TEST(ShownPath, has_each_place_of_a_short_path) {
  const ShownPath path({{{0, 0, 0}}, {{10, 0, 2}, 0.25, true}, {{10, 5, -1}, 1, false}});
  const std::vector<Shown> places = places_in(path.bytes(), path.bounds());
  ASSERT_EQ(places.size(), 3u);
  EXPECT_THAT(places[1].place.x, DoubleNear(10, 1e-3));
  EXPECT_THAT(places[1].place.z, DoubleNear(2, 1e-3));
  EXPECT_THAT(places[1].share, DoubleNear(0.25, 1e-4));
  EXPECT_TRUE(places[1].is_rapid);
  EXPECT_THAT(places[2].place.y, DoubleNear(5, 1e-3));
  EXPECT_EQ(places[2].share, 1);
  EXPECT_FALSE(places[2].is_rapid);
  EXPECT_EQ(ShownPath({}).size(), 0u);
}

/// A spiral of 50 turns, each place close to the next.
std::vector<PathPlace> spiral(std::size_t count) {
  std::vector<PathPlace> places;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    const double angle = 314.159 * share;
    places.push_back({{50 * share * std::cos(angle), 50 * share * std::sin(angle), 0}, share});
  }
  return places;
}

TEST(ShownPath, a_long_one_keeps_its_form_and_ends) {
  const std::vector<PathPlace> all = spiral(400'000);
  const ShownPath path(all);
  EXPECT_LE(path.size(), ShownPath::max_shown);
  EXPECT_GT(path.size(), ShownPath::max_shown / 4);
  const std::vector<Shown> places = places_in(path.bytes(), path.bounds());
  EXPECT_EQ(places.back().share, 1);
  EXPECT_THAT(places.back().place.x, DoubleNear(all.back().place.x, 2e-3));
  // Between two places that are shown the path is as long as the straight line, nearly.
  for (std::size_t i = 1; i < places.size(); ++i)
    ASSERT_LT(std::hypot(places[i].place.x - places[i - 1].place.x,
                         places[i].place.y - places[i - 1].place.y),
              0.5);
}

TEST(ShownPath, places_that_differ_by_nothing_end_too) {
  EXPECT_LE(ShownPath(std::vector<PathPlace>(100'000)).size(), ShownPath::max_shown);
}

TEST(PlacesOf, rows_begin_at_their_first_place_and_have_rapids) {
  job::Job job;
  job.settings = job::default_profile().settings;
  job.header.axes = 2;
  for (const auto& [x, light] : {std::pair{0, false}, {2000, true}, {4000, false}}) {
    job::Line line;
    line.to.steps = {x, 400, 0};
    line.to.light = light;
    job.rows.lines.push_back(line);
  }
  const std::vector<PathPlace> places = places_of(job);
  ASSERT_EQ(places.size(), 3u);
  EXPECT_EQ(places[1].place, (Point{10, 2, 0})) << "200 steps in a millimetre";
  EXPECT_FALSE(places[1].is_rapid);
  EXPECT_TRUE(places[2].is_rapid);
  EXPECT_EQ(places[2].share, 1);
}

TEST(PathOpen, sends_the_path_of_a_program) {
  RunningServer server;
  // Comments and blank lines are not sent and so do not count.
  server.add_file("cut.ngc", "(a)\n(b)\n\nG21G90\nG0X10Y5\nM3S1000\nG1X20F600\nG1Z-1\n");
  RawClient client = server.client("client");
  const Json result = client.call("path.open", {{"name", "cut.ngc"}})["result"];
  EXPECT_EQ(result["places"], 4);
  EXPECT_EQ(result["area"].size(), 2u);
  const std::string bytes = client.take_bytes();
  ASSERT_EQ(bytes.size(), 8 + 4 * ShownPath::bytes_per_place);
  EXPECT_EQ(bytes.substr(0, 8), std::string(8, '\0'));
  const Json &low = result["bounds"][0], &high = result["bounds"][1];
  const std::vector<Shown> places =
      places_in(bytes.substr(8), {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
  EXPECT_TRUE(places[1].is_rapid);
  EXPECT_THAT(places[1].share, DoubleNear(2.0 / 5, 1e-4)) << "G0 is the second of 5 lines";
  EXPECT_FALSE(places[2].is_rapid);
  EXPECT_THAT(places[2].place.x, DoubleNear(20, 2e-3));
  EXPECT_THAT(places[3].place.z, DoubleNear(-1, 2e-3));
}

TEST(PathOpen, of_points_and_missing_files_sends_nothing) {
  RunningServer server;
  job::write_job_file(server.folder() / "a.llj",
                      job::make_job({{0, 0, 0}, {1, 0, 0}}, job::default_profile(), {}));
  RawClient client = server.client("client");
  EXPECT_EQ(client.call("path.open", {{"name", "a.llj"}})["result"]["places"], 0);
  EXPECT_TRUE(client.take_bytes().empty());
  EXPECT_TRUE(client.call("path.open", {{"name", "b.ngc"}}).contains("error"));
}

}  // namespace
}  // namespace lamplock::serve::test::shown_path_test
