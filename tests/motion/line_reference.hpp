// Minimum time of lines in double precision: look-ahead over the whole path in two passes,
// trapezoids in closed form, no rounding. The rules for corners (line/geometry.hpp,
// line/chords.hpp) are computed independently from the settings.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/motion/line_machine.hpp"

namespace lamplock::test {

class LineReference {
 public:
  LineReference(const LineMachine& machine, const std::vector<LineTarget>& targets,
                bool chords = true)
      : m_(machine) {
    LineVector at{};
    bool stop = true;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const LineTarget& target = targets[i];
      Path line;
      line.target = static_cast<std::uint32_t>(i);
      for (std::size_t a = 0; a < axes(); ++a) line.end[a] = steps_at(target, a) / m_.steps_mm[a];
      for (std::size_t a = 0; a < axes(); ++a) line.way[a] = line.end[a] - at[a];
      line.length = norm(line.way);
      if (line.length == 0) {
        stop = stop || target.exact_stop;
        continue;
      }
      line.start = at;
      line.speed = line.accel = 1e300;
      for (std::size_t a = 0; a < axes(); ++a) {
        const double cosine = std::fabs(line.way[a]) / line.length;
        if (cosine == 0) continue;
        line.speed = std::min(line.speed, m_.speed_mm_s[a] / cosine);
        line.accel = std::min(line.accel, m_.accel_mm_s2[a] / cosine);
      }
      if (!target.rapid)
        line.speed = std::min(line.speed, target.timed ? line.length * 1e6 / target.time_us
                                                       : target.feed_um_min / 60e3);
      if (!lines_.empty() && !stop) {
        const double v = std::min({lines_.back().speed, line.speed});
        line.entry_2 = std::min(v * v, turn_2(lines_.back().way, line.way, true));
        line.clear = is_clear(lines_.back().way, line.way);
      }
      lines_.push_back(line);
      stop = target.exact_stop;
      at = line.end;
    }
    if (chords) cap(12);
    if (chords) cap(128);
    if (chords) cap(512, 0.7);
    look_ahead();
  }

  double seconds() const {
    double all = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i)
      all += seconds(lines_[i], i + 1 < lines_.size() ? lines_[i + 1].entry_2 : 0);
    return all;
  }
  std::size_t lines() const { return lines_.size(); }
  /// Speed at the end of the line to a target.
  double end_mm_s(std::uint32_t target) const {
    for (std::size_t i = 0; i + 1 < lines_.size(); ++i)
      if (lines_[i].target == target) return std::sqrt(lines_[i + 1].entry_2);
    return 0;
  }

 private:
  struct Path {
    LineVector start{}, end{}, way{};
    std::uint32_t target = 0;
    double length = 0, speed = 0, accel = 0, entry_2 = 0;
    bool clear = false;  ///< the corner at its start
  };

  std::size_t axes() const { return static_cast<std::size_t>(m_.axes); }
  static double norm(const LineVector& v) {
    double squares = 0;
    for (const double x : v) squares += x * x;
    return std::sqrt(squares);
  }

  /// Minimum length that gives a direction: 1/16 step and 1/1000 inch, a step at most.
  double rounding_mm(std::size_t a) const {
    return std::min(1 / m_.steps_mm[a], 1 / m_.steps_mm[a] / 16 + 0.0254);
  }

  /// A change of direction, beyond rounding; `back`: it reverses.
  struct Change {
    LineVector axis{};
    double squares = 0;
    bool back = false;
  };
  Change change_of(const LineVector& from, const LineVector& to) const {
    const double l0 = norm(from), l1 = norm(to);
    double dot = 0;
    for (std::size_t a = 0; a < axes(); ++a) dot += from[a] * to[a] / l0 / l1;
    const bool sharp = dot < -6.2e-8;
    Change change;
    change.back = sharp;
    for (std::size_t a = 0; a < axes(); ++a) {
      const double u = from[a] / l0, v = to[a] / l1;
      const double noise = 1.5e-8, rounding = (1 / l0 + 1 / l1) * rounding_mm(a) + noise;
      if (std::fabs(u + v) > rounding) change.back = false;
      const double all = std::fabs(v - u);
      if (all <= (sharp ? noise : rounding)) continue;
      change.axis[a] = all - (sharp ? 0 : rounding);
      change.squares += change.axis[a] * change.axis[a];
    }
    return change;
  }

  /// A corner of more than 10 degrees and 3 roundings, or a reversal: no bend of a curve.
  bool is_clear(const LineVector& from, const LineVector& to) const {
    const double l0 = norm(from), l1 = norm(to);
    double coarsest = 0;
    for (std::size_t a = 0; a < axes(); ++a) coarsest = std::max(coarsest, rounding_mm(a));
    const Change change = change_of(from, to);
    const double least = 3 * coarsest * (1 / l0 + 1 / l1);
    return change.back || (change.squares >= 0.03 && change.squares > least * least);
  }

  /// Highest squared speed of a change of direction: a corner, or the bend of two chords.
  double turn_2(const LineVector& from, const LineVector& to, bool corner,
                double gentle = 10) const {
    const double l0 = norm(from), l1 = norm(to);
    const auto [change, squares, back] = change_of(from, to);
    if (back && corner) return 0;
    if (squares == 0 || squares > gentle * gentle) return 1e300;
    const double chord = std::sqrt(squares), sine = std::min(1.0, chord / 2);
    const double cosine = std::sqrt(1 - sine * sine);
    double radius = std::min(l0, l1) / 2 * cosine / sine, accel = 1e300, jump = 1e300;
    if (corner) radius = std::min(radius, m_.deviation_mm * cosine * (1 + cosine) / (sine * sine));
    for (std::size_t a = 0; a < axes(); ++a) {
      if (change[a] == 0) continue;
      accel = std::min(accel, m_.accel_mm_s2[a] * chord / change[a]);
      jump = std::min(jump, m_.jump_mm_s[a] / change[a]);
    }
    return std::max(radius * accel, jump * jump);
  }

  /// Limits chords of this many roundings of the coarsest axis, for turns up to `gentle`.
  void cap(double roundings, double gentle = 10) {
    double window = 0;
    for (std::size_t a = 0; a < axes(); ++a) window = std::max(window, roundings * rounding_mm(a));
    std::size_t first = 0, before_first = 0, before_lines = 0;
    LineVector mark{}, before{};
    if (!lines_.empty()) mark = lines_[0].start;
    double way = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].clear) {
        first = i;
        mark = lines_[i].start;
        before = {};
        way = 0;
      }
      way += lines_[i].length;
      if (way < window * (1 - 1e-9)) continue;
      // A line that is long enough is a chord by itself.
      const bool skips = first != i && lines_[i].length >= window * (1 - 1e-9);
      if (skips) {
        first = i;
        mark = lines_[i].start;
      }
      LineVector chord{};
      for (std::size_t a = 0; a < axes(); ++a) chord[a] = lines_[i].end[a] - mark[a];
      const std::size_t count = i + 1 - first;
      if (norm(before) != 0 && norm(chord) != 0 && (skips || count + before_lines > 2)) {
        const double v_2 = turn_2(before, chord, false, gentle);
        for (std::size_t k = before_first + 1; k <= i; ++k)
          lines_[k].entry_2 = std::min(lines_[k].entry_2, v_2);
      }
      before = chord;
      before_first = first;
      before_lines = count;
      first = i + 1;
      mark = lines_[i].end;
      way = 0;
    }
  }

  void look_ahead() {
    double exit_2 = 0;
    for (std::size_t i = lines_.size(); i-- > 0;) {
      Path& line = lines_[i];
      line.entry_2 = std::min(line.entry_2, exit_2 + 2 * line.accel * line.length);
      exit_2 = line.entry_2;
    }
    for (std::size_t i = 0; i + 1 < lines_.size(); ++i)
      lines_[i + 1].entry_2 = std::min(lines_[i + 1].entry_2,
                                       lines_[i].entry_2 + 2 * lines_[i].accel * lines_[i].length);
  }

  static double seconds(const Path& line, double exit_2) {
    const double peak_2 = (line.entry_2 + exit_2) / 2 + line.accel * line.length;
    const double v0 = std::sqrt(line.entry_2), v1 = std::sqrt(exit_2);
    const double v = std::min(std::sqrt(peak_2), line.speed);
    const double ramps = (2 * v * v - line.entry_2 - exit_2) / (2 * line.accel);
    return (2 * v - v0 - v1) / line.accel + std::max(0.0, line.length - ramps) / v;
  }

  LineMachine m_;
  std::vector<Path> lines_;
};

}  // namespace lamplock::test
