#include "host/serve/camera_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

constexpr std::size_t point_count = 4;
constexpr double max_place_mm = 100'000;
/// A triangle of less area, in squares of the size of all points, is a line.
constexpr double min_area = 0.01;

struct Place {
  double x = 0, y = 0;
};
using Places = std::array<Place, point_count>;

/// The two members of all points.
Places places_of(const Json& points, const char* x, const char* y, double low, double high) {
  const auto value = [&](const Json& point, const char* name) {
    const auto found = point.find(name);
    if (found == point.end() || !found->is_number() || !(found->get<double>() >= low) ||
        !(found->get<double>() <= high))
      throw Refusal(Exit::bad_input, "camera-value", {{"name", name}});
    return found->get<double>();
  };
  Places places;
  for (std::size_t i = 0; i < point_count; ++i)
    places[i] = {value(points[i], x), value(points[i], y)};
  return places;
}

/// Twice the area of the triangle without one of the points.
double area_without(const Places& places, std::size_t left_out) {
  const auto at = [&](std::size_t i) { return places[(left_out + i) % point_count]; };
  const Place a = at(1), b = at(2), c = at(3);
  return std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

bool has_three_on_a_line(const Places& places) {
  const auto [low_x, high_x] = std::ranges::minmax(places, {}, &Place::x);
  const auto [low_y, high_y] = std::ranges::minmax(places, {}, &Place::y);
  const double size = std::max(high_x.x - low_x.x, high_y.y - low_y.y);
  for (std::size_t i = 0; i < point_count; ++i)
    if (!(area_without(places, i) > min_area * size * size)) return true;
  return false;
}

void check_points(const Json& points) {
  if (!points.is_array() || points.size() != point_count ||
      !std::ranges::all_of(points, [](const Json& each) { return each.is_object(); }))
    throw Refusal(Exit::bad_input, "camera-count");
  if (has_three_on_a_line(places_of(points, "u", "v", 0, 1)) ||
      has_three_on_a_line(places_of(points, "x", "y", -max_place_mm, max_place_mm)))
    throw Refusal(Exit::bad_input, "camera-points");
}

}  // namespace

Json read_camera_points(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return nullptr;
  try {
    Json points = Json::parse(read_file(file.string()));
    check_points(points);
    return points;
  } catch (const std::exception&) {
    return nullptr;  // the camera is calibrated again
  }
}

void write_camera_points(const std::filesystem::path& file, const Json& points) {
  check_points(points);
  Json kept = Json::array();
  for (const Json& point : points)
    kept.push_back({{"u", point["u"]}, {"v", point["v"]}, {"x", point["x"]}, {"y", point["y"]}});
  write_whole(file.string(),
              [&](const std::filesystem::path& path) { write_file(path, kept.dump(2) + "\n"); });
}

}  // namespace lamplock::serve
