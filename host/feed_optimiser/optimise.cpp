#include "host/feed_optimiser/optimise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "host/feed_optimiser/motion_meter.hpp"
#include "host/feed_optimiser/time_optimum.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::feed_optimiser {
namespace {

/// Blocks below the resolution of programs, 1e-7 mm, have no direction.
constexpr double min_length_mm = 1e-6;
constexpr double min_period_s = 1e-6, max_period_s = 1;
/// Part of the jerk that the rounding of coordinates may take at a joint of two blocks in one
/// direction.
constexpr double joint_part = 1e-8;
/// A place that is left out where two blocks are joined is no farther than this from the line: the
/// resolution of the written program.
constexpr double max_off_line_mm = 1e-5;
/// Part of a limit that may be left for the rounding of coordinates.
constexpr double max_rounding_part = 0.1;

std::string where(const Block& block, const std::string& file) {
  return fmt::format("{}:{}", file, block.line);
}

double smallest(const PerAxis& values) { return *std::min_element(values.begin(), values.end()); }

/// A third difference adds eight coordinates, each rounded a few times.
double rounding_mm(const Block& block) {
  double coordinate_mm = block.length_mm;
  for (const Point& p : {block.from, block.to})
    coordinate_mm = std::max({coordinate_mm, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return 32 * std::numeric_limits<double>::epsilon() * coordinate_mm;
}

/// Leaves room for the rounding of coordinates, which derivatives by differences multiply.
void leave_room(PathLimits& limits, const Block& block, const Method& method) {
  const double rounding = rounding_mm(block);
  const auto part = [&](const PerAxis& values, double time) {
    return 1 - std::min(max_rounding_part, rounding / (time * smallest(values)));
  };
  const double t = method.period_s;
  limits.speed_mm_s *= part(method.limits.speed_mm_s, t);
  limits.accel_mm_s2 *= part(method.limits.accel_mm_s2, t * t);
  limits.jerk_mm_s3 *= part(method.limits.jerk_mm_s3, t * t * t);
}

Task task_of(const Block& block, const Method& method) {
  Task task{block.length_mm, path_limits(block, method.limits)};
  if (method.variant == Variant::strict) leave_room(task.limits, block, method);
  if (method.variant == Variant::printed)
    task.limits.jerk_mm_s3 = printed_jerk_limit(block, method.limits);
  return task;
}

void require_steps(const Block& block, const Task& task, const Method& method,
                   const std::string& file) {
  const double optimum = optimum_s(task.length_mm, task.limits);
  if (optimum < method.period_s)
    throw Error(Exit::bad_input, where(block, file),
                fmt::format("a block of {:.3g} mm takes {:.3g} ms, less than the control period of "
                            "{:g} ms",
                            task.length_mm, optimum * 1e3, method.period_s * 1e3),
                "shorten the control period or leave out the point");
  if (optimum / method.period_s > static_cast<double>(geometry::max_points))
    throw Error(Exit::bad_input, where(block, file),
                fmt::format("a block of {:g} mm takes more than {} control periods", task.length_mm,
                            geometry::max_points),
                "lengthen the control period or raise the limits");
  if (method.variant == Variant::printed) return;
  const double t = method.period_s;
  if (rounding_mm(block) > max_rounding_part * t * t * t * smallest(method.limits.jerk_mm_s3))
    throw Error(Exit::bad_input, where(block, file),
                fmt::format("in a control period of {:g} ms the rounding of coordinates is a jerk "
                            "near the limit of {:g} mm/s3",
                            t * 1e3, smallest(method.limits.jerk_mm_s3)),
                "lengthen the control period, or raise the limit of the jerk");
}

Profile profile_of(const Task& task, const Method& method, const LawTable& table) {
  return method.variant == Variant::printed ? printed_profile(task, table)
                                            : strict_profile(task, table);
}

/// Lowers the limits along an arc until the places on it are within those of the axes.
void keep_limits(OptimisedBlock& optimised, const Method& method) {
  constexpr int max_rounds = 100;
  constexpr double more = 0.999;  ///< lower than needed, so that few rounds are enough
  for (int round = 0; round < max_rounds; ++round) {
    MotionMeter meter(method.period_s);
    for (const Point& place : places(optimised)) meter.add(place);
    meter.finish();
    const Usage usage = usage_of(meter.max(), method.limits);
    if (std::max({usage.speed, usage.accel, usage.jerk}) <= 1) return;
    PathLimits& limits = optimised.task.limits;
    if (usage.speed > 1 || usage.accel > 1)
      limits.speed_mm_s *= more / std::max(usage.speed, usage.accel);
    if (usage.accel > 1) limits.accel_mm_s2 *= more / usage.accel;
    if (usage.jerk > 1) {
      limits.jerk_mm_s3 *= more / usage.jerk;
      limits.speed_mm_s *= more / std::cbrt(usage.jerk);
    }
    optimised.profile = profile_of(optimised.task, method, *optimised.table);
  }
}

/// The distance of the end of a block from the line between two places.
double off_line_mm(const Block& before, const Block& whole) {
  const Point &a = whole.from, &p = before.to, &b = whole.to;
  const Point way{b.x - a.x, b.y - a.y, b.z - a.z}, to{p.x - a.x, p.y - a.y, p.z - a.z};
  return std::hypot(way.y * to.z - way.z * to.y, way.z * to.x - way.x * to.z,
                    way.x * to.y - way.y * to.x) /
         whole.length_mm;
}

bool joins(const Block& before, const Block& next, const Method& method) {
  if (before.arc || next.arc || before.rapid != next.rapid || before.feed_mm_s != next.feed_mm_s ||
      before.placed_axes != next.placed_axes)
    return false;
  const PathLimits limits = path_limits(next, method.limits);
  const Block whole = straight_block(before.from, next.to);
  const double turn = std::hypot(
      (next.to.x - next.from.x) / next.length_mm - (before.to.x - before.from.x) / before.length_mm,
      (next.to.y - next.from.y) / next.length_mm - (before.to.y - before.from.y) / before.length_mm,
      (next.to.z - next.from.z) / next.length_mm -
          (before.to.z - before.from.z) / before.length_mm);
  const double smallest_jerk =
      *std::min_element(method.limits.jerk_mm_s3.begin(), method.limits.jerk_mm_s3.end());
  return limits.speed_mm_s * turn <=
             joint_part * smallest_jerk * method.period_s * method.period_s &&
         whole.length_mm > before.length_mm;
}

/// A block without a length was dropped before this one.
void begin_at(Block& block, const Point& from) {
  if (block.arc || block.from == from) return;
  block.from = from;
  block.length_mm = straight_block(from, block.to).length_mm;
}

}  // namespace

std::shared_ptr<const LawTable> law_table(const Method& method) {
  require_law(method.law);
  require_limits(method.limits);
  if (!(method.period_s >= min_period_s && method.period_s <= max_period_s))
    throw Error(Exit::bad_input, "control period",
                fmt::format("{:g} ms is not from 0.001 to 1000 ms", method.period_s * 1e3),
                "choose a period in this range");
  // No direction permits more than one axis times this, by its limits.
  const double max_jerk =
      2 * *std::max_element(method.limits.jerk_mm_s3.begin(), method.limits.jerk_mm_s3.end());
  return std::make_shared<const LawTable>(method.law, max_jerk, method.period_s);
}

OptimisedBlock optimise_block(const Block& block, const Method& method,
                              const std::shared_ptr<const LawTable>& table,
                              const std::string& file) {
  OptimisedBlock optimised{block, task_of(block, method), {}, table};
  require_steps(block, optimised.task, method, file);
  optimised.profile = profile_of(optimised.task, method, *table);
  if (block.arc && method.variant == Variant::strict) keep_limits(optimised, method);
  return optimised;
}

std::vector<OptimisedBlock> optimise(std::span<const Block> blocks, const Method& method,
                                     const std::string& file) {
  const auto table = law_table(method);
  std::vector<OptimisedBlock> optimised;
  optimised.reserve(blocks.size());
  for (const Block& block : blocks) optimised.push_back(optimise_block(block, method, table, file));
  return optimised;
}

std::vector<Block> join_straight(std::span<const Block> blocks, const Method& method) {
  std::vector<Block> joined;
  // A bound of the distance of all places left out from the last block: each join turns the line
  // about its begin, and moves it by less there than at the place that is left out.
  double off_mm = 0;
  for (Block block : blocks) {
    if (block.length_mm < min_length_mm) continue;
    if (!joined.empty()) begin_at(block, joined.back().to);
    if (!joined.empty() && joins(joined.back(), block, method)) {
      Block whole = straight_block(joined.back().from, block.to);
      const double more_mm = off_line_mm(joined.back(), whole);
      if (off_mm + more_mm <= max_off_line_mm) {
        off_mm += more_mm;
        whole.feed_mm_s = block.feed_mm_s;
        whole.rapid = block.rapid;
        whole.placed_axes = block.placed_axes;
        whole.line = block.line;
        joined.back() = whole;
        continue;
      }
    }
    joined.push_back(block);
    off_mm = 0;
  }
  return joined;
}

std::vector<Point> places(const OptimisedBlock& optimised) {
  std::vector<Point> places;
  places.reserve(optimised.profile.steps() + 1);
  for (const double s : distances(optimised.profile, optimised.task, *optimised.table))
    places.push_back(optimised.block.at(s));
  places.front() = optimised.block.from;
  places.back() = optimised.block.to;
  return places;
}

}  // namespace lamplock::feed_optimiser
