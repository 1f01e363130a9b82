#include "host/points/inside.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lamplock::points {
namespace {

/// True if (x, y) is to the left of the edge seen from above. The edge always begins at the vertex
/// of the lower index, so that both triangles at it get the same answer. A place on the edge counts
/// as shifted by a little in x, and by much less in y: so it lies in one triangle only, at vertices
/// too.
bool is_left(const model::Mesh& mesh, std::uint32_t from, std::uint32_t to,
             const geometry::Point& place) {
  const bool turned = from > to;
  const geometry::Point& p = mesh.vertices[turned ? to : from];
  const geometry::Point& q = mesh.vertices[turned ? from : to];
  const double side = (q.x - p.x) * (place.y - p.y) - (q.y - p.y) * (place.x - p.x);
  const bool left = side != 0 ? side > 0 : q.y < p.y || (q.y == p.y && q.x > p.x);
  return left != turned;
}

/// z where the vertical line through `place` crosses the triangle; empty if it does not.
std::optional<double> crossing_z(const model::Mesh& mesh,
                                 const std::array<std::uint32_t, 3>& triangle,
                                 const geometry::Point& place) {
  const auto [i, j, k] = triangle;
  const bool left = is_left(mesh, i, j, place);
  if (is_left(mesh, j, k, place) != left || is_left(mesh, k, i, place) != left) {
    return std::nullopt;
  }
  const geometry::Point &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0) return std::nullopt;
  const double u = ((place.x - a.x) * (c.y - a.y) - (place.y - a.y) * (c.x - a.x)) / area;
  const double v = ((b.x - a.x) * (place.y - a.y) - (b.y - a.y) * (place.x - a.x)) / area;
  return a.z + u * (b.z - a.z) + v * (c.z - a.z);
}

}  // namespace

Inside::Inside(const model::Mesh& mesh) : mesh_(mesh), box_(bounds(mesh.vertices)) {
  choose_columns();
  first_.assign(side_ * side_ + 1, 0);
  const auto for_each_column = [&](std::size_t triangle, const auto& visit) {
    const Columns columns = columns_of(triangle);
    for (std::size_t y = columns.y_from; y <= columns.y_to; ++y) {
      for (std::size_t x = columns.x_from; x <= columns.x_to; ++x) visit(y * side_ + x);
    }
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for_each_column(i, [&](std::size_t column) { ++first_[column + 1]; });
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  triangles_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for_each_column(
        i, [&](std::size_t column) { triangles_[next[column]++] = static_cast<std::uint32_t>(i); });
  }
}

/// As many columns as triangles, fewer if large triangles would be listed too often.
void Inside::choose_columns() {
  constexpr double max_in_a_row = 2048, max_entries_per_triangle = 16;
  const double wide = std::max(box_.high.x - box_.low.x, box_.high.y - box_.low.y);
  const auto triangles = static_cast<double>(mesh_.triangles.size());
  double side = std::clamp(std::floor(std::sqrt(triangles)), 1.0, max_in_a_row);
  for (;; side = std::max(1.0, std::floor(side / 2))) {
    side_ = static_cast<std::size_t>(side);
    width_mm_ = wide > 0 ? wide / side : 1;
    double entries = 0;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Columns columns = columns_of(i);
      entries += static_cast<double>((columns.x_to - columns.x_from + 1) *
                                     (columns.y_to - columns.y_from + 1));
    }
    if (side_ == 1 || entries <= max_entries_per_triangle * triangles) return;
  }
}

std::size_t Inside::column_rank(double coordinate, double from) const {
  const double rank = (coordinate - from) / width_mm_;
  return static_cast<std::size_t>(std::clamp(rank, 0.0, static_cast<double>(side_ - 1)));
}

Inside::Columns Inside::columns_of(std::size_t triangle) const {
  const auto& [i, j, k] = mesh_.triangles[triangle];
  const geometry::Point &a = mesh_.vertices[i], &b = mesh_.vertices[j], &c = mesh_.vertices[k];
  const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
  const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
  return {column_rank(x_low, box_.low.x), column_rank(x_high, box_.low.x),
          column_rank(y_low, box_.low.y), column_rank(y_high, box_.low.y)};
}

template <class Hit>
void Inside::for_each_crossing(const geometry::Point& place, const Hit& hit) const {
  const std::size_t column =
      column_rank(place.y, box_.low.y) * side_ + column_rank(place.x, box_.low.x);
  for (std::size_t i = first_[column]; i < first_[column + 1]; ++i) {
    if (const auto z = crossing_z(mesh_, mesh_.triangles[triangles_[i]], place)) hit(*z);
  }
}

bool Inside::contains(const geometry::Point& place) const {
  bool inside = false;
  for_each_crossing(place, [&](double z) { inside = inside != (z > place.z); });
  return inside;
}

double Inside::filled_above_mm(const geometry::Point& place) const {
  std::vector<double> above;
  for_each_crossing(place, [&](double z) {
    if (z > place.z) above.push_back(z);
  });
  if (above.size() % 2 != 0) above.push_back(place.z);
  std::sort(above.begin(), above.end());
  double filled = 0;
  for (std::size_t i = 0; i < above.size(); i += 2) filled += above[i + 1] - above[i];
  return filled;
}

}  // namespace lamplock::points
