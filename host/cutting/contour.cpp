#include "host/cutting/contour.hpp"

#include <fmt/format.h>

#include <algorithm>

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

bool is_counter_clockwise(const Contour& contour) {
  // An area that is smaller, in parts of the square of the length, is 0.
  constexpr double zero_area = 1e-12;
  const double length = length_of(contour);
  return signed_area(contour) >= -zero_area * length * length;
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
