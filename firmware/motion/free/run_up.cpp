#include "firmware/motion/free/run_up.hpp"

#include "firmware/motion/free/beat_reduction.hpp"

namespace lamplock::motion {
namespace {

/// Ways of a row that determine its first speeds.
constexpr std::uint32_t chain_ways = 6;
/// Beats of a run-up over the speed, both normalised: slightly more than 1 + sqrt 2.
constexpr std::int32_t run_up_share = 5, run_up_divisor = 2;

using Steps = PerAxis<std::int32_t>;

/// A row of even ways that begins at a point.
struct Row {
  std::uint32_t ways = 0;
  std::int32_t beats = 0;     ///< per way, at its speed
  std::int32_t climbing = 1;  ///< per way, without a run-up
  std::int32_t run_up = 0;    ///< beats of the run-up
  bool pays() const { return static_cast<std::int64_t>(ways) * (climbing - beats) > run_up; }
};

/// Finds rows in the points of a request.
class Rows {
 public:
  Rows(const PlanRequest& request, const Window& window) : request_(request), window_(window) {
    for (int a = 0; a < window.axes(); ++a) {
      const AxisLimits& axis = request.limits->axis[index(a)];
      const std::int64_t beat = request.limits->beat_ticks;
      unit_q16_[index(a)] = (Int128::product(axis.plan_accel_q62, beat * beat) >> 46).to_int64();
    }
  }

  Row row_from(std::uint32_t point) const {
    Row row;
    if (!continues(point)) return row;
    const Steps first = way_from(point);
    const std::int32_t longest = max_units(first);
    const auto k = [&row](std::int64_t add) { return std::int64_t{row.climbing} + add; };
    while (2 * std::int64_t{longest} > k(0) * k(1) * (2 * k(0) + 1)) ++row.climbing;
    // Most ways end here: not even at any speed above the one reached by climbing.
    if (continues(point + 1) && !even(first, way_from(point + 1), row.climbing - 1)) return {};
    row.beats = beats_of(point);
    if (row.climbing < row.beats) row.climbing = row.beats;
    row.run_up = longest / row.beats * run_up_share / run_up_divisor;
    for (row.ways = 1; row.climbing > row.beats && continues(point + row.ways); ++row.ways)
      if (!even(way_from(point + row.ways - 1), way_from(point + row.ways), row.beats)) break;
    return row;
  }

  /// True if the way to points[i] of the window is already one of the row.
  bool in_row(std::uint32_t i, const Row& row) const {
    const std::uint32_t point = request_.points[i];
    const Steps first = way_from(point);
    for (int a = 0; a < window_.axes(); ++a) {
      const AxisScale& axis = window_.scale(a);
      const std::int64_t d = request_.limits->axis[index(a)].displacement_qs(first[index(a)]);
      const std::int64_t apart = abs64(window_.ways[i].displacement_qs[index(a)] - d);
      if (2 * apart > std::int64_t{row.beats * row.beats} << axis.bits) return false;
      const SpeedRange& start = window_.start[index(a)];
      const std::int64_t wrong = abs64((start.lo_qs + start.hi_qs) / 2 - d / row.beats);
      if (i == 0 && 2 * wrong > std::int64_t{row.beats} << axis.bits) return false;
    }
    return true;
  }

  /// Speeds at the first point from which the row can be run; false if there are none.
  bool first_speeds(std::uint32_t point, const Row& row, Box& box) const {
    for (int a = 0; a < window_.axes(); ++a) box[index(a)] = window_.scale(a).range();
    for (std::uint32_t n = row.ways < chain_ways ? row.ways : chain_ways; n-- > 0;) {
      const Steps way = way_from(point + n);
      for (int a = 0; a < window_.axes(); ++a) {
        const std::int64_t d = request_.limits->axis[index(a)].displacement_qs(way[index(a)]);
        const SpeedRange to = box[index(a)];
        if (!reach(window_.scale(a), to, mean_speed(d, row.beats), row.beats, box[index(a)]))
          return false;
      }
    }
    return true;
  }

 private:
  const wire::Target& target(std::uint32_t point) const { return request_.queue->at(point); }
  Steps way_from(std::uint32_t point) const {
    Steps way{};
    for (int a = 0; a < window_.axes(); ++a)
      way[index(a)] = target(point + 1).steps[index(a)] - target(point).steps[index(a)];
    return way;
  }
  /// The next target is a single shot with the same beam, and the planner chooses its beats.
  bool continues(std::uint32_t point) const {
    if (point + 1 >= request_.known_end) return false;
    const wire::Target &here = target(point), &next = target(point + 1);
    return here.shots == 1 && next.shots == 1 && next.beats == 0 && here.channel == next.channel &&
           here.energy == next.energy;
  }
  /// Longest component of a way, in units of A x beat^2.
  std::int32_t max_units(const Steps& way) const {
    std::int64_t longest = 0;
    for (int a = 0; a < window_.axes(); ++a) {
      const std::int64_t units =
          abs64(request_.limits->axis[index(a)].displacement_qs(way[index(a)])) >>
          window_.scale(a).bits;
      if (units > longest) longest = units;
    }
    return static_cast<std::int32_t>(longest);
  }
  bool even(const Steps& way, const Steps& next, std::int32_t beats) const {
    for (int a = 0; a < window_.axes(); ++a) {
      const std::int64_t apart = abs64(std::int64_t{next[index(a)]} - way[index(a)]);
      if (apart != 0 && apart << 17 > unit_q16_[index(a)] * beats * beats) return false;
    }
    return true;
  }
  /// Fewest beats a way for the first ways of a row: by its length, and by its evenness.
  std::int32_t beats_of(std::uint32_t point) const {
    const Steps first = way_from(point);
    std::int32_t beats = request_.min_beats;
    for (int a = 0; a < window_.axes(); ++a) {
      const AxisLimits& axis = request_.limits->axis[index(a)];
      const auto least = static_cast<std::int32_t>(
          abs64(axis.displacement_qs(first[index(a)])) / axis.scale.limit_qs + 1);
      if (least > beats) beats = least;
    }
    for (std::uint32_t n = 0; n < chain_ways && continues(point + n + 1); ++n)
      while (beats < max_beats && !even(way_from(point + n), way_from(point + n + 1), beats))
        ++beats;
    return beats;
  }

  static constexpr std::int32_t max_beats = 64;  ///< per way: more is no row
  const PlanRequest& request_;
  const Window& window_;
  PerAxis<std::int64_t> unit_q16_{};  ///< A x beat^2 in steps
};

/// Beats to any speed at the end of a way, from any at its start.
std::int32_t beats_for_run_up(const Window& window, const Leg& way) {
  std::int32_t beats = way.last_beats;
  for (int a = 0; a < window.axes(); ++a)
    beats += 4 * (window.scale(a).limit_qs >> window.scale(a).bits) + 4;
  return beats < window.max_beats ? beats : window.max_beats;
}

bool allow(Leg& way, const Box& box, int axes) {
  if (way.fixed_beats != 0 || !overlap(way.allowed, box, axes)) return false;
  for (int a = 0; a < axes; ++a) {
    SpeedRange& side = way.allowed[index(a)];
    if (box[index(a)].lo_qs > side.lo_qs) side.lo_qs = box[index(a)].lo_qs;
    if (box[index(a)].hi_qs < side.hi_qs) side.hi_qs = box[index(a)].hi_qs;
  }
  return true;
}

}  // namespace

bool allow_run_ups(const PlanRequest& request, Window& window) {
  const Rows rows(request, window);
  bool any = false;
  for (std::uint32_t i = 0; i < request.count;) {
    const Row row = rows.row_from(request.points[i]);
    Box box;
    if (row.pays() && !rows.in_row(i, row) && rows.first_speeds(request.points[i], row, box) &&
        allow(window.ways[i], box, window.axes())) {
      window.ways[i].last_beats = beats_for_run_up(window, window.ways[i]);
      any = true;
    }
    i += row.ways > 1 ? row.ways : 1;
  }
  return any;
}

std::int32_t steady_beats(const Window& window, const PerAxis<std::int32_t>& start_qs) {
  if (window.count < 2) return 0;
  const Leg& way = window.ways[1];
  const std::int32_t beats = way.first_beats;
  for (int a = 0; a < window.axes(); ++a) {
    const std::int64_t d = way.displacement_qs[index(a)];
    const std::int32_t speed = mean_speed(d, beats).down_qs;
    if (abs64(window.ways[0].displacement_qs[index(a)] - d) > rounding_tolerance_qs) return 0;
    if (abs64(std::int64_t{start_qs[index(a)]} - speed) > 4 * rounding_tolerance_qs) return 0;
    for (std::uint32_t i = 0; i < window.count; ++i)
      if ((i > 1 && window.ways[i].displacement_qs[index(a)] != d) ||
          !window.ways[i].allowed[index(a)].contains(speed))
        return 0;
  }
  for (std::uint32_t i = 0; i < window.count; ++i)
    if (window.ways[i].fixed_beats != 0 || window.ways[i].first_beats != beats) return 0;
  return beats;
}

}  // namespace lamplock::motion
