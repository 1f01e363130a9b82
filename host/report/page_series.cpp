#include "host/report/page_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/geometry/kd_tree.hpp"
#include "host/report/matching.hpp"
#include "host/report/shot_beats.hpp"

namespace lamplock::report {
namespace {

/// Number of bins that a chart of a phone's width can show.
constexpr std::size_t spacing_bins = 48, utilisation_bins = 160;
/// The last bin has all moves with this number of beats or more.
constexpr std::size_t beat_bins = 33;
/// Distances beyond this quantile are in the last bin.
constexpr double shown_share = 0.99;
/// Finer than any laser's spot; smaller differences are rounding.
constexpr double min_bin_mm = 1e-4;

std::uint32_t shots_ordered(const JobRun& run, std::size_t point) {
  return run.shots_ordered.empty() ? 1 : run.shots_ordered[point];
}

/// Predicted shots: each belongs to the next point.
void take_foreseen(const JobRun& run, PointBeats& result) {
  result.shots = run.foreseen_beats;
  std::size_t shot = 0;
  std::uint32_t beat = 0;
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    shot = std::min(shot + shots_ordered(run, i), result.shots.size());
    if (shot != 0) beat = result.shots[shot - 1];
    result.beat[i] = beat;
  }
}

/// Recorded shots.
void take_fired(const JobRun& run, PointBeats& result) {
  result.shots = beats_from_first(run.shots, run.settings);
  const Matching matching = match_shots(run);
  std::vector<std::uint32_t> fired(run.points.size());
  for (std::size_t i = 0; i < run.shots.size(); ++i) {
    const std::uint32_t point = matching.point_of_shot[i];
    if (point == no_point) continue;
    ++fired[point];
    result.beat[point] = std::max(result.beat[point], result.shots[i]);
  }
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    result.missed[i] = fired[i] < shots_ordered(run, i) ? 1 : 0;
    if (fired[i] == 0 && i != 0) result.beat[i] = result.beat[i - 1];
  }
}

double quantile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

PointBeats point_beats(const JobRun& run) {
  PointBeats result;
  result.known = !run.dry && (run.shots_known || !run.foreseen_beats.empty());
  if (!result.known) return result;
  result.beat.resize(run.points.size());
  result.missed.resize(run.points.size());
  if (run.shots_known)
    take_fired(run, result);
  else
    take_foreseen(run, result);
  return result;
}

Histogram spacing_histogram(const geometry::PointCloud& cloud, std::size_t most) {
  Histogram result;
  if (cloud.size() < 2 || most == 0 ||
      !std::all_of(cloud.begin(), cloud.end(), geometry::is_finite))
    return result;
  const auto tree = geometry::kd_tree_of(cloud);
  const std::size_t stride = (cloud.size() + most - 1) / most;
  std::vector<double> distances;
  distances.reserve(cloud.size() / stride + 1);
  for (std::size_t i = 0; i < cloud.size(); i += stride) {
    std::array<std::uint32_t, 2> index{};
    std::array<double, 2> squared{};
    // The nearest point is the point itself.
    tree.nearest(cloud[i], index.size(), index, squared);
    distances.push_back(std::sqrt(squared[1]));
  }
  result.values = distances.size();
  result.least = *std::min_element(distances.begin(), distances.end());
  result.median = quantile(distances, 0.5);
  const double shown = quantile(distances, shown_share);
  // Distances that are nearly equal need a finer scale.
  if (2 * result.least > shown) result.from = result.least;
  const double width = (shown - result.from) / (spacing_bins - 1);
  // If all distances are equal any width is possible.
  result.bin = width > min_bin_mm ? width : min_bin_mm;
  result.counts.resize(spacing_bins);
  const double end = result.from + spacing_bins * result.bin;
  for (const double distance : distances) {
    result.open |= distance > end;
    const double bin = std::min<double>((distance - result.from) / result.bin, spacing_bins - 1);
    ++result.counts[static_cast<std::size_t>(bin)];
  }
  return result;
}

Histogram beats_histogram(const PointBeats& beats) {
  Histogram result;
  if (beats.beat.size() < 2) return result;
  result.bin = 1;
  result.counts.resize(beat_bins);
  std::vector<double> all;
  all.reserve(beats.beat.size() - 1);
  for (std::size_t i = 1; i < beats.beat.size(); ++i) {
    const std::uint32_t from = beats.beat[i - 1], to = beats.beat[i];
    // The point was missed, or fired before its predecessor, which was missed at first.
    if (to < from || beats.missed[i] != 0) continue;
    all.push_back(to - from);
    result.open |= to - from >= beat_bins;
    ++result.counts[std::min<std::size_t>(to - from, beat_bins - 1)];
  }
  result.values = all.size();
  if (all.empty()) return result;
  result.least = *std::min_element(all.begin(), all.end());
  result.median = quantile(all, 0.5);
  return result;
}

Utilisation utilisation_over_time(const PointBeats& beats, std::uint64_t total_beats) {
  Utilisation result;
  if (beats.shots.empty()) return result;
  const std::uint64_t last = *std::max_element(beats.shots.begin(), beats.shots.end());
  const std::uint64_t total = std::max(total_beats, last + 1);
  const std::uint64_t bins = std::min<std::uint64_t>(utilisation_bins, total);
  std::vector<std::uint64_t> shots(bins);
  for (const std::uint32_t beat : beats.shots) ++shots[beat * bins / total];
  result.beats_per_bin = static_cast<double>(total) / static_cast<double>(bins);
  for (std::uint64_t i = 0; i < bins; ++i) {
    // Beats b with b * bins / total == i.
    const std::uint64_t begin = (i * total + bins - 1) / bins;
    const std::uint64_t end = ((i + 1) * total + bins - 1) / bins;
    result.share.push_back(static_cast<double>(shots[i]) / static_cast<double>(end - begin));
  }
  return result;
}

}  // namespace lamplock::report
