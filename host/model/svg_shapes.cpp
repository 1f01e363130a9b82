#include "host/model/svg_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "host/model/curve_collector.hpp"
#include "host/model/svg_path.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;
using Paths = std::vector<Path>;
using std::numbers::pi;

/// Counter-clockwise if y points up.
Arc ellipse(const Point& centre, double x_radius, double y_radius) {
  return {centre, {x_radius, 0, 0}, {0, y_radius, 0}, 0, 2 * pi};
}

/// The two radii of ellipses and of a rectangle's corners: a missing one equals the other; negative
/// if both are missing.
std::pair<double, double> radii_of(const pugi::xml_node& node, const SvgUnits& units,
                                   const FilePosition& place) {
  constexpr double missing = -1;
  const double rx = svg_length_of(node, "rx", units.port.width, missing, units, place);
  const double ry = svg_length_of(node, "ry", units.port.height, missing, units, place);
  const auto is_missing = [&](const char* name) {
    const std::string_view text = node.attribute(name).value();
    return text.empty() || text == "auto";
  };
  if (rx < 0 && !is_missing("rx"))
    place.refuse(fmt::format("the radii {} and {} are not allowed", rx, ry), "repair the drawing");
  if (ry < 0 && !is_missing("ry"))
    place.refuse(fmt::format("the radii {} and {} are not allowed", rx, ry), "repair the drawing");
  return {rx < 0 ? ry : rx, ry < 0 ? rx : ry};
}

Paths round_shape(const pugi::xml_node& node, bool is_circle, const SvgUnits& units,
                  const FilePosition& place) {
  const SvgBox& port = units.port;
  const auto value = [&](const char* name, double whole) {
    return svg_length_of(node, name, whole, 0, units, place);
  };
  const Point centre{value("cx", port.width), value("cy", port.height), 0};
  double rx = 0, ry = 0;
  if (is_circle) {
    rx = ry = value("r", svg_diagonal(port));
  } else {
    std::tie(rx, ry) = radii_of(node, units, place);
    rx = std::max(rx, 0.0);
    ry = std::max(ry, 0.0);
  }
  if (rx < 0 || ry < 0)
    place.refuse(fmt::format("the radii {} and {} are not allowed", rx, ry), "repair the drawing");
  if (rx == 0 || ry == 0) return {};
  return {{{ellipse(centre, rx, ry)}, true}};
}

Paths polyline(const pugi::xml_node& node, bool closed, const FilePosition& place) {
  const std::vector<double> numbers = svg_numbers(node.attribute("points").value(), place);
  if (numbers.size() % 2 != 0)
    place.refuse(
        fmt::format("the points have {}, an odd number", count_text(numbers.size(), "coordinate")),
        "repair the drawing");
  Path path;
  path.closed = closed;
  const std::size_t count = numbers.size() / 2;
  const auto at = [&](std::size_t i) { return Point{numbers[2 * i], numbers[2 * i + 1], 0}; };
  for (std::size_t i = 0; i + 1 < count; ++i) append_line(path, at(i), at(i + 1));
  if (closed && count > 0) append_line(path, at(count - 1), at(0));
  if (path.pieces.empty()) return {};
  return {path};
}

/// The radii of a rectangle's corners, each at most half a side.
Point corner_of(const pugi::xml_node& node, const SvgBox& box, const SvgUnits& units,
                const FilePosition& place) {
  const auto [rx, ry] = radii_of(node, units, place);
  if (!(rx > 0) || !(ry > 0)) return {};
  return {std::min(rx, box.width / 2), std::min(ry, box.height / 2), 0};
}

/// Begins at the upper left, as in SVG; corners are quarters of ellipses.
Paths rectangle(const pugi::xml_node& node, const SvgUnits& units, const FilePosition& place) {
  const SvgBox box = svg_box_of(node, units, place);
  if (box.width == 0 || box.height == 0) return {};
  const Point cut = corner_of(node, box, units, place);
  const double left = box.x, right = box.x + box.width, top = box.y, bottom = box.y + box.height;
  // For each side: start, end, and the centre of the corner after it.
  struct Side {
    Point from, to, corner;
  };
  const std::array<Side, 4> sides{
      {{{left + cut.x, top}, {right - cut.x, top}, {right - cut.x, top + cut.y}},
       {{right, top + cut.y}, {right, bottom - cut.y}, {right - cut.x, bottom - cut.y}},
       {{right - cut.x, bottom}, {left + cut.x, bottom}, {left + cut.x, bottom - cut.y}},
       {{left, bottom - cut.y}, {left, top + cut.y}, {left + cut.x, top + cut.y}}}};
  Path path;
  path.closed = true;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    append_line(path, sides[i].from, sides[i].to);
    if (cut.x == 0) continue;
    Arc arc = ellipse(sides[i].corner, cut.x, cut.y);
    arc.start = (static_cast<double>(i) - 1) * pi / 2;
    arc.end = arc.start + pi / 2;
    path.pieces.emplace_back(arc);
  }
  return {path};
}

Paths line(const pugi::xml_node& node, const SvgUnits& units, const FilePosition& place) {
  const SvgBox& port = units.port;
  const auto value = [&](const char* name, double whole) {
    return svg_length_of(node, name, whole, 0, units, place);
  };
  return {{{Line{{value("x1", port.width), value("y1", port.height), 0},
                 {value("x2", port.width), value("y2", port.height), 0}}}}};
}

/// The data in the form of CSS, path("..."), too; "none" is no data.
std::string_view path_data(std::string_view text) {
  if (text == "none") return {};
  if (!text.starts_with("path(")) return text;
  const std::size_t begin = text.find_first_of("'\""), end = text.find_last_of("'\"");
  return begin < end && end != std::string_view::npos ? text.substr(begin + 1, end - begin - 1)
                                                      : std::string_view{};
}

}  // namespace

double svg_length_of(const pugi::xml_node& node, const char* name, double whole_px,
                     double otherwise, const SvgUnits& units, const FilePosition& place) {
  const std::string_view text = node.attribute(name).value();
  return text.empty() || text == "auto" ? otherwise : svg_length(text, whole_px, units, place);
}

double svg_diagonal(const SvgBox& port) {
  return std::hypot(port.width, port.height) / std::numbers::sqrt2;
}

SvgBox svg_box_of(const pugi::xml_node& node, const SvgUnits& units, const FilePosition& place) {
  const SvgBox& port = units.port;
  const SvgBox box{svg_length_of(node, "x", port.width, 0, units, place),
                   svg_length_of(node, "y", port.height, 0, units, place),
                   svg_length_of(node, "width", port.width, 0, units, place),
                   svg_length_of(node, "height", port.height, 0, units, place)};
  if (box.width < 0 || box.height < 0)
    place.refuse(fmt::format("the size {} x {} is not allowed", box.width, box.height),
                 "repair the drawing");
  return box;
}

std::optional<Paths> svg_shape(const pugi::xml_node& node, std::string_view name,
                               const SvgUnits& units, const FilePosition& place) {
  if (name == "path") return svg_path(path_data(node.attribute("d").value()), place);
  if (name == "rect") return rectangle(node, units, place);
  if (name == "circle" || name == "ellipse")
    return round_shape(node, name == "circle", units, place);
  if (name == "line") return line(node, units, place);
  if (name == "polyline" || name == "polygon") return polyline(node, name == "polygon", place);
  return std::nullopt;
}

}  // namespace lamplock::model
