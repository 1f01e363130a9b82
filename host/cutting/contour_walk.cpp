#include "host/cutting/contour_walk.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::cutting {
namespace {

// Parts of edges below this length are nothing.
constexpr double min_part_mm = 1e-9;

}  // namespace

ContourPoint point_along(const Contour& contour, double along_mm) {
  if (contour.closed) {
    const double total = length_of(contour);
    if (along_mm > total) along_mm -= std::floor(along_mm / total) * total;
  }
  for (std::size_t i = 0; i < contour.edges.size(); ++i) {
    const double length = length_of(contour.edges[i]);
    if (along_mm <= length) return {i, length > 0 ? std::max(0.0, along_mm / length) : 0};
    along_mm -= length;
  }
  return {contour.edges.size() - 1, 1};
}

std::vector<Edge> edges_between(const Contour& contour, double from_mm, double to_mm) {
  std::vector<Edge> edges;
  double begin = 0;
  for (std::size_t i = 0; begin < to_mm; ++i) {
    if (i >= contour.edges.size() && !contour.closed) break;
    const Edge& edge = contour.edges[i % contour.edges.size()];
    const double length = length_of(edge);
    // A contour without length would never end.
    if (i % contour.edges.size() == 0 && i > 0 && begin <= 0) break;
    const double from = std::max(from_mm - begin, 0.0), to = std::min(to_mm - begin, length);
    begin += length;
    if (to - from <= min_part_mm) continue;
    const double first = from / length, last = to >= length - min_part_mm ? 1 : to / length;
    edges.push_back(cut_out(edge, first, last, point_at(edge, first), point_at(edge, last)));
  }
  return edges;
}

}  // namespace lamplock::cutting
