#include "host/model/curve_collector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/file.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

// For larger angles a double has too few digits for the fraction of a turn.
constexpr double max_radians = 1e6;

/// Written so that NaN is not within.
bool is_within_reach(const Point& p) {
  return std::abs(p.x) <= farthest_mm && std::abs(p.y) <= farthest_mm &&
         std::abs(p.z) <= farthest_mm;
}

struct IsWithinReach {
  bool operator()(const Line& line) const {
    return is_within_reach(line.from) && is_within_reach(line.to);
  }
  bool operator()(const Arc& arc) const {
    return is_within_reach(arc.centre) && is_within_reach(arc.u) && is_within_reach(arc.v) &&
           std::abs(arc.start) <= max_radians && std::abs(arc.end) <= max_radians;
  }
  bool operator()(const Spline& spline) const {
    for (const Point& pole : spline.poles) {
      if (!is_within_reach(pole)) return false;
    }
    return true;
  }
};

[[noreturn]] void refuse_far(const FilePosition& place) {
  place.refuse(
      fmt::format("a coordinate or angle is not a number, or the curve is further than {:g} mm",
                  farthest_mm),
      "repair the drawing or check its unit");
}

/// Cost of a path in pieces; splines count by their poles.
std::size_t cost_of(const Path& path) {
  std::size_t cost = 0;
  for (const Piece& piece : path.pieces) {
    const auto* spline = std::get_if<Spline>(&piece);
    cost += spline != nullptr ? spline->poles.size() : 1;
  }
  return cost;
}

}  // namespace

void CurveCollector::add(Path path, const geometry::Affine& map, const std::string& layer,
                         const FilePosition& place) {
  spend(std::max<std::size_t>(1, cost_of(path)), place);
  if (path.pieces.empty()) return leave_out("curve without length");
  path = placed(std::move(path), map, place);
  path.closed = path.closed || returns_to_start(path);
  path.layer = layer_number(layer);
  curves_.paths.push_back(std::move(path));
}

Path CurveCollector::placed(Path path, const geometry::Affine& map, const FilePosition& place) {
  for (Piece& piece : path.pieces) {
    piece = transformed(std::move(piece), map);
    if (!std::visit(IsWithinReach{}, piece)) refuse_far(place);
  }
  return path;
}

void CurveCollector::add(const Point& point, const geometry::Affine& map,
                         const FilePosition& place) {
  // Without applying the identity even signs of zeros are kept: point lists are read back exactly.
  const Point placed = map == geometry::Affine{} ? point : map(point);
  if (!is_within_reach(placed)) refuse_far(place);
  if (curves_.points.size() == geometry::max_points)
    place.refuse(fmt::format("more than {} points", geometry::max_points), "divide the drawing");
  curves_.points.push_back(placed);
}

void CurveCollector::spend(std::size_t pieces, const FilePosition& place) {
  spent_ += pieces;
  if (spent_ > max_pieces)
    place.refuse(fmt::format("the drawing has more than {} pieces of curves", max_pieces),
                 "simplify it or divide it");
}

void CurveCollector::leave_out(const std::string& name, std::size_t count) {
  curves_.left_out[name] += count;
}

void CurveCollector::warn(std::string warning) { curves_.warnings.push_back(std::move(warning)); }

std::uint32_t CurveCollector::layer_number(const std::string& name) {
  const auto [entry, is_new] =
      layers_.try_emplace(name, static_cast<std::uint32_t>(curves_.layers.size()));
  if (is_new) curves_.layers.push_back(name);
  return entry->second;
}

Curves CurveCollector::finished(const std::filesystem::path& file) && {
  if (curves_.paths.empty() && curves_.points.empty()) {
    const std::string rest = left_out_text(curves_);
    refuse(file,
           rest.empty() ? "the drawing is empty"
                        : fmt::format("the drawing has no curves (left out: {})", rest),
           "draw lines, arcs or splines");
  }
  return std::move(curves_);
}

void append_line(Path& path, const Point& from, const Point& to) {
  if (from != to) path.pieces.emplace_back(Line{from, to});
}

}  // namespace lamplock::model
