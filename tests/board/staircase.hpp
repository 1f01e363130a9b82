// Checks that the places passed are a staircase along a path: at every pulse each axis is near the
// ideal place at one parameter of the path, and the parameter never decreases.
//
// In:  places (step_path.hpp), a path of straight pieces in steps with fractions, the permitted
//      deviation of an axis. Out: deviations, as text.
// Used by tests of programs. The check searches for a parameter, so it is independent of speeds.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/board/step_path.hpp"

namespace lamplock::test {

using StepPoint = std::array<double, 3>;

/// A path as programmed, in steps: exact ends, arcs as dense chords.
class IdealPath {
 public:
  explicit IdealPath(const StepPoint& steps_per_mm) : steps_per_mm_(steps_per_mm), points_(1) {}

  void line(const MmPoint& to_mm) {
    at_mm_ = to_mm;
    StepPoint p{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = to_mm[a] * steps_per_mm_[a];
    points_.push_back(p);
  }
  /// An arc in X and Y about a centre, with this sweep (positive: counterclockwise).
  void arc(const MmPoint& to_mm, const MmPoint& centre_mm, double sweep) {
    const MmPoint from = at_mm_;
    const double radius = std::hypot(from[0] - centre_mm[0], from[1] - centre_mm[1]);
    const double start = std::atan2(from[1] - centre_mm[1], from[0] - centre_mm[0]);
    constexpr double chord_mm = 0.002;
    const int chords = static_cast<int>(std::ceil(std::abs(sweep) * radius / chord_mm));
    for (int i = 1; i < chords; ++i) {
      const double t = static_cast<double>(i) / chords, angle = start + sweep * t;
      line({centre_mm[0] + radius * std::cos(angle), centre_mm[1] + radius * std::sin(angle),
            from[2] + (to_mm[2] - from[2]) * t});
    }
    line(to_mm);
  }
  const std::vector<StepPoint>& points() const { return points_; }
  const MmPoint& at_mm() const { return at_mm_; }

 private:
  StepPoint steps_per_mm_;
  MmPoint at_mm_{};
  std::vector<StepPoint> points_;
};

/// Follows a path from its beginning. A path may return to a place, so the possible positions on
/// the path are a set: one stretch per piece.
class StaircaseFollower {
 public:
  StaircaseFollower(const IdealPath& path, const StepPoint& bound)
      : path_(path.points()), bound_(bound) {}

  /// Returns the deviation, or an empty text.
  std::string follow(const std::vector<PassedPlace>& places) {
    reached_ = {{0, 0, 0}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::size_t piece = reached_.front().piece;
      go_on(places[i == 0 ? 0 : i - 1].steps, places[i].steps);
      if (reached_.empty())
        return fmt::format("place {} of {}, ({}), is beside the path at its piece {} of {}", i,
                           places.size(), fmt::join(places[i].steps, " "), piece + 1,
                           path_.size() - 1);
    }
    for (std::size_t a = 0; a < 3; ++a)
      if (places.back().steps[a] != std::round(path_.back()[a]))
        return fmt::format("axis {} is at {}, not at {}", a, places.back().steps[a],
                           path_.back()[a]);
    go_on(places.back().steps, places.back().steps);
    const bool ends = !reached_.empty() && reached_.back().piece + 2 == path_.size() &&
                      reached_.back().to >= 1 - rounding;
    return ends ? "" : "the end of the path was not met";
  }

 private:
  using Steps = std::array<double, 3>;
  struct Stretch {
    std::size_t piece;
    double from, to;
  };

  /// The stretch of a piece on which all axes are near a place; empty if it ends before it begins.
  Stretch near(std::size_t piece, const Steps& place) const {
    Stretch stretch{piece, 0, 1};
    for (std::size_t a = 0; a < 3; ++a) {
      const double p = path_[piece][a], way = path_[piece + 1][a] - p;
      const double low = place[a] - bound_[a] - p, high = place[a] + bound_[a] - p;
      if (way == 0) {
        if (low > 0 || high < 0) return {piece, 1, 0};
        continue;
      }
      stretch.from = std::max(stretch.from, std::min(low / way, high / way));
      stretch.to = std::min(stretch.to, std::max(low / way, high / way));
    }
    return stretch;
  }
  /// Follows the path as far as it is near `from`, and from there as far as it is near `to`.
  void go_on(const Steps& from, const Steps& to) {
    std::vector<Stretch> next;
    std::size_t known = 0;
    bool comes = false;  // reached from the piece before
    for (std::size_t piece = reached_.front().piece; piece + 1 < path_.size(); ++piece) {
      const bool has = known < reached_.size() && reached_[known].piece == piece;
      if (!has && !comes && known == reached_.size()) break;
      const Stretch here = near(piece, from);
      comes = comes && here.from <= rounding;
      const double first = comes ? 0 : has ? reached_[known].from : 1 + 2 * rounding;
      if (has) ++known;
      const Stretch there = near(piece, to);
      const Stretch both{piece, std::max(first, there.from), std::min(here.to, there.to)};
      if (both.from <= both.to + rounding) next.push_back(both);
      comes = first <= 1 && here.to >= 1 - rounding;
    }
    reached_ = next;
  }

  static constexpr double rounding = 1e-9;
  const std::vector<StepPoint>& path_;
  StepPoint bound_;
  std::vector<Stretch> reached_;
};

}  // namespace lamplock::test
