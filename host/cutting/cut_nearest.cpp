// nearest_visits(): start points in the cells of a grid that is made again as they get fewer.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/cutting/cut_stops.hpp"

namespace lamplock::cutting {
namespace {

class NearestStops {
 public:
  explicit NearestStops(const std::vector<CutStop>& stops)
      : stops_(stops), open_(stops.size()), is_cut_(stops.size(), false) {
    for (std::size_t i = 0; i < stops.size(); ++i) {
      open_[i] = stops[i].children;
      if (open_[i] == 0) live_.push_back(i);
    }
    rebuild();
  }

  /// The nearest start point of a stop that may be cut; there is one.
  CutVisit nearest(const Vec& at) const {
    const long column = column_of(at.x), row = row_of(at.y);
    CutVisit best;
    double shortest = std::numeric_limits<double>::infinity();
    // Points in the cells of ring r are more than r - 1 cells away; those that are in an outer cell
    // because they lie outside of the grid are even further.
    for (long ring = 0; ring <= std::max(columns_, rows_); ++ring) {
      if (shortest <= static_cast<double>(ring - 1) * cell_) break;
      visit_ring(column, row, ring, [&](const CutVisit& visit) {
        if (is_cut_[visit.stop]) return;
        const double away = distance(at, stops_[visit.stop].entry(visit.start));
        if (away >= shortest) return;
        shortest = away;
        best = visit;
      });
    }
    return best;
  }

  void remove(std::size_t stop) {
    is_cut_[stop] = true;
    const std::size_t parent = stops_[stop].parent;
    if (parent != CutStop::none && --open_[parent] == 0) {
      live_.push_back(parent);
      add(parent);
    }
    ++removed_;
    if (2 * removed_ > live_.size()) rebuild();
  }

 private:
  void rebuild() {
    std::erase_if(live_, [&](std::size_t stop) { return is_cut_[stop]; });
    removed_ = 0;
    low_ = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    high_ = {-low_.x, -low_.y};
    double count = 0;
    for (const std::size_t stop : live_) {
      for (const Vec& start : stops_[stop].starts) {
        low_ = {std::min(low_.x, start.x), std::min(low_.y, start.y)};
        high_ = {std::max(high_.x, start.x), std::max(high_.y, start.y)};
        ++count;
      }
    }
    cells_.clear();
    if (live_.empty()) return;
    // About two start points in a cell.
    const double width = high_.x - low_.x, height = high_.y - low_.y;
    cell_ = std::max({std::sqrt(2 * width * height / count), 2 * width / count, 2 * height / count,
                      std::numeric_limits<double>::min()});
    columns_ = static_cast<long>(width / cell_) + 1;
    rows_ = static_cast<long>(height / cell_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_ * rows_));
    for (const std::size_t stop : live_) add(stop);
  }

  // Points outside of the grid are in its outer cells.
  long column_of(double x) const {
    return static_cast<long>(std::clamp((x - low_.x) / cell_, 0.0, double(columns_ - 1)));
  }
  long row_of(double y) const {
    return static_cast<long>(std::clamp((y - low_.y) / cell_, 0.0, double(rows_ - 1)));
  }

  void add(std::size_t stop) {
    if (cells_.empty()) return;
    for (std::size_t start = 0; start < stops_[stop].starts.size(); ++start) {
      const Vec& at = stops_[stop].starts[start];
      cells_[static_cast<std::size_t>(row_of(at.y) * columns_ + column_of(at.x))].push_back(
          {stop, start});
    }
  }

  template <class Found>
  void visit_ring(long column, long row, long ring, const Found& found) const {
    for (long y = std::max(0L, row - ring); y <= std::min(rows_ - 1, row + ring); ++y) {
      const bool is_edge = y == row - ring || y == row + ring;
      for (long x = column - ring; x <= column + ring; x += is_edge || ring == 0 ? 1 : 2 * ring) {
        if (x < 0 || x >= columns_) continue;
        for (const CutVisit& visit : cells_[static_cast<std::size_t>(y * columns_ + x)])
          found(visit);
      }
    }
  }

  const std::vector<CutStop>& stops_;
  std::vector<std::size_t> open_;  ///< children that are not cut yet
  std::vector<bool> is_cut_;
  std::vector<std::size_t> live_;  ///< stops in the grid; some of them cut
  std::size_t removed_ = 0;
  Vec low_, high_;
  double cell_ = 1;
  long columns_ = 0, rows_ = 0;
  std::vector<std::vector<CutVisit>> cells_;
};

}  // namespace

std::vector<CutVisit> nearest_visits(const std::vector<CutStop>& stops, const Vec& position) {
  NearestStops remaining(stops);
  std::vector<CutVisit> visits;
  Vec at = position;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    visits.push_back(remaining.nearest(at));
    at = stops[visits.back().stop].exit(visits.back().start);
    remaining.remove(visits.back().stop);
  }
  return visits;
}

}  // namespace lamplock::cutting
