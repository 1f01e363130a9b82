#include "host/cutting/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamplock::cutting {

double length_of(const Contour& contour) {
  double length = 0;
  for (const Edge& edge : contour.edges) length += length_of(edge);
  return length;
}

double signed_area(const Contour& contour) {
  if (!contour.closed) return 0;
  // About the first point: far from the origin the products would lose the digits of the area.
  const Vec origin = contour.edges.front().from;
  double area = 0;
  for (const Edge& edge : contour.edges)
    area += area_below({edge.from - origin, edge.to - origin, edge.centre - origin, edge.sweep});
  return area;
}

namespace {

/// A moment of the signed area about the low corner of the box [mm^3], of chords: loops of equal
/// areas at different places have different ones.
double signed_moment(const Contour& contour) {
  constexpr int chords = 4;      // of an edge
  constexpr double slope = 0.7;  // so that loops beside and above each other differ
  const Vec low = box_of(contour).low;
  double moment = 0;
  for (const Edge& edge : contour.edges) {
    for (int i = 0; i < chords; ++i) {
      const Vec a = point_at(edge, static_cast<double>(i) / chords) - low;
      const Vec b = point_at(edge, static_cast<double>(i + 1) / chords) - low;
      moment += cross(a, b) * (a.x + b.x + slope * (a.y + b.y)) / 6;
    }
  }
  return moment;
}

}  // namespace

bool is_counter_clockwise(const Contour& contour) {
  // Areas and moments that are smaller, in parts of a power of the length, are 0.
  constexpr double zero = 1e-12;
  const double length = length_of(contour), area = signed_area(contour);
  if (std::abs(area) > zero * length * length) return area > 0;
  return signed_moment(contour) >= -zero * length * length * length;
}

Box box_of(const Contour& contour) {
  Box box;
  for (const Edge& edge : contour.edges) box.add(box_of(edge));
  return box;
}

Contour reversed(const Contour& contour) {
  Contour back = contour;
  std::reverse(back.edges.begin(), back.edges.end());
  for (Edge& edge : back.edges) edge = reversed(edge);
  return back;
}

std::string contour_text(const Contour& contour) {
  const Box box = box_of(contour);
  const Vec middle = (box.low + box.high) * 0.5;
  return fmt::format("contour of {:.3f} mm at ({:.3f}, {:.3f})", length_of(contour), middle.x,
                     middle.y);
}

}  // namespace lamplock::cutting
