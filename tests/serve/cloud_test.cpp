// Points of a job for pages: an even sample, its bytes, exact points near a line of sight; the
// methods cloud.* over a WebSocket.
#include "host/serve/cloud.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/job/job.hpp"
#include "host/job/job_file.hpp"
#include "host/job/profile.hpp"
#include "host/serve/clouds.hpp"
#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test {
namespace {

using namespace std::chrono_literals;
using geometry::Point;
using testing::HasSubstr;

/// Places on whole steps of the default machine.
geometry::PointCloud random_cloud(std::size_t count) {
  std::mt19937 random(1);
  const auto place = [&] { return static_cast<double>(random() % 8000) / 200 - 20; };
  geometry::PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) cloud.push_back({place(), place(), place()});
  return cloud;
}

struct Shown {
  Point place;
  double order = 0;
};

std::vector<Shown> points_of(const std::string& bytes, const geometry::Bounds& box) {
  const auto number = [&](std::size_t at) {
    return (static_cast<std::uint8_t>(bytes[at]) + 256 * static_cast<std::uint8_t>(bytes[at + 1])) /
           65535.0;
  };
  std::vector<Shown> points;
  for (std::size_t at = 0; at < bytes.size(); at += Cloud::bytes_per_point)
    points.push_back({{std::lerp(box.low.x, box.high.x, number(at)),
                       std::lerp(box.low.y, box.high.y, number(at + 2)),
                       std::lerp(box.low.z, box.high.z, number(at + 4))},
                      number(at + 6)});
  return points;
}

double distance(const Point& a, const Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(CloudOf, a_small_job_has_all_points_with_their_place_in_the_order) {
  const geometry::PointCloud points = random_cloud(3000);
  const Cloud cloud(points);
  const std::vector<Shown> shown = points_of(cloud.part(0), cloud.bounds());
  ASSERT_EQ(shown.size(), points.size());
  std::vector<int> seen(points.size(), 0);
  for (const Shown& each : shown) {
    const auto number = static_cast<std::size_t>(std::lround(each.order * 3000));
    ASSERT_LT(number, points.size());
    ++seen[number];
    EXPECT_LT(distance(each.place, points[number]), 0.001);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 3000);
}

TEST(CloudOf, a_large_job_is_an_even_sample_in_every_part) {
  geometry::PointCloud line;
  for (int i = 0; i < 600'000; ++i) line.push_back({i / 10'000.0, 0, 0});
  const Cloud cloud(line);
  EXPECT_EQ(cloud.shown(), Cloud::max_shown);
  std::size_t sum = 0;
  for (std::size_t from = 0; from < cloud.shown(); from += Cloud::max_part) {
    const std::vector<Shown> part = points_of(cloud.part(from), cloud.bounds());
    sum += part.size();
    std::vector<int> tenths(10, 0);
    for (const Shown& each : part)
      ++tenths[static_cast<std::size_t>(std::min(each.order * 10, 9.0))];
    // 6554 expected, with a standard deviation of 77.
    for (const int count : tenths) EXPECT_NEAR(count, 6554, 500);
  }
  EXPECT_EQ(sum, Cloud::max_shown);
  EXPECT_EQ(cloud.part(cloud.shown()), "");
  EXPECT_EQ(cloud.part(cloud.shown() + 7), "");
}

TEST(CloudOf, no_points_is_empty) {
  const Cloud cloud({});
  EXPECT_EQ(cloud.shown(), 0u);
  EXPECT_EQ(cloud.part(0), "");
  EXPECT_TRUE(cloud.near({{0, 0, 0}, {0, 0, 1}}, 100).empty());
}

/// Distance from a line of sight by the cross product, which the code does not use.
double sight_distance(const Sight& sight, const Point& p) {
  const Point v{p.x - sight.at.x, p.y - sight.at.y, p.z - sight.at.z}, a = sight.along;
  const Point cross{v.y * a.z - v.z * a.y, v.z * a.x - v.x * a.z, v.x * a.y - v.y * a.x};
  return std::hypot(cross.x, cross.y, cross.z) / std::hypot(a.x, a.y, a.z);
}

TEST(CloudOf, near_points_are_those_of_the_definition) {
  const geometry::PointCloud points = random_cloud(4000);
  const Cloud cloud(points);
  std::mt19937 random(2);
  const auto number = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  for (int i = 0; i < 50; ++i) {
    const Sight sight{{10 * number(), 10 * number(), 5 * number()}, {number(), number(), 1.5}};
    const std::vector<NearPoint> found = cloud.near(sight, 2);
    std::size_t wanted = 0;
    for (const Point& point : points) wanted += sight_distance(sight, point) <= 2 ? 1U : 0U;
    EXPECT_EQ(found.size(), std::min(wanted, Cloud::max_near));
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].place, points[found[k].number]);
      EXPECT_NEAR(found[k].distance_mm, sight_distance(sight, found[k].place), 1e-6);
      EXPECT_LE(found[k > 0 ? k - 1 : 0].distance_mm, found[k].distance_mm);
    }
  }
}

TEST(CloudsKept, are_the_last_used) {
  Clouds clouds;
  const auto cloud = std::make_shared<const Cloud>(geometry::PointCloud{{1, 2, 3}});
  const std::uint64_t first = clouds.add("first", cloud).number;
  for (std::size_t i = 1; i < Clouds::max_open; ++i) clouds.add(fmt::format("{}", i), cloud);
  EXPECT_EQ(clouds.find(first).file, "first");  // used again: the second one is dropped
  clouds.add("another", cloud);
  EXPECT_NE(clouds.find_file("first"), nullptr);
  EXPECT_EQ(clouds.find_file("1"), nullptr);
  EXPECT_ANY_THROW(clouds.find(first + 1));
}

void write_job(const std::filesystem::path& path, const geometry::PointCloud& points) {
  job::write_job_file(path, job::make_job(points, job::default_profile(), job::JobOptions{}));
}

TEST(CloudMethods, send_the_points_of_a_job_in_binary) {
  RunningServer server;
  const geometry::PointCloud points = random_cloud(500);
  write_job(server.folder() / "a.llj", points);
  RawClient client = server.client("client");
  const Json open = client.call("cloud.open", {{"name", "a.llj"}})["result"];
  EXPECT_EQ(open["points"], 500);
  EXPECT_EQ(open["shown"], 500);
  EXPECT_EQ(open["area"], Json::parse("[[-50.0,-50.0,-50.0],[50.0,50.0,50.0]]"));
  EXPECT_EQ(client.call("cloud.open", {{"name", "a.llj"}})["result"], open);
  const Json sent = client.call("cloud.points", {{"cloud", open["cloud"]}, {"from", 0}});
  EXPECT_EQ(sent["result"]["count"], 500);
  const std::string bytes = client.take_bytes();
  ASSERT_EQ(bytes.size(), 8 + 500 * Cloud::bytes_per_point);
  EXPECT_EQ(static_cast<std::uint8_t>(bytes[0]), open["cloud"].get<int>());
  EXPECT_LT(distance(points_of(bytes.substr(8), geometry::bounds(points)).front().place,
                     points_of(Cloud(points).part(0), geometry::bounds(points)).front().place),
            0.001);
  const Json near = client.call("cloud.near", {{"cloud", open["cloud"]},
                                               {"at", {points[7].x, points[7].y, 40}},
                                               {"along", {0, 0, 1}},
                                               {"mm", 0.01}})["result"];
  ASSERT_FALSE(near.empty());
  EXPECT_EQ(near[0]["number"], 7);
  EXPECT_NEAR(near[0]["place"][2].get<double>(), points[7].z, 1e-9);
  write_job(server.folder() / "a.llj", random_cloud(400));
  EXPECT_EQ(client.call("cloud.open", {{"name", "a.llj"}})["result"]["points"], 400);
}

TEST(CloudMethods, refuse_what_has_no_points) {
  RunningServer server;
  server.add_file("a.ngc", "G1X1F100\n");
  RawClient client = server.client("client");
  const auto error_of = [&](const char* method, const Json& parameters) {
    return client.call(method, parameters).value("/error/message"_json_pointer, std::string());
  };
  EXPECT_THAT(error_of("cloud.open", {{"name", "a.ngc"}}), HasSubstr("is a G-code program"));
  EXPECT_THAT(error_of("cloud.open", {{"name", "../a.llj"}}), HasSubstr("no such file"));
  EXPECT_THAT(error_of("cloud.points", {{"cloud", 9}, {"from", 0}}), HasSubstr("open it again"));
  const Json sight{{"cloud", 9}, {"at", {0, 0, 0}}, {"along", {0, 0, 0}}, {"mm", 1}};
  EXPECT_THAT(error_of("cloud.near", sight), HasSubstr("has no direction"));
}

}  // namespace
}  // namespace lamplock::serve::test
