// The places that a board's drives passed, step by step, and a check against wanted paths.
//
// In:  STEP and DIR of X Y Z, from the bus; paths (golden_case.hpp).
// Out: places in steps with their times; deviations, as text.
// Used by tests of programs. Depends on pins only, not on the firmware.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/virtual_board/virtual_board.hpp"
#include "tests/board/golden_case.hpp"

namespace lamplock::test {

struct PassedPlace {
  sim::Picoseconds at = 0;
  std::array<double, 3> steps{};  ///< multiples of 1/2 where two motors move an axis
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

}  // namespace lamplock::test
