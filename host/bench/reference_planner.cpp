#include "host/bench/reference_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamplock::bench {
namespace {

/// Longer sequences are searched as streams, because errors of lower bounds add up.
constexpr std::size_t max_sequence_size = 40;
/// Labels kept by the search for an upper bound.
constexpr std::size_t beam_width = 8;
/// Hulls over a whole sequence for a first lower bound.
constexpr int coarse_hulls = 64;
/// Points between two reports.
constexpr std::size_t report_every = 64;

struct Label {
  int beats = 0;
  SpeedBox box{};
};

/// Minimum start speed for the displacement in time, with constant acceleration.
double min_start(double way, double beats, double limit) {
  const double v = way / beats - beats / 2;
  return v + beats <= limit ? v : limit - std::sqrt(2 * std::max(0.0, limit * beats - way));
}

/// Maximum end speed from start speed `v`.
double max_end(double v, double way, double beats, double limit) {
  const double u = -beats + std::sqrt(std::max(0.0, 2 * beats * beats + 4 * (way - v * beats)));
  if (v - (beats - u) / 2 >= -limit) return std::min(limit, v + u);
  const double square = 2 * (way + limit * beats) - (v + limit) * (v + limit);
  return std::min(limit, -limit + std::sqrt(std::max(0.0, square)));
}

bool covers(std::size_t axes, const SpeedBox& outer, const SpeedBox& inner) {
  for (std::size_t a = 0; a < axes; ++a)
    if (outer[a].lo > inner[a].lo || outer[a].hi < inner[a].hi) return false;
  return true;
}

bool contains_rest(std::size_t axes, const SpeedBox& box) { return covers(axes, box, SpeedBox{}); }

bool extend(const ReferenceProblem& problem, std::size_t i, const SpeedBox& from, int beats,
            SpeedBox& to) {
  for (std::size_t a = 0; a < problem.axes; ++a)
    if (!reach(from[a], problem.way[i][a], beats, problem.limit[a], to[a])) return false;
  return true;
}

/// Lower bound of beats, at full speed.
int min_beats(const ReferenceProblem& problem, std::size_t i) {
  double least = 1;
  for (std::size_t a = 0; a < problem.axes; ++a)
    least = std::max(least, std::ceil(std::fabs(problem.way[i][a]) / problem.limit[a]));
  return static_cast<int>(least);
}

/// Labels of one point, by ascending beats; none dominates another.
class Labels {
 public:
  explicit Labels(std::size_t axes) : axes_(axes) {}

  const std::vector<Label>& all() const { return labels_; }
  void clear() { labels_.clear(); }

  /// True if the box is contained in one with no more beats. Later ones are larger and are tried
  /// first.
  bool dominated(const SpeedBox& box) const {
    return std::any_of(labels_.rbegin(), labels_.rend(),
                       [&](const Label& other) { return covers(axes_, other.box, box); });
  }

  /// Adds a label with at least as many beats as every other, unless it is dominated.
  void add(const Label& label) {
    if (dominated(label.box)) return;
    while (!labels_.empty() && labels_.back().beats == label.beats &&
           covers(axes_, label.box, labels_.back().box))
      labels_.pop_back();
    labels_.push_back(label);
  }

 private:
  std::size_t axes_;
  std::vector<Label> labels_;
};

/// The first label that contains rest, looped back to its point after 1, 2, ... beats.
class Loops {
 public:
  explicit Loops(const ReferenceProblem& problem) : problem_(problem) {}

  bool started() const { return started_; }
  /// True if the label, looped for all beats since then, contains every speed.
  bool everything() const { return everything_; }
  const SpeedBox& box() const { return box_; }

  void start(const Label& rest) {
    first_ = rest;
    box_ = rest.box;
    started_ = true;
  }

  /// Loops until `beats` in total. Waiting at rest is a loop, so boxes only grow.
  void extend(int beats) {
    if (!started_ || beats == first_.beats) return;
    everything_ = true;
    for (std::size_t a = 0; a < problem_.axes; ++a) {
      const double limit = problem_.limit[a];
      reach(first_.box[a], 0, beats - first_.beats, limit, box_[a]);
      everything_ = everything_ && box_[a].lo <= -limit && box_[a].hi >= limit;
    }
  }

 private:
  const ReferenceProblem& problem_;
  Label first_;
  SpeedBox box_{};
  bool started_ = false, everything_ = false;
};

/// Per point and number of remaining beats: the hull of speeds from which they may be enough.
class BeatsLeft {
 public:
  /// For totals up to `most`; `earliest` is a lower bound of the beats to each point. Hulls are
  /// computed for every `spacing`th number of beats; the next one contains those before it and is
  /// used for them.
  BeatsLeft(const ReferenceProblem& problem, int most, const std::vector<int>& earliest,
            int spacing);

  /// Lower bound of the beats from point i to the end, for any speed; more than `most` if too many.
  int least(std::size_t i) const { return points_[i].least; }

  /// Cuts a box at point i to the speeds for which `left` beats may be enough; false if it is
  /// empty.
  bool cut(std::size_t i, int left, SpeedBox& box) const {
    const Point& point = points_[i];
    if (left < point.least) return false;
    const SpeedBox& hull = point.at(left, spacing_);
    for (std::size_t a = 0; a < axes_; ++a) {
      box[a] = {std::max(box[a].lo, hull[a].lo), std::min(box[a].hi, hull[a].hi)};
      if (box[a].lo > box[a].hi) return false;
    }
    return true;
  }

 private:
  struct Point {
    int least = 0, first = 0;    ///< lower bound; beats of the first hull
    std::vector<SpeedBox> hull;  ///< each contains those before it; none if not within `most`

    const SpeedBox& at(int left, int spacing) const {
      const int later = left <= first ? 0 : (left - first + spacing - 1) / spacing;
      return hull[std::min(static_cast<std::size_t>(later), hull.size() - 1)];
    }
  };
  void fill(const ReferenceProblem& problem, std::size_t i, int last);
  bool hull(const ReferenceProblem& problem, std::size_t i, int beats, SpeedBox& out) const;

  std::size_t axes_;
  int spacing_;
  std::vector<Point> points_;
};

void include(std::size_t axes, const SpeedBox& more, SpeedBox& box) {
  for (std::size_t a = 0; a < axes; ++a)
    box[a] = {std::min(box[a].lo, more[a].lo), std::max(box[a].hi, more[a].hi)};
}

/// Widens a hull, so that rounding does not make it too narrow if there is only one plan.
SpeedBox widened(SpeedBox box) {
  constexpr double rounding = 1e-9;
  for (SpeedRange& side : box) {
    side.lo -= rounding * (1 + std::fabs(side.lo));
    side.hi += rounding * (1 + std::fabs(side.hi));
  }
  return box;
}

bool BeatsLeft::hull(const ReferenceProblem& problem, std::size_t i, int beats,
                     SpeedBox& out) const {
  const Point& next = points_[i + 1];
  bool any = false;
  for (int k = min_beats(problem, i); k <= beats - next.least; ++k) {
    SpeedBox from;
    if (!extend(problem, i, next.at(beats - k, spacing_), k, from)) continue;
    if (any) include(axes_, out, from);
    out = from;
    any = true;
  }
  return any;
}

void BeatsLeft::fill(const ReferenceProblem& problem, std::size_t i, int last) {
  Point& point = points_[i];
  const int start = points_[i + 1].least + min_beats(problem, i);
  for (int beats = start; beats < last + spacing_; beats += spacing_) {
    SpeedBox box;
    if (!hull(problem, i, beats, box)) continue;
    if (point.hull.empty()) {
      point.first = beats;
      point.least = std::max(start, beats - spacing_ + 1);
    } else {
      include(axes_, point.hull.back(), box);
    }
    point.hull.push_back(widened(box));
  }
}

BeatsLeft::BeatsLeft(const ReferenceProblem& problem, int most, const std::vector<int>& earliest,
                     int spacing)
    : axes_(problem.axes), spacing_(spacing), points_(problem.way.size() + 1) {
  const std::size_t n = problem.way.size();
  for (Point& point : points_) point.least = most + 1;
  points_[n].least = 0;
  points_[n].hull.resize(1);
  for (std::size_t i = n; i-- > 0;) {
    fill(problem, i, most - earliest[i]);
    if (points_[i].hull.empty()) return;  // not within `most`
  }
}

/// Lower bounds of the beats to each point: at full speed, then by coarse hulls of the reversed
/// sequence, because time can be reversed.
std::vector<int> earliest_beats(const ReferenceProblem& problem, int most) {
  const std::size_t n = problem.way.size();
  ReferenceProblem back = problem;
  std::reverse(back.way.begin(), back.way.end());
  std::vector<int> at_full_speed(n + 1, 0), earliest(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) at_full_speed[i + 1] = at_full_speed[i] + min_beats(back, i);
  const int spacing = 1 + most / coarse_hulls;
  const BeatsLeft coarse(back, most, at_full_speed, spacing);
  for (std::size_t i = 0; i <= n; ++i) earliest[i] = std::min(coarse.least(n - i), most);
  return earliest;
}

void count(ReferenceResult& result, const std::vector<Label>& labels) {
  result.labels += labels.size();
  result.max_labels = std::max(result.max_labels, labels.size());
}

/// A good plan, maybe not the best: an upper bound. At each point the labels with the fewest beats
/// to rest there are kept.
long beam_search(const ReferenceProblem& problem) {
  struct Ranked {
    Label label;
    int to_rest = 0;
  };
  const std::size_t n = problem.way.size();
  std::vector<Ranked> beam(1), next;
  for (std::size_t i = 0; i < n; ++i) {
    next.clear();
    const int most = rest_to_rest(problem, i) + 2;
    for (const Ranked& from : beam) {
      int tried = 0;
      for (int k = min_beats(problem, i); tried < 2 * most; ++k, ++tried) {
        Ranked to;
        if (!extend(problem, i, from.label.box, k, to.label.box)) continue;
        to.label.beats = from.label.beats + k;
        double loop = 0;  // approximate beats to rest at this point
        for (std::size_t a = 0; a < problem.axes; ++a) {
          const SpeedRange& side = to.label.box[a];
          loop = std::max(loop, std::max(side.lo, -side.hi));
        }
        to.to_rest = to.label.beats + static_cast<int>(std::ceil(loop));
        next.push_back(to);
        if (loop <= 0) break;
      }
    }
    std::stable_sort(next.begin(), next.end(),
                     [](const Ranked& a, const Ranked& b) { return a.to_rest < b.to_rest; });
    beam.clear();
    for (const Ranked& candidate : next) {
      if (beam.size() == beam_width) break;
      const bool useless = std::any_of(beam.begin(), beam.end(), [&](const Ranked& kept) {
        return kept.label.beats <= candidate.label.beats &&
               covers(problem.axes, kept.label.box, candidate.label.box);
      });
      if (!useless) beam.push_back(candidate);
    }
  }
  long best = start_stop_beats(problem);
  for (const Ranked& end : beam)
    if (contains_rest(problem.axes, end.label.box))
      best = std::min(best, static_cast<long>(end.label.beats));
  return best;
}

/// True if there is a plan of at most `total` beats.
bool plan_exists(const ReferenceProblem& problem, const BeatsLeft& left, int total,
                 ReferenceResult& result) {
  Labels labels(problem.axes), next(problem.axes);
  labels.add(Label{});
  for (std::size_t i = 0; i < problem.way.size(); ++i) {
    next.clear();
    const int latest = total - left.least(i + 1);
    const int least = min_beats(problem, i);
    if (labels.all().empty()) return false;
    for (int beats = labels.all().front().beats + least; beats <= latest; ++beats) {
      for (const Label& from : labels.all()) {
        if (from.beats + least > beats) break;
        Label to;
        ++result.segments_tried;
        if (!extend(problem, i, from.box, beats - from.beats, to.box) ||
            !left.cut(i + 1, total - beats, to.box))
          continue;
        to.beats = beats;
        next.add(to);
      }
    }
    std::swap(labels, next);
    count(result, labels.all());
  }
  return !labels.all().empty();
}

}  // namespace

bool reach(const SpeedRange& from, double way, double beats, double limit, SpeedRange& to) {
  if (std::fabs(way) > limit * beats) return false;
  const double lo = std::max(from.lo, min_start(way, beats, limit));
  const double hi = std::min(from.hi, -min_start(-way, beats, limit));
  if (lo > hi) return false;
  to = {-max_end(-hi, -way, beats, limit), max_end(lo, way, beats, limit)};
  return to.lo <= to.hi;
}

int rest_to_rest(const ReferenceProblem& problem, std::size_t i) {
  for (int k = min_beats(problem, i);; ++k) {
    SpeedBox to;
    if (extend(problem, i, SpeedBox{}, k, to) && contains_rest(problem.axes, to)) return k;
  }
}

long start_stop_beats(const ReferenceProblem& problem) {
  long beats = 0;
  for (std::size_t i = 0; i < problem.way.size(); ++i) beats += rest_to_rest(problem, i);
  return beats;
}

ReferenceResult fewest_beats_of_sequence(const ReferenceProblem& problem) {
  ReferenceResult result;
  const auto most = static_cast<int>(beam_search(problem));
  const BeatsLeft left(problem, most, earliest_beats(problem, most), 1);
  result.beats = most;
  for (int total = left.least(0); total < most; ++total) {
    if (!plan_exists(problem, left, total, result)) continue;
    result.beats = total;
    break;
  }
  return result;
}

ReferenceResult fewest_beats_of_stream(const ReferenceProblem& problem, const PointsDone& done) {
  ReferenceResult result;
  const std::size_t n = problem.way.size();
  Labels labels(problem.axes), next(problem.axes);
  labels.add(Label{});
  for (std::size_t i = 0; i < n; ++i) {
    next.clear();
    Loops loops(problem);
    const int least = min_beats(problem, i);
    for (int beats = labels.all().front().beats + least; !loops.everything(); ++beats) {
      loops.extend(beats);
      for (const Label& from : labels.all()) {
        if (from.beats + least > beats) break;
        Label to;
        ++result.segments_tried;
        if (!extend(problem, i, from.box, beats - from.beats, to.box)) continue;
        if (loops.started() && covers(problem.axes, loops.box(), to.box)) continue;
        to.beats = beats;
        next.add(to);
        if (!loops.started() && contains_rest(problem.axes, to.box)) loops.start(to);
      }
      if (i + 1 == n && loops.started()) {
        result.beats = beats;
        break;
      }
    }
    std::swap(labels, next);
    count(result, labels.all());
    if (done && (i + 1) % report_every == 0) done(i + 1);
  }
  return result;
}

ReferenceResult fewest_beats(const ReferenceProblem& problem, const PointsDone& done) {
  return problem.way.size() <= max_sequence_size ? fewest_beats_of_sequence(problem)
                                                 : fewest_beats_of_stream(problem, done);
}

}  // namespace lamplock::bench
