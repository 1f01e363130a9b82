// The exact optimum of free planning in double precision: what the fixed-point planner is graded
// by.
//
// A label is (beats so far, box of speed intervals). Axes couple only through the common beats, so
// propagating intervals is exact; a label is dropped only if another has no more beats and contains
// its box, or if it cannot beat start-stop any more. No beam, no guide, no look at the work space.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lamplock::test {

/// Interval of speeds of one axis, acceleration limit 1, time in beats.
struct RealInterval {
  double lo = 0, hi = 0;
};

/// Speeds at the end over displacement q in time t, |v| <= limit; false if there are none.
inline bool real_reach(const RealInterval& from, double q, double t, double limit,
                       RealInterval& to) {
  if (std::fabs(q) > limit * t) return false;
  const auto least = [&](double d) {
    const double v = d / t - t / 2;
    return v + t <= limit ? v : limit - std::sqrt(2 * std::max(0.0, limit * t - d));
  };
  const auto largest = [&](double v, double d) {
    const double u = -t + std::sqrt(std::max(0.0, 2 * t * t + 4 * (d - v * t)));
    if (v - (t - u) / 2 >= -limit) return std::min(limit, v + u);
    return std::min(
        limit, -limit + std::sqrt(std::max(0.0, 2 * (d + limit * t) - (v + limit) * (v + limit))));
  };
  const double lo = std::max(from.lo, least(q)), hi = std::min(from.hi, -least(-q));
  if (lo > hi) return false;
  to = {-largest(-hi, -q), largest(lo, q)};
  return to.lo <= to.hi;
}

/// A sequence to plan, rest to rest: displacements in units of A beat^2, limits in units of A beat.
struct ReferenceProblem {
  std::size_t axes = 1;
  std::vector<std::array<double, 4>> way;
  std::array<double, 4> limit{};
};

/// Plans one sequence at a time.
class ReferencePlanner {
 public:
  /// Fewest beats in total.
  static int fewest_beats(const ReferenceProblem& problem) {
    const std::size_t n = problem.way.size();
    // Rest at every point: an upper bound for the whole and for what is left at every point.
    std::vector<int> start_stop(n), left(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) start_stop[i] = rest_to_rest(problem, i);
    for (std::size_t i = n; i-- > 0;) left[i] = left[i + 1] + start_stop[i];
    int best = left[0];
    std::vector<Label> labels(1);
    for (std::size_t i = 0; i < n; ++i) {
      const bool last = i + 1 == n;
      const int points_behind = static_cast<int>(n - i - 1);
      std::vector<Label> next;
      for (const Label& from : labels) {
        for (int k = 1; from.beats + k + points_behind <= best; ++k) {
          Label to;
          if (!extend(problem, i, from, k, to)) continue;
          if (contains_rest(problem, to)) {
            best = std::min(best, to.beats + left[i + 1]);
            if (last) break;
          }
          if (!last) add(problem, next, to);
        }
      }
      labels = std::move(next);
    }
    return best;
  }

  /// The same by trying every combination of beats up to `most` a segment.
  static int by_brute_force(const ReferenceProblem& problem, int most) {
    int best = 1 << 20;
    try_all(problem, 0, Label{}, most, best);
    return best;
  }

  /// Beats from rest to rest over one displacement.
  static int rest_to_rest(const ReferenceProblem& problem, std::size_t i) {
    for (int k = 1;; ++k) {
      Label to;
      if (extend(problem, i, Label{}, k, to) && contains_rest(problem, to)) return k;
    }
  }

 private:
  struct Label {
    int beats = 0;
    std::array<RealInterval, 4> box{};
  };

  static bool extend(const ReferenceProblem& problem, std::size_t i, const Label& from, int k,
                     Label& to) {
    for (std::size_t a = 0; a < problem.axes; ++a)
      if (!real_reach(from.box[a], problem.way[i][a], k, problem.limit[a], to.box[a])) return false;
    to.beats = from.beats + k;
    return true;
  }

  static bool contains_rest(const ReferenceProblem& problem, const Label& label) {
    for (std::size_t a = 0; a < problem.axes; ++a)
      if (label.box[a].lo > 0 || label.box[a].hi < 0) return false;
    return true;
  }

  static bool dominates(const ReferenceProblem& problem, const Label& a, const Label& b) {
    if (a.beats > b.beats) return false;
    for (std::size_t i = 0; i < problem.axes; ++i)
      if (a.box[i].lo > b.box[i].lo || a.box[i].hi < b.box[i].hi) return false;
    return true;
  }

  static void add(const ReferenceProblem& problem, std::vector<Label>& labels, const Label& label) {
    for (const Label& other : labels)
      if (dominates(problem, other, label)) return;
    std::erase_if(labels, [&](const Label& other) { return dominates(problem, label, other); });
    labels.push_back(label);
  }

  static void try_all(const ReferenceProblem& problem, std::size_t i, const Label& from, int most,
                      int& best) {
    if (i == problem.way.size()) {
      if (contains_rest(problem, from)) best = std::min(best, from.beats);
      return;
    }
    for (int k = 1; k <= most; ++k) {
      Label to;
      if (extend(problem, i, from, k, to)) try_all(problem, i + 1, to, most, best);
    }
  }
};

}  // namespace lamplock::test
