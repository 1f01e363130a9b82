#include "host/points/vertical_crossings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamplock::points {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Two steps of a float outside: a place that rounding moves out of a triangle is still in its box.
float float_below(double value) {
  return std::nextafter(std::nextafter(static_cast<float>(value), -infinity), -infinity);
}
float float_above(double value) {
  return std::nextafter(std::nextafter(static_cast<float>(value), infinity), infinity);
}

}  // namespace

VerticalCrossings::VerticalCrossings(std::span<const geometry::Point> vertices,
                                     std::span<const Triangle> triangles)
    : vertices_(vertices), triangles_(triangles), box_(geometry::bounds(vertices)) {
  choose_columns();
  first_.assign(side_ * side_ + 1, 0);
  const auto for_each_column = [&](const Triangle& triangle, const auto& visit) {
    const Columns columns = columns_of(triangle);
    for (std::size_t y = columns.y_from; y <= columns.y_to; ++y) {
      for (std::size_t x = columns.x_from; x <= columns.x_to; ++x) visit(y * side_ + x);
    }
  };
  for (const Triangle& triangle : triangles_)
    for_each_column(triangle, [&](std::size_t column) { ++first_[column + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  listed_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const Listed entry = listed(i);
    for_each_column(triangles_[i], [&](std::size_t column) { listed_[next[column]++] = entry; });
  }
}

/// As many columns as triangles, fewer if large triangles would be listed too often.
void VerticalCrossings::choose_columns() {
  constexpr double max_in_a_row = 2048, max_entries_per_triangle = 16;
  const double wide = std::max(box_.high.x - box_.low.x, box_.high.y - box_.low.y);
  const auto count = static_cast<double>(triangles_.size());
  double side = std::clamp(std::floor(std::sqrt(count)), 1.0, max_in_a_row);
  for (;; side = std::max(1.0, std::floor(side / 2))) {
    side_ = static_cast<std::size_t>(side);
    width_mm_ = wide > 0 ? wide / side : 1;
    double entries = 0;
    for (const Triangle& triangle : triangles_) {
      const Columns columns = columns_of(triangle);
      entries += static_cast<double>((columns.x_to - columns.x_from + 1) *
                                     (columns.y_to - columns.y_from + 1));
    }
    if (side_ == 1 || entries <= max_entries_per_triangle * count) return;
  }
}

std::size_t VerticalCrossings::column_rank(double coordinate, double from) const {
  const double rank = (coordinate - from) / width_mm_;
  return static_cast<std::size_t>(std::clamp(rank, 0.0, static_cast<double>(side_ - 1)));
}

VerticalCrossings::Columns VerticalCrossings::columns_of(const Triangle& triangle) const {
  const auto& [i, j, k] = triangle;
  const geometry::Point &a = vertices_[i], &b = vertices_[j], &c = vertices_[k];
  const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
  const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
  return {column_rank(x_low, box_.low.x), column_rank(x_high, box_.low.x),
          column_rank(y_low, box_.low.y), column_rank(y_high, box_.low.y)};
}

VerticalCrossings::Listed VerticalCrossings::listed(std::uint32_t triangle) const {
  const auto& [i, j, k] = triangles_[triangle];
  const geometry::Point &a = vertices_[i], &b = vertices_[j], &c = vertices_[k];
  const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
  const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
  return {triangle,           float_below(x_low),  float_above(x_high),
          float_below(y_low), float_above(y_high), float_above(std::max({a.z, b.z, c.z}))};
}

/// True if the place is to the left of the edge seen from above. The edge always begins at the
/// vertex of the lower index, so that all triangles at it get the same answer. A place on the edge
/// counts as shifted by a little in x, and by much less in y: so it lies in one triangle only, at
/// vertices too.
bool VerticalCrossings::is_left(std::uint32_t from, std::uint32_t to,
                                const geometry::Point& place) const {
  const bool turned = from > to;
  const geometry::Point& p = vertices_[turned ? to : from];
  const geometry::Point& q = vertices_[turned ? from : to];
  const double side = (q.x - p.x) * (place.y - p.y) - (q.y - p.y) * (place.x - p.x);
  const bool left = side != 0 ? side > 0 : q.y < p.y || (q.y == p.y && q.x > p.x);
  return left != turned;
}

/// Where the vertical line through `place` crosses the triangle; empty if it does not.
std::optional<Crossing> VerticalCrossings::crossing_of(std::uint32_t triangle,
                                                       const geometry::Point& place) const {
  const auto [i, j, k] = triangles_[triangle];
  const bool left = is_left(i, j, place);
  if (is_left(j, k, place) != left || is_left(k, i, place) != left) return std::nullopt;
  const geometry::Point &a = vertices_[i], &b = vertices_[j], &c = vertices_[k];
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return std::nullopt;
  const double u = ((place.x - a.x) * (c.y - a.y) - (place.y - a.y) * (c.x - a.x)) / area;
  const double v = ((b.x - a.x) * (place.y - a.y) - (b.y - a.y) * (place.x - a.x)) / area;
  return Crossing{triangle, a.z + u * (b.z - a.z) + v * (c.z - a.z), left};
}

}  // namespace lamplock::points
