#include "host/model/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "host/geometry/limits.hpp"
#include "host/geometry/vector.hpp"
#include "host/model/spline.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using geometry::Bounds;
using geometry::Point;
using geometry::PointCloud;

template <class... Calls>
struct Overloaded : Calls... {
  using Calls::operator()...;
};
template <class... Calls>
Overloaded(Calls...) -> Overloaded<Calls...>;

Point between(const Point& p, const Point& q, double t) {
  const double r = 1 - t;
  return {r * p.x + t * q.x, r * p.y + t * q.y, r * p.z + t * q.z};
}

Motion line_motion(const Line& line, double t) {
  const Point &p = line.from, &q = line.to;
  return {between(p, q, t), {q.x - p.x, q.y - p.y, q.z - p.z}};
}

Motion arc_motion(const Arc& arc, double t) {
  const double c = std::cos(t), s = std::sin(t);
  const Point &m = arc.centre, &u = arc.u, &v = arc.v;
  return {{m.x + c * u.x + s * v.x, m.y + c * u.y + s * v.y, m.z + c * u.z + s * v.z},
          {c * v.x - s * u.x, c * v.y - s * u.y, c * v.z - s * u.z}};
}

/// Distance from the segment p q.
double distance_to_chord(const Point& at, const Point& p, const Point& q) {
  const Point chord{q.x - p.x, q.y - p.y, q.z - p.z}, to{at.x - p.x, at.y - p.y, at.z - p.z};
  const double square = chord.x * chord.x + chord.y * chord.y + chord.z * chord.z;
  const double along = to.x * chord.x + to.y * chord.y + to.z * chord.z;
  const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0;
  return norm(Point{to.x - t * chord.x, to.y - t * chord.y, to.z - t * chord.z});
}

/// Appends the vertices of polylines, each piece without its start.
class Flattener {
 public:
  Flattener(double tolerance_mm, PointCloud& vertices)
      : tolerance_(tolerance_mm), vertices_(vertices) {}

  void append(const Line& line) { vertices_.push_back(line.to); }

  /// The error of a circle's chord of angle h is r (1 - cos(h / 2)); the arc is an affine image of
  /// a circle, which stretches by at most |u| and |v| together.
  void append(const Arc& arc) {
    const double radius = std::hypot(norm(arc.u), norm(arc.v));
    const double sweep = std::abs(arc.end - arc.start);
    // 1 - cos(h / 2) = 2 sin^2(h / 4), which keeps its digits for large radii
    const double step = 4 * std::asin(std::sqrt(std::min(1.0, tolerance_ / radius / 2)));
    const double chords = std::max(1.0, std::ceil(sweep / std::min(step, std::numbers::pi / 2)));
    geometry::require_count(static_cast<double>(vertices_.size()) + chords, "curve");
    const auto count = static_cast<std::size_t>(chords);
    for (std::size_t i = 1; i <= count; ++i) {
      const double part = static_cast<double>(i) / chords;
      vertices_.push_back(arc_motion(arc, arc.start + (arc.end - arc.start) * part).at);
    }
  }

  void append(const Spline& spline) {
    const std::vector<double> breaks = breaks_of(spline);
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      // As many parts as the piece can have inflections.
      const double width = (breaks[i + 1] - breaks[i]) / spline.degree;
      for (int part = 0; part < spline.degree; ++part) {
        const double from = breaks[i] + part * width;
        const double to = part + 1 == spline.degree ? breaks[i + 1] : from + width;
        halve(spline, {from, to}, spline_motion(spline, from).at, spline_motion(spline, to).at,
              deepest);
      }
    }
  }

 private:
  // 2^-40 of a piece of 10^9 mm is a micrometre.
  static constexpr int deepest = 40;

  void halve(const Spline& spline, const Range& range, const Point& p, const Point& q, int depth) {
    const auto at = [&](double part) {
      return spline_motion(spline, range.from + part * (range.to - range.from)).at;
    };
    const Point middle = at(0.5);
    const auto is_near = [&](const Point& point) {
      return distance_to_chord(point, p, q) <= tolerance_ / 2;
    };
    if (depth == 0 || (is_near(middle) && is_near(at(0.25)) && is_near(at(0.75)))) {
      vertices_.push_back(q);
      return;
    }
    geometry::require_count(static_cast<double>(vertices_.size()), "curve");
    const double half = range.from + (range.to - range.from) / 2;
    halve(spline, {range.from, half}, p, middle, depth - 1);
    halve(spline, {half, range.to}, middle, q, depth - 1);
  }

  double tolerance_;
  PointCloud& vertices_;
};

/// Adds the extrema of the coordinates m + cos t * u + sin t * v, and the ends.
void stretch_over(const Arc& arc, PointCloud& cloud) {
  using std::numbers::pi;
  const auto [low, high] = std::minmax(arc.start, arc.end);
  for (const double first :
       {std::atan2(arc.v.x, arc.u.x), std::atan2(arc.v.y, arc.u.y), std::atan2(arc.v.z, arc.u.z)}) {
    const double from = std::ceil((low - first) / pi), to = std::floor((high - first) / pi);
    for (auto half_turn = std::llround(from); half_turn <= std::llround(to); ++half_turn) {
      cloud.push_back(arc_motion(arc, first + pi * static_cast<double>(half_turn)).at);
    }
  }
  cloud.push_back(arc_motion(arc, arc.start).at);
  cloud.push_back(arc_motion(arc, arc.end).at);
}

}  // namespace

Range range_of(const Piece& piece) {
  return std::visit(Overloaded{[](const Line&) {
                                 return Range{0, 1};
                               },
                               [](const Arc& arc) {
                                 return Range{arc.start, arc.end};
                               },
                               [](const Spline& spline) {
                                 return Range{spline.knots[static_cast<std::size_t>(spline.degree)],
                                              spline.knots[spline.poles.size()]};
                               }},
                    piece);
}

Motion motion_at(const Piece& piece, double parameter) {
  return std::visit(
      Overloaded{[&](const Line& line) { return line_motion(line, parameter); },
                 [&](const Arc& arc) { return arc_motion(arc, parameter); },
                 [&](const Spline& spline) { return spline_motion(spline, parameter); }},
      piece);
}

Point start_of(const Path& path) {
  return motion_at(path.pieces.front(), range_of(path.pieces.front()).from).at;
}

Point end_of(const Path& path) {
  return motion_at(path.pieces.back(), range_of(path.pieces.back()).to).at;
}

bool returns_to_start(const Path& path) {
  const Point from = start_of(path), to = end_of(path);
  return norm(Point{to.x - from.x, to.y - from.y, to.z - from.z}) <= flat_mm;
}

std::string left_out_text(const Curves& curves) {
  // Other names are those of the file, which have no plural.
  constexpr std::array<std::string_view, 7> nouns{
      "clipped curve", "curve", "element", "entity", "rule", "style sheet", "use"};
  std::string text;
  for (const auto& [name, count] : curves.left_out) {
    std::string plural = name;
    for (const std::string_view noun : nouns) {
      const bool is_noun = name == noun || name.starts_with(std::string(noun) + " ");
      if (!is_noun || name == "use") continue;
      plural = (noun == "entity" ? "entities" : std::string(noun) + "s") + name.substr(noun.size());
    }
    text += (text.empty() ? "" : ", ") + count_text(count, name, plural);
  }
  return text;
}

Piece transformed(Piece piece, const geometry::Affine& map) {
  std::visit(Overloaded{[&](Line& line) {
                          line = {map(line.from), map(line.to)};
                        },
                        [&](Arc& arc) {
                          arc.centre = map(arc.centre);
                          arc.u = map.turn(arc.u);
                          arc.v = map.turn(arc.v);
                        },
                        [&](Spline& spline) {
                          for (Point& pole : spline.poles) pole = map(pole);
                        }},
             piece);
  return piece;
}

Curves transformed(Curves curves, const geometry::Affine& map) {
  for (Path& path : curves.paths) {
    for (Piece& piece : path.pieces) piece = transformed(std::move(piece), map);
  }
  for (Point& point : curves.points) point = map(point);
  return curves;
}

PointCloud flattened(const Path& path, double tolerance_mm) {
  geometry::require_positive(tolerance_mm, "curve", "tolerance");
  PointCloud vertices{start_of(path)};
  Flattener flattener(tolerance_mm, vertices);
  for (const Piece& piece : path.pieces) {
    std::visit([&](const auto& kind) { flattener.append(kind); }, piece);
  }
  if (path.closed) vertices.back() = vertices.front();
  return vertices;
}

Bounds bounds(const Curves& curves) {
  PointCloud corners;
  Bounds box = geometry::bounds(curves.points);
  bool any = !curves.points.empty();
  const auto join = [&] {
    if (corners.empty()) return;
    if (any) corners.insert(corners.end(), {box.low, box.high});
    box = geometry::bounds(corners);
    any = true;
    corners.clear();
  };
  Flattener flattener(flat_mm, corners);
  for (const Path& path : curves.paths) {
    corners.push_back(start_of(path));
    for (const Piece& piece : path.pieces) {
      std::visit(Overloaded{[&](const Line& line) { flattener.append(line); },
                            [&](const Arc& arc) { stretch_over(arc, corners); },
                            [&](const Spline& spline) { flattener.append(spline); }},
                 piece);
    }
    join();
  }
  return box;
}

}  // namespace lamplock::model
