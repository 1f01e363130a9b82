#include "host/model/arc_length.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/geometry/limits.hpp"
#include "host/geometry/vector.hpp"
#include "host/model/spline.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

// Tolerance for the sum of halves against the whole, absolute and relative: far below a step of any
// stage, even summed over a million pieces. Far from the origin rounding alone exceeds it.
constexpr double agree_mm = 1e-10, agree_part = 1e-12, rounding_part = 1e-14;
// 2^-40 of a piece of 10^9 mm is a micrometre: at cusps, where halves agree late.
constexpr int deepest = 40;

/// Nodes and weights of Gauss-Legendre quadrature with five points on -1..1 (Abramowitz and Stegun,
/// "Handbook of Mathematical Functions", table 25.4).
struct Node {
  double at, weight;
};
constexpr std::array<Node, 5> gauss_nodes{{{-0.906179845938663993, 0.236926885056189088},
                                           {-0.538469310105683091, 0.478628670499366468},
                                           {0.0, 0.568888888888888889},
                                           {0.538469310105683091, 0.478628670499366468},
                                           {0.906179845938663993, 0.236926885056189088}}};

double quadrature(const Piece& piece, const Range& range) {
  const double half = (range.to - range.from) / 2, middle = range.from + half;
  double sum = 0;
  for (const Node& node : gauss_nodes) {
    sum += node.weight * norm(motion_at(piece, middle + half * node.at).speed);
  }
  return std::abs(half) * sum;
}

/// Best possible agreement of the quadratures of a piece, mm.
double agreement(const Piece& piece) {
  const auto* spline = std::get_if<Spline>(&piece);
  if (spline == nullptr) return agree_mm;
  double farthest = 0;
  for (const Point& pole : spline->poles) farthest = std::max(farthest, norm(pole));
  return std::max(agree_mm, rounding_part * farthest);
}

}  // namespace

ArcLength::ArcLength(const Path& path) : path_(path) {
  for (std::size_t piece = 0; piece < path.pieces.size(); ++piece) add(piece);
}

void ArcLength::add(std::size_t index) {
  const Piece& piece = path_.pieces[index];
  agree_mm_ = agreement(piece);
  if (const auto* spline = std::get_if<Spline>(&piece)) {
    const std::vector<double> breaks = breaks_of(*spline);
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      const Range range{breaks[i], breaks[i + 1]};
      add_smooth(index, range, quadrature(piece, range), deepest);
    }
  } else {
    const Range range = range_of(piece);
    add_smooth(index, range, quadrature(piece, range), deepest);
  }
}

void ArcLength::add_smooth(std::size_t index, const Range& range, double length, int depth) {
  const Piece& piece = path_.pieces[index];
  const double middle = range.from + (range.to - range.from) / 2;
  const Range first{range.from, middle}, second{middle, range.to};
  const double before = quadrature(piece, first), after = quadrature(piece, second);
  const double halves = before + after;
  if (depth == 0 || std::abs(halves - length) <= agree_mm_ + agree_part * halves) {
    geometry::require_count(static_cast<double>(stretches_.size()), "curve");
    stretches_.push_back({index, range, total_, halves});
    total_ += halves;
    return;
  }
  add_smooth(index, first, before, depth - 1);
  add_smooth(index, second, after, depth - 1);
}

Point ArcLength::at(double s) {
  const Place found = place(s);
  return motion_at(path_.pieces[found.piece], found.parameter).at;
}

ArcLength::Place ArcLength::place(double s) {
  if (!(s < total_)) return {path_.pieces.size() - 1, range_of(path_.pieces.back()).to};
  if (s <= 0) return {0, range_of(path_.pieces.front()).from};
  if (s < stretches_[last_].begins_at) last_ = 0;
  if (last_ + 1 < stretches_.size() && stretches_[last_ + 1].begins_at <= s) {
    const auto after =
        std::upper_bound(stretches_.begin() + static_cast<std::ptrdiff_t>(last_), stretches_.end(),
                         s, [](double at, const Stretch& next) { return at < next.begins_at; });
    last_ = static_cast<std::size_t>(after - stretches_.begin()) - 1;
  }
  const Stretch& stretch = stretches_[last_];
  return {stretch.piece, parameter_at(stretch, s - stretch.begins_at)};
}

double ArcLength::parameter_at(const Stretch& stretch, double along) const {
  const Piece& piece = path_.pieces[stretch.piece];
  const auto [from, to] = stretch.range;
  if (!(stretch.length > 0)) return from;
  double low = 0, high = 1;  // bounds of the solution, in the stretch's range
  double part = std::clamp(along / stretch.length, 0.0, 1.0);
  constexpr int max_steps = 60;  // pure bisection ends after 53
  for (int step = 0; step < max_steps; ++step) {
    const double t = from + part * (to - from);
    const double excess = quadrature(piece, {from, t}) - along;
    if (std::abs(excess) <= agree_mm) break;
    (excess > 0 ? high : low) = part;
    const double rate = norm(motion_at(piece, t).speed) * std::abs(to - from);
    const double next = part - excess / rate;
    part = next > low && next < high ? next : low + (high - low) / 2;
  }
  return from + part * (to - from);
}

}  // namespace lamplock::model
