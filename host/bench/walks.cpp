#include "host/bench/walks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "host/bench/glass_tables.hpp"

namespace lamplock::bench {
namespace {

using Position = std::array<double, max_axes>;

wire::Target target_at(const Position& at_mm, double steps_per_mm) {
  wire::Target target;
  for (std::size_t a = 0; a < max_axes; ++a)
    target.steps[a] = static_cast<std::int32_t>(std::lround(at_mm[a] * steps_per_mm));
  return target;
}

/// Distances between points of the thesis, mm.
constexpr double min_spacing_mm = 0.1, max_spacing_mm = 0.15;

/// Direction of a course with corners before a point.
double direction(Course shape, int point) {
  const bool even_leg = point / corner_every % 2 == 0;
  if (shape == Course::stairs) return even_leg ? 0 : std::numbers::pi / 2;
  if (shape == Course::zigzag) return even_leg ? std::numbers::pi / 3 : -std::numbers::pi / 3;
  return 0;
}

}  // namespace

std::vector<int> step_counts(int total) {
  double sum = 0;
  for (const StepLength& bin : glass_step_lengths) sum += bin.fraction;
  std::vector<int> counts;
  std::vector<std::pair<double, std::size_t>> rest;
  for (std::size_t i = 0; i < glass_step_lengths.size(); ++i) {
    const double share = glass_step_lengths[i].fraction / sum * total;
    counts.push_back(static_cast<int>(share));
    rest.emplace_back(counts.back() - share, i);
  }
  std::sort(rest.begin(), rest.end());
  int given = std::accumulate(counts.begin(), counts.end(), 0);
  for (std::size_t i = 0; given < total; ++i, ++given) ++counts[rest[i].second];
  return counts;
}

std::vector<wire::Target> histogram_walk(int points, int axes, double steps_per_mm,
                                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> lengths_mm;
  const std::vector<int> counts = step_counts(points);
  for (std::size_t i = 0; i < counts.size(); ++i)
    lengths_mm.insert(lengths_mm.end(), static_cast<std::size_t>(counts[i]),
                      glass_step_lengths[i].step_um * 1e-3);
  std::shuffle(lengths_mm.begin(), lengths_mm.end(), random);
  std::normal_distribution<double> normal;
  std::vector<wire::Target> targets;
  Position at{};
  for (const double length : lengths_mm) {
    Position way{};
    double square = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(axes); ++a) {
      way[a] = normal(random);
      square += way[a] * way[a];
    }
    for (std::size_t a = 0; a < max_axes; ++a) at[a] += way[a] * length / std::sqrt(square);
    targets.push_back(target_at(at, steps_per_mm));
  }
  return targets;
}

std::vector<wire::Target> course(Course shape, int points, double steps_per_mm,
                                 std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> spacing(min_spacing_mm, max_spacing_mm);
  const double mean_mm = (min_spacing_mm + max_spacing_mm) / 2;
  const double radius_mm = points * mean_mm / (2 * std::numbers::pi);
  std::vector<wire::Target> targets;
  Position at{};
  double way_mm = 0;
  for (int i = 0; i < points; ++i) {
    const double step_mm = spacing(random);
    way_mm += step_mm;
    if (shape == Course::circle) {
      at[0] = radius_mm * std::sin(way_mm / radius_mm);
      at[1] = radius_mm * (1 - std::cos(way_mm / radius_mm));
    } else {
      const double angle = direction(shape, i);
      at[0] += step_mm * std::cos(angle);
      at[1] += step_mm * std::sin(angle);
    }
    targets.push_back(target_at(at, steps_per_mm));
  }
  return targets;
}

ReferenceProblem problem_of(const motion::Limits& limits,
                            const std::vector<wire::Target>& targets) {
  ReferenceProblem problem;
  problem.axes = static_cast<std::size_t>(limits.axes);
  problem.way.resize(targets.size());
  const double beat = limits.beat_ticks;
  for (std::size_t a = 0; a < problem.axes; ++a) {
    const double accel = std::ldexp(static_cast<double>(limits.axis[a].accel_q62), -62);
    const double speed = std::ldexp(static_cast<double>(limits.axis[a].speed_q62), -62);
    problem.limit[a] = speed / (accel * beat);
    std::int32_t before = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      problem.way[i][a] =
          (static_cast<double>(targets[i].steps[a]) - before) / (accel * beat * beat);
      before = targets[i].steps[a];
    }
  }
  return problem;
}

}  // namespace lamplock::bench
