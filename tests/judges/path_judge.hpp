// Judges of the path: the places that a board's drives passed, step by step, against wanted paths.
//
// In:  STEP and DIR of X Y Z, from the bus; the pieces of a golden run (golden_case.hpp), or a path
//      of straight pieces in steps with fractions and the permitted deviation of an axis.
// Out: places in steps with their times; deviations, as text.
//
// WayFollower checks each piece with its end. StaircaseFollower checks that the places are a
// staircase along the path: at every pulse each axis is near the ideal place at one parameter of
// the path, and the parameter never decreases. It searches for the parameter, so it is independent
// of speeds.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/virtual_board/virtual_board.hpp"
#include "tests/board/golden_case.hpp"

namespace lamplock::test {

using StepPoint = std::array<double, 3>;

struct PassedPlace {
  sim::Picoseconds at = 0;
  StepPoint steps{};  ///< multiples of 1/2 where two motors move an axis
};

/// Records from construction; the board must not run after its destruction.
class StepRecord final : private sim::PinListener {
 public:
  explicit StepRecord(sim::VirtualBoard& board)
      : core_xy_(board.controller().runner().generator().kinematics().core_xy()) {
    for (int axis = 0; axis < 3; ++axis) {
      board.bus().listen(sim::step_pin(axis), *this);
      board.bus().listen(sim::dir_pin(axis), *this);
    }
  }
  StepRecord(const StepRecord&) = delete;
  StepRecord& operator=(const StepRecord&) = delete;

  /// All places, beginning with that at construction.
  std::vector<PassedPlace> places() const {
    std::vector<Edge> edges = edges_;
    std::stable_sort(edges.begin(), edges.end(),
                     [](const Edge& a, const Edge& b) { return a.at < b.at; });
    std::vector<PassedPlace> places(1);
    for (const Edge& edge : edges) {
      // Edges at the same time are one place.
      if (places.size() == 1 || places.back().at != edge.at) places.push_back(places.back());
      places.back().at = edge.at;
      move(places.back(), edge);
    }
    return places;
  }

 private:
  struct Edge {
    sim::Picoseconds at;
    std::size_t axis;
    int direction;
  };
  void pin_changed(sim::Pin pin, bool level, sim::Picoseconds at) override {
    const auto line = static_cast<std::size_t>(pin);
    if (line % 2 != 0)
      direction_[line / 2] = level ? -1 : 1;
    else if (level)
      edges_.push_back({at, line / 2, direction_[line / 2]});
  }
  /// In a CoreXY both motors turn for either axis.
  void move(PassedPlace& place, const Edge& edge) const {
    if (!core_xy_ || edge.axis > 1) {
      place.steps[edge.axis] += edge.direction;
      return;
    }
    place.steps[0] += edge.direction * 0.5;
    place.steps[1] += edge.axis == 0 ? edge.direction * 0.5 : edge.direction * -0.5;
  }

  bool core_xy_;
  std::vector<Edge> edges_;
  std::array<int, 3> direction_{1, 1, 1};
};

/// Compares the paths of a case with the places passed.
class WayFollower {
 public:
  static constexpr double steps_per_mm = 200;
  static constexpr double line_tolerance = 1.01, arc_tolerance = 2;  ///< steps
  /// Part of an arc's sweep that may be missing where its end is searched, radians.
  static constexpr double sweep_tolerance = 0.1;

  explicit WayFollower(const std::vector<PassedPlace>& places) : places_(places) {}

  /// Follows the next path; returns the deviation, or an empty text.
  std::string follow(const GoldenWay& way) {
    first_ = at_;
    MmPoint to{};
    for (std::size_t a = 0; a < 3; ++a) to[a] = way.to[a] * steps_per_mm;
    std::string wrong = way.kind == GoldenWay::Kind::line ? line(to)
                        : way.kind == GoldenWay::Kind::arc
                            ? arc(way, to)
                            : pass(to, way.kind == GoldenWay::Kind::end);
    from_ = to;
    return wrong;
  }
  /// The first and last place of the last path.
  std::size_t first() const { return first_; }
  std::size_t last() const { return at_; }
  bool at_end() const { return at_ + 1 == places_.size(); }

  std::string text_of(std::size_t i) const {
    std::string text = fmt::format("place {} of {}:", i, places_.size());
    for (const double s : places_[i].steps) text += fmt::format(" {}", s / steps_per_mm);
    return text;
  }

 private:
  double away(std::size_t i, const MmPoint& p) const {
    double most = 0;
    for (std::size_t a = 0; a < 3; ++a)
      most = std::max(most, std::fabs(places_[i].steps[a] - p[a]));
    return most;
  }
  bool is_at(std::size_t i, const MmPoint& p) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (places_[i].steps[a] != static_cast<double>(std::lround(p[a]))) return false;
    return true;
  }

  std::string line(const MmPoint& to) {
    MmPoint way{};
    double length_2 = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      way[a] = to[a] - from_[a];
      length_2 += way[a] * way[a];
    }
    double furthest = 0;
    for (; at_ < places_.size(); ++at_) {
      double dot = 0, off_2 = 0;
      for (std::size_t a = 0; a < 3; ++a) dot += (places_[at_].steps[a] - from_[a]) * way[a];
      const double part = length_2 > 0 ? dot / length_2 : 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const double off = places_[at_].steps[a] - from_[a] - part * way[a];
        off_2 += off * off;
      }
      if (std::sqrt(off_2) > line_tolerance) return "beside the line at " + text_of(at_);
      const double along = part * std::sqrt(length_2);
      if (along < furthest - line_tolerance) return "backwards at " + text_of(at_);
      furthest = std::max(furthest, along);
      if (is_at(at_, to)) return "";
    }
    return end("a line's end was not met");
  }

  std::string arc(const GoldenWay& way, const MmPoint& to) {
    const std::size_t u = way.plane[0], v = way.plane[1], w = 3 - u - v;
    const double cu = way.centre[0] * steps_per_mm, cv = way.centre[1] * steps_per_mm;
    const double radius = std::hypot(from_[u] - cu, from_[v] - cv);
    double last = std::atan2(from_[v] - cv, from_[u] - cu);
    double wanted = way.sense * (std::atan2(to[v] - cv, to[u] - cu) - last);
    while (wanted <= 1e-6) wanted += 2 * std::numbers::pi;
    while (wanted > 2 * std::numbers::pi + 1e-6) wanted -= 2 * std::numbers::pi;
    wanted += 2 * std::numbers::pi * (way.turns - 1);
    double swept = 0, furthest = 0;
    for (; at_ < places_.size(); ++at_) {
      const auto& here = places_[at_].steps;
      if (std::fabs(std::hypot(here[u] - cu, here[v] - cv) - radius) > arc_tolerance)
        return "beside the circle at " + text_of(at_);
      const double angle = std::atan2(here[v] - cv, here[u] - cu);
      swept += way.sense * std::remainder(angle - last, 2 * std::numbers::pi);
      last = angle;
      if ((furthest - swept) * radius > arc_tolerance) return "turned at " + text_of(at_);
      furthest = std::max(furthest, swept);
      const double height = from_[w] + (to[w] - from_[w]) * swept / wanted;
      if (std::fabs(here[w] - height) > arc_tolerance) return "height at " + text_of(at_);
      if (swept > wanted - sweep_tolerance && is_at(at_, to)) return "";
    }
    return end("an arc's end was not met");
  }

  std::string pass(const MmPoint& to, bool exactly) {
    for (; at_ < places_.size(); ++at_)
      if (exactly ? is_at(at_, to) : away(at_, to) <= 1) return "";
    return end("a place was not passed");
  }

  std::string end(const std::string& what) {
    at_ = places_.size() - 1;
    return what + "; at the end " + text_of(at_);
  }

  const std::vector<PassedPlace>& places_;
  MmPoint from_{};
  std::size_t first_ = 0, at_ = 0;
};

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
      follow(places[i == 0 ? 0 : i - 1].steps, places[i].steps);
      if (reached_.empty())
        return fmt::format("place {} of {}, ({}), is beside the path at its piece {} of {}", i,
                           places.size(), fmt::join(places[i].steps, " "), piece + 1,
                           path_.size() - 1);
    }
    for (std::size_t a = 0; a < 3; ++a)
      if (places.back().steps[a] != std::round(path_.back()[a]))
        return fmt::format("axis {} is at {}, not at {}", a, places.back().steps[a],
                           path_.back()[a]);
    follow(places.back().steps, places.back().steps);
    const bool ends = !reached_.empty() && reached_.back().piece + 2 == path_.size() &&
                      reached_.back().to >= 1 - rounding;
    return ends ? "" : "the end of the path was not met";
  }

 private:
  struct Stretch {
    std::size_t piece;
    double from, to;
  };

  /// The stretch of a piece on which all axes are near a place; empty if it ends before it begins.
  Stretch near(std::size_t piece, const StepPoint& place) const {
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
  void follow(const StepPoint& from, const StepPoint& to) {
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
