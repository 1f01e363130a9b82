// Contours for tests: polylines with bulges, circles, paths of drawings; random shapes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/geometry/random.hpp"
#include "host/model/curves.hpp"

namespace lamplock::test {

using cutting::Contour;
using cutting::Edge;
using cutting::Vec;

inline model::Path line_path(Vec from, Vec to) {
  return {{model::Line{{from.x, from.y, 0}, {to.x, to.y, 0}}}};
}

inline model::Path arc_path(Vec centre, double radius, double start, double end) {
  return {{model::Arc{{centre.x, centre.y, 0}, {radius, 0, 0}, {0, radius, 0}, start, end}}};
}

inline model::Path circle_path(Vec centre, double radius) {
  model::Path path = arc_path(centre, radius, 0, 2 * std::numbers::pi);
  path.closed = true;
  return path;
}

/// A line, or an arc as readers make it.
inline model::Path path_of(const Edge& edge) {
  if (edge.is_line()) return line_path(edge.from, edge.to);
  const Vec out = edge.from - edge.centre;
  const double start = std::atan2(out.y, out.x);
  return arc_path(edge.centre, cutting::radius_of(edge), start, start + edge.sweep);
}

/// Curves of the layer "0".
inline model::Curves of_one_layer(std::vector<model::Path> paths) {
  model::Curves curves;
  curves.layers = {"0"};
  curves.paths = std::move(paths);
  return curves;
}

inline std::size_t count_of(const std::vector<cutting::Fault>& faults, cutting::FaultKind kind) {
  return static_cast<std::size_t>(
      std::count_if(faults.begin(), faults.end(),
                    [kind](const cutting::Fault& fault) { return fault.kind == kind; }));
}

inline Contour polygon(const std::vector<Vec>& corners) {
  Contour contour;
  contour.closed = true;
  for (std::size_t i = 0; i < corners.size(); ++i)
    contour.edges.push_back({corners[i], corners[(i + 1) % corners.size()], {}, 0});
  return contour;
}

/// Counter-clockwise.
inline Contour circle(Vec centre, double radius) {
  const Edge half = cutting::arc_from(centre, centre + Vec{radius, 0}, std::numbers::pi);
  Edge back = cutting::arc_from(centre, half.to, std::numbers::pi);
  back.to = half.from;
  return {{half, back}, true};
}

/// Counter-clockwise, with its lower left corner at `low`.
inline Contour rounded_rectangle(Vec low, double width, double height, double radius) {
  const Vec high = low + Vec{width, height};
  const double quarter = std::numbers::pi / 2;
  const auto corner = [&](Vec centre, Vec out, Vec end) {
    return Edge{centre + out * radius, centre + end * radius, centre, quarter};
  };
  Contour contour;
  const std::vector<Edge> corners{corner({high.x - radius, low.y + radius}, {0, -1}, {1, 0}),
                                  corner({high.x - radius, high.y - radius}, {1, 0}, {0, 1}),
                                  corner({low.x + radius, high.y - radius}, {0, 1}, {-1, 0}),
                                  corner({low.x + radius, low.y + radius}, {-1, 0}, {0, -1})};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec before = corners[(i + 3) % 4].to;
    if (before != corners[i].from) contour.edges.push_back({before, corners[i].from, {}, 0});
    contour.edges.push_back(corners[i]);
  }
  contour.closed = true;
  return contour;
}

/// The arc between two points by its bulge, the tangent of a quarter of its sweep; a line for 0.
inline Edge bulged(Vec from, Vec to, double bulge) {
  if (bulge == 0) return {from, to, {}, 0};
  const Vec chord = to - from;
  const double aside = (1 / bulge - bulge) / 4;
  return {from, to, (from + to) * 0.5 - cutting::right_of(chord) * aside, 4 * std::atan(bulge)};
}

/// A counter-clockwise star-shaped contour of lines and arcs in the ring between two radii; never
/// crosses itself. Some corners are deep, some arcs bulge inwards.
inline Contour random_star(geometry::Random& random, Vec centre, double inner, double outer,
                           int corners) {
  std::vector<Vec> points;
  for (int i = 0; i < corners; ++i) {
    const double turn = 2 * std::numbers::pi * (i + 0.6 * random.uniform()) / corners;
    const double radius = inner + (outer - inner) * random.uniform();
    points.push_back(centre + Vec{std::cos(turn), std::sin(turn)} * radius);
  }
  Contour contour = polygon(points);
  for (Edge& edge : contour.edges) {
    if (random.uniform() < 0.5) continue;
    // A bulge this small keeps the arc inside the sector of its chord, so that arcs do not cross.
    const Vec chord = edge.to - edge.from;
    const auto angle_to = [&](Vec radial) {
      return std::abs(std::atan2(cutting::cross(chord, radial), cutting::dot(chord, radial)));
    };
    const double room = std::min(
        {angle_to(edge.to - centre), std::numbers::pi - angle_to(edge.from - centre),
         angle_to(edge.from - centre), std::numbers::pi - angle_to(edge.to - centre), 1.2});
    edge = bulged(edge.from, edge.to, std::tan(0.45 * room) * (random.uniform() < 0.5 ? 1 : -1));
  }
  return contour;
}

/// How often the contours run around a point, counter-clockwise, by the angles that it sees.
inline int turns_around(const std::vector<Contour>& contours, const Vec& at) {
  double sum = 0;
  for (const Contour& contour : contours) {
    for (const Edge& edge : contour.edges) {
      const int parts = edge.is_line() ? 1 : 60;
      for (int i = 0; i < parts; ++i) {
        const Vec p = cutting::point_at(edge, double(i) / parts) - at,
                  q = cutting::point_at(edge, double(i + 1) / parts) - at;
        sum += std::atan2(cutting::cross(p, q), cutting::dot(p, q));
      }
    }
  }
  return static_cast<int>(std::lround(sum / (2 * std::numbers::pi)));
}

/// Each edge of a contour as a path of its own, some of them backwards, shuffled.
inline model::Curves scattered(const std::vector<Contour>& contours, geometry::Random& random,
                               double noise_mm) {
  model::Curves curves = of_one_layer({});
  const auto noisy = [&](Vec p) {
    const double turn = 2 * std::numbers::pi * random.uniform(), away = noise_mm * random.uniform();
    return p + Vec{away * std::cos(turn), away * std::sin(turn)};
  };
  for (const Contour& contour : contours) {
    for (const Edge& straight : contour.edges) {
      Edge edge = random.uniform() < 0.5 ? straight : cutting::reversed(straight);
      edge = cutting::with_ends(edge, noisy(edge.from), noisy(edge.to));
      curves.paths.push_back(path_of(edge));
    }
  }
  for (std::size_t i = curves.paths.size(); i > 1; --i)
    std::swap(curves.paths[i - 1], curves.paths[random.next() % i]);
  return curves;
}

}  // namespace lamplock::test
