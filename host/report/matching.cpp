#include "host/report/matching.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/units.hpp"

namespace lamplock::report {
namespace {

/// Number of open points with which a wrong shot is compared, from each of two starts.
constexpr std::uint32_t window = 16;

/// Points by their cubic cell of a lattice, to find points near a position.
class CellIndex {
 public:
  CellIndex(const std::vector<WantedSteps>& wanted, double cell_steps) : cell_(cell_steps) {
    entries_.reserve(wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
      entries_.push_back({key(cell_of(wanted[i])), static_cast<std::uint32_t>(i)});
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls visit(point) for every point in the cells around a position, cell by cell.
  template <class Visit>
  void around(const WantedSteps& at, Visit visit) const {
    const Cell centre = cell_of(at);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = -1; dz <= 1; ++dz)
          visit_cell(key({centre[0] + dx, centre[1] + dy, centre[2] + dz}), visit);
  }

 private:
  using Cell = std::array<std::int64_t, point_axes>;
  struct Entry {
    std::uint64_t key;
    std::uint32_t point;
    friend auto operator<=>(const Entry&, const Entry&) = default;
  };

  Cell cell_of(const WantedSteps& at) const {
    Cell cell{};
    for (std::size_t a = 0; a < point_axes; ++a)
      cell[a] = static_cast<std::int64_t>(std::floor(at[a] / cell_));
    return cell;
  }
  /// 21 bits per axis: cells that collide are far apart, and the caller measures distances anyway.
  static std::uint64_t key(const Cell& cell) {
    constexpr std::uint64_t mask = (1u << 21) - 1;
    std::uint64_t result = 0;
    for (std::int64_t c : cell) result = (result << 21) | (static_cast<std::uint64_t>(c) & mask);
    return result;
  }
  template <class Visit>
  void visit_cell(std::uint64_t wanted_key, Visit& visit) const {
    auto entry = std::lower_bound(entries_.begin(), entries_.end(), Entry{wanted_key, 0});
    for (; entry != entries_.end() && entry->key == wanted_key; ++entry) visit(entry->point);
  }

  double cell_;
  std::vector<Entry> entries_;
};

/// Open points, which still need shots; finds the first one from an index in nearly constant time.
class OpenPoints {
 public:
  OpenPoints(std::size_t count, const std::vector<std::uint16_t>& ordered)
      : left_(count, 1), next_(count + 1) {
    std::iota(next_.begin(), next_.end(), 0u);
    for (std::size_t i = 0; i < ordered.size(); ++i) {
      left_[i] = ordered[i];
      if (left_[i] == 0) close(static_cast<std::uint32_t>(i));
    }
  }
  bool open(std::uint32_t point) const { return left_[point] > 0; }
  void fire(std::uint32_t point) {
    if (--left_[point] == 0) close(point);
  }
  /// First open point at or after `from`; the number of points if there is none.
  std::uint32_t first_from(std::uint32_t from) {
    while (next_[from] != from) {
      next_[from] = next_[next_[from]];  // halves the path for the next time
      from = next_[from];
    }
    return from;
  }
  std::uint32_t end() const { return static_cast<std::uint32_t>(left_.size()); }

 private:
  void close(std::uint32_t point) { next_[point] = point + 1; }
  std::vector<std::uint16_t> left_;
  std::vector<std::uint32_t> next_;  ///< its own index while open; one more for the end
};

class Matcher {
 public:
  explicit Matcher(const JobRun& run)
      : run_(run),
        wanted_(all_wanted(run)),
        reach_(reach_steps(run)),
        index_(wanted_, reach_),
        open_(run.points.size(), run.shots_ordered) {}

  Matching match() {
    Matching result;
    for (std::size_t i = 0; i < run_.shots.size(); ++i) {
      const StepPosition& steps =
          run_.lattice_steps.empty() ? run_.shots[i].steps : run_.lattice_steps[i];
      const std::uint32_t point = wanted_.empty() ? no_point : point_at(steps);
      result.point_of_shot.push_back(point);
      if (point == no_point || !open_.open(point)) {
        ++result.doubled;
        continue;
      }
      open_.fire(point);
      expected_ = point;
    }
    for (std::uint32_t i = 0; i < open_.end(); ++i)
      if (open_.open(i)) ++result.missed;
    return result;
  }

 private:
  static std::vector<WantedSteps> all_wanted(const JobRun& run) {
    std::vector<WantedSteps> wanted(run.points.size());
    std::transform(run.points.begin(), run.points.end(), wanted.begin(),
                   [&run](const geometry::Point& p) {
                     return wanted_steps(run.refraction.stage(p), run.steps_per_mm);
                   });
    return wanted;
  }

  /// Shot tolerance in steps (0 in the settings: the larger of half a step and 5 um) plus half a
  /// step of rounding at each end.
  static double reach_steps(const JobRun& run) {
    constexpr double mm_per_um = 1e-3, min_um = 5;
    const double set_um = in_units(run.settings, settings::Id::shot_tolerance);
    const double tolerance_mm = (set_um > 0 ? set_um : min_um) * mm_per_um;
    double reach = 0.5;
    for (std::size_t axis = 0; axis < point_axes; ++axis)
      reach = std::max(reach, tolerance_mm * run.steps_per_mm[axis]);
    return reach + 1;
  }

  std::uint32_t point_at(const StepPosition& steps) {
    const std::uint32_t next = open_.first_from(expected_);
    if (next != open_.end() && error_steps(steps, wanted_[next]) <= reach_) return next;
    const std::uint32_t there = nearest_within_reach(steps);
    if (there != no_point) return there;
    const std::uint32_t near = nearest_in_window(steps, next);
    return near != no_point ? near : nearest_of_all(steps);
  }

  /// Prefers open points, then the nearest, then the earliest.
  std::uint32_t nearest_within_reach(const StepPosition& steps) const {
    const WantedSteps at{static_cast<double>(steps[0]), static_cast<double>(steps[1]),
                         static_cast<double>(steps[2])};
    std::uint32_t best = no_point;
    bool best_open = false;
    double best_error = 0;
    index_.around(at, [&](std::uint32_t point) {
      const double error = error_steps(steps, wanted_[point]);
      if (error > reach_) return;
      const bool is_open = open_.open(point);
      const bool better = is_open != best_open  ? is_open
                          : error != best_error ? error < best_error
                                                : point < best;
      if (best != no_point && !better) return;
      best = point;
      best_open = is_open;
      best_error = error;
    });
    return best;
  }

  /// Nearest of the next open points, counted from the expected one and from the earliest.
  std::uint32_t nearest_in_window(const StepPosition& steps, std::uint32_t next) {
    std::uint32_t best = no_point;
    double best_error = std::numeric_limits<double>::infinity();
    for (std::uint32_t start : {next, open_.first_from(0)}) {
      std::uint32_t point = start;
      for (std::uint32_t n = 0; n < window && point != open_.end(); ++n) {
        const double error = error_steps(steps, wanted_[point]);
        if (error < best_error) {
          best = point;
          best_error = error;
        }
        point = open_.first_from(point + 1);
      }
    }
    return best;
  }

  /// Used when every point has been fired: the shot is surplus, so the order does not matter.
  std::uint32_t nearest_of_all(const StepPosition& steps) const {
    const auto nearest = std::min_element(wanted_.begin(), wanted_.end(),
                                          [&](const WantedSteps& a, const WantedSteps& b) {
                                            return error_steps(steps, a) < error_steps(steps, b);
                                          });
    return static_cast<std::uint32_t>(nearest - wanted_.begin());
  }

  const JobRun& run_;
  std::vector<WantedSteps> wanted_;
  double reach_;
  CellIndex index_;
  OpenPoints open_;
  std::uint32_t expected_ = 0;
};

}  // namespace

WantedSteps wanted_steps(const geometry::Point& point, const PerAxis<double>& steps_per_mm) {
  return {point.x * steps_per_mm[0], point.y * steps_per_mm[1], point.z * steps_per_mm[2]};
}

double error_steps(const StepPosition& steps, const WantedSteps& wanted) {
  double error = 0;
  for (std::size_t axis = 0; axis < point_axes; ++axis)
    error = std::max(error, std::abs(steps[axis] - wanted[axis]));
  return error;
}

Matching match_shots(const JobRun& run) { return Matcher(run).match(); }

}  // namespace lamplock::report
