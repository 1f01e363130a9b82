#include "host/model/svg_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/model/curve_collector.hpp"
#include "host/model/svg_path.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;
using Paths = std::vector<Path>;
using std::numbers::pi;

/// Counter-clockwise if y points up.
Arc ellipse(const Point& centre, double x_radius, double y_radius) {
  return {centre, {x_radius, 0, 0}, {0, y_radius, 0}, 0, 2 * pi};
}

Paths round_shape(const pugi::xml_node& node, bool is_circle, const SvgBox& port,
                  const FilePosition& place) {
  const auto value = [&](const char* name, double whole) {
    return svg_length_of(node, name, whole, 0, place);
  };
  const Point centre{value("cx", port.width), value("cy", port.height), 0};
  // A percentage of a radius refers to the diagonal over the root of 2.
  const double across = std::hypot(port.width, port.height) / std::numbers::sqrt2;
  const double rx = is_circle ? value("r", across) : value("rx", port.width);
  const double ry = is_circle ? rx : value("ry", port.height);
  if (rx < 0 || ry < 0)
    place.refuse(fmt::format("the radii {} and {} are not allowed", rx, ry), "repair the drawing");
  if (rx == 0 || ry == 0) return {};
  return {{{ellipse(centre, rx, ry)}, true}};
}

Paths polyline(const pugi::xml_node& node, bool closed, const FilePosition& place) {
  const std::vector<double> numbers = svg_numbers(node.attribute("points").value(), place);
  if (numbers.size() % 2 != 0)
    place.refuse(fmt::format("the points have {} coordinates, an odd number", numbers.size()),
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

/// The two radii of a rectangle's corners: a missing one equals the other; each is at most half a
/// side.
Point corner_of(const pugi::xml_node& node, const SvgBox& box, const SvgBox& port,
                const FilePosition& place) {
  constexpr double missing = -1;
  double rx = svg_length_of(node, "rx", port.width, missing, place);
  double ry = svg_length_of(node, "ry", port.height, missing, place);
  if (rx < 0) rx = ry;
  if (ry < 0) ry = rx;
  if (!(rx > 0) || !(ry > 0)) return {};
  return {std::min(rx, box.width / 2), std::min(ry, box.height / 2), 0};
}

/// Begins at the upper left, as in SVG; corners are quarters of ellipses.
Paths rectangle(const pugi::xml_node& node, const SvgBox& port, const FilePosition& place) {
  const SvgBox box = svg_box_of(node, port, place);
  if (box.width == 0 || box.height == 0) return {};
  const Point cut = corner_of(node, box, port, place);
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

Paths line(const pugi::xml_node& node, const SvgBox& port, const FilePosition& place) {
  const auto value = [&](const char* name, double whole) {
    return svg_length_of(node, name, whole, 0, place);
  };
  return {{{Line{{value("x1", port.width), value("y1", port.height), 0},
                 {value("x2", port.width), value("y2", port.height), 0}}}}};
}

}  // namespace

double svg_length_of(const pugi::xml_node& node, const char* name, double whole_px,
                     double otherwise, const FilePosition& place) {
  const std::string_view text = node.attribute(name).value();
  return text.empty() || text == "auto" ? otherwise : svg_length(text, whole_px, place);
}

SvgBox svg_box_of(const pugi::xml_node& node, const SvgBox& port, const FilePosition& place) {
  const SvgBox box{svg_length_of(node, "x", port.width, 0, place),
                   svg_length_of(node, "y", port.height, 0, place),
                   svg_length_of(node, "width", port.width, 0, place),
                   svg_length_of(node, "height", port.height, 0, place)};
  if (box.width < 0 || box.height < 0)
    place.refuse(fmt::format("the size {} x {} is not allowed", box.width, box.height),
                 "repair the drawing");
  return box;
}

std::optional<Paths> svg_shape(const pugi::xml_node& node, std::string_view name,
                               const SvgBox& port, const FilePosition& place) {
  if (name == "path") return svg_path(node.attribute("d").value(), place);
  if (name == "rect") return rectangle(node, port, place);
  if (name == "circle" || name == "ellipse")
    return round_shape(node, name == "circle", port, place);
  if (name == "line") return line(node, port, place);
  if (name == "polyline" || name == "polygon") return polyline(node, name == "polygon", place);
  return std::nullopt;
}

}  // namespace lamplock::model
