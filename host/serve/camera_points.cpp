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
constexpr double max_place_mm = 100'000;  // larger than any travel that a setting permits
/// Three points count as being on one line if twice the area of their triangle is less than this
/// part of the square of the extent of all points.
constexpr double min_area = 0.01;

struct Place {
  double x = 0, y = 0;
};
using Places = std::array<Place, point_count>;

/// Reads two coordinates of each point. Throws Refusal if one is missing or outside of the range.
Places coordinates_of(const Json& points, const char* x, const char* y, double low, double high) {
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

/// Twice the area of the triangle of the three other points: positive if they turn to the left.
double turn_without(const Places& places, std::size_t left_out) {
  const auto at = [&](std::size_t i) { return places[(left_out + i) % point_count]; };
  const Place a = at(1), b = at(2), c = at(3);
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool has_three_on_a_line(const Places& places) {
  const auto [low_x, high_x] = std::ranges::minmax(places, {}, &Place::x);
  const auto [low_y, high_y] = std::ranges::minmax(places, {}, &Place::y);
  const double size = std::max(high_x.x - low_x.x, high_y.y - low_y.y);
  for (std::size_t i = 0; i < point_count; ++i)
    if (!(std::abs(turn_without(places, i)) > min_area * size * size)) return true;
  return false;
}

/// Corners that are seen from one side: a perspective map turns all triangles or none.
bool has_same_order(const Places& picture, const Places& machine) {
  const bool is_turned = (turn_without(picture, 0) > 0) != (turn_without(machine, 0) > 0);
  for (std::size_t i = 1; i < point_count; ++i)
    if (((turn_without(picture, i) > 0) != (turn_without(machine, i) > 0)) != is_turned)
      return false;
  return true;
}

void check_points(const Json& points) {
  if (!points.is_array() || points.size() != point_count ||
      !std::ranges::all_of(points, [](const Json& each) { return each.is_object(); }))
    throw Refusal(Exit::bad_input, "camera-count");
  const Places picture = coordinates_of(points, "u", "v", 0, 1);
  const Places machine = coordinates_of(points, "x", "y", -max_place_mm, max_place_mm);
  if (has_three_on_a_line(picture) || has_three_on_a_line(machine))
    throw Refusal(Exit::bad_input, "camera-points");
  if (!has_same_order(picture, machine)) throw Refusal(Exit::bad_input, "camera-order");
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
  write_whole(file.string(), kept.dump(2) + "\n");
}

}  // namespace lamplock::serve
