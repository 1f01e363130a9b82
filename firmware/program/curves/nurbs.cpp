#include "firmware/program/curves/nurbs.hpp"

#include <algorithm>
#include <bit>

#include "firmware/program/decimal.hpp"
#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr int ratio_bits = 30;
constexpr std::uint64_t one_ratio = std::uint64_t{1} << ratio_bits;
constexpr std::uint32_t first_pieces = 4, max_pieces_a_span = 4096;

/// From a to b by a ratio of 0 to 1.
std::int64_t between(std::int64_t a, std::int64_t b, std::uint64_t ratio_q30) {
  constexpr int to_q48 = 48 - ratio_bits;
  return a + times_q48(b - a, static_cast<std::int64_t>(ratio_q30 << to_q48));
}

/// Distance of a point from a chord, from the nearer end if it is beside neither.
std::int64_t distance(const PlanePoint& from, const PlanePoint& to, const PlanePoint& point) {
  const std::int64_t x = to.first_e7 - from.first_e7, y = to.second_e7 - from.second_e7;
  const std::int64_t u = point.first_e7 - from.first_e7, v = point.second_e7 - from.second_e7;
  const std::int64_t chord = length_of(x, y);
  const Int128 along = Int128::product(x, u) + Int128::product(y, v);
  if (chord == 0 || along.negative()) return length_of(u, v);
  if (Int128::product(chord, chord) < along) return length_of(u - x, v - y);
  const Int128 across = Int128::product(x, v) - Int128::product(y, u);
  return static_cast<std::int64_t>(
      nearest_quotient(across.negative() ? -across : across, static_cast<std::uint64_t>(chord)));
}

std::int64_t length(const PlanePoint& from, const PlanePoint& to) {
  return length_of(to.first_e7 - from.first_e7, to.second_e7 - from.second_e7);
}

}  // namespace

/// The knot before which `i` others are.
std::uint32_t Nurbs::knot(std::uint32_t i) const {
  const std::uint32_t degree = control_->order - 1;
  return i < degree ? 0 : std::min(i - degree, spans());
}

/// t from 0 to 1 in the span.
PlanePoint Nurbs::at(std::uint32_t span, std::uint32_t t_q30) const {
  std::array<NurbsPoint, NurbsPoints::max_order> work;
  const std::uint32_t degree = control_->order - 1;
  std::uint32_t weights = 0;
  for (std::uint32_t i = 0; i <= degree; ++i) {
    work[i] = control_->points[span + i];
    weights |= work[i].weight_e6;
  }
  // Only ratios of weights count: with 31 bits those of small weights are as exact.
  const int shift = std::countl_zero(weights) - 1;
  for (std::uint32_t i = 0; i <= degree; ++i) work[i].weight_e6 <<= shift;
  for (std::uint32_t step = 1; step <= degree; ++step)
    for (std::uint32_t i = degree; i >= step; --i) {
      NurbsPoint &point = work[i], &before = work[i - 1];
      const std::uint32_t from = knot(span + i), to = knot(span + i + degree - step + 1);
      const std::uint64_t after_q30 =
          ((std::uint64_t{span - from} << ratio_bits) + t_q30) / (to - from);
      std::uint64_t ratio_q30 = after_q30;
      if (point.weight_e6 != before.weight_e6) {
        const std::uint64_t part = after_q30 * point.weight_e6;
        const std::uint64_t sum = part + (one_ratio - after_q30) * before.weight_e6;
        point.weight_e6 = static_cast<std::uint32_t>(sum >> ratio_bits);
        ratio_q30 = std::min(part / point.weight_e6, one_ratio);
      }
      point.place.first_e7 = between(before.place.first_e7, point.place.first_e7, ratio_q30);
      point.place.second_e7 = between(before.place.second_e7, point.place.second_e7, ratio_q30);
    }
  return work[degree].place;
}

/// The point after some of all steps; the last step ends at the last control point.
PlanePoint Nurbs::place(std::uint32_t step, std::uint32_t steps_a_span) const {
  const std::uint32_t span = step / steps_a_span;
  if (span == spans()) return control_->points[control_->count - 1].place;
  const std::uint64_t part = step % steps_a_span;
  return at(span, static_cast<std::uint32_t>((part << ratio_bits) / steps_a_span));
}

Nurbs::Measure Nurbs::measure(std::uint32_t pieces_a_span) const {
  constexpr std::uint32_t parts = 4;
  const std::uint32_t steps_a_span = parts * pieces_a_span;
  Measure result{0, 0};
  std::array<PlanePoint, parts + 1> points;
  points[parts] = control_->points[0].place;
  for (std::uint32_t piece = 0; piece < pieces_a_span * spans(); ++piece) {
    points[0] = points[parts];
    for (std::uint32_t i = 1; i <= parts; ++i) {
      points[i] = place(parts * piece + i, steps_a_span);
      result.length_e7 += length(points[i - 1], points[i]);
    }
    for (std::uint32_t i = 1; i < parts; ++i)
      result.distance_e7 =
          std::max(result.distance_e7, distance(points[0], points[parts], points[i]));
  }
  return result;
}

Division Nurbs::begin(const NurbsRequest& request, std::int64_t other_way_e7) {
  control_ = request.control;
  done_ = 0;
  // A little less than the tolerance: the farthest point is beside the quarters.
  const std::int64_t tolerance_e7 =
      std::clamp<std::int64_t>(request.tolerance_e7, 2, max_coordinate_e7) * 7 / 8;
  Measure measured{0, 0};
  for (pieces_a_span_ = first_pieces;;) {
    measured = measure(pieces_a_span_);
    if (measured.distance_e7 <= tolerance_e7 || pieces_a_span_ >= max_pieces_a_span) break;
    // The distance falls with the square of the number.
    const auto times_q16 = static_cast<std::uint64_t>(
        std::min<std::int64_t>(measured.distance_e7 / tolerance_e7 + 1, 4096) << 16);
    const std::uint64_t wanted = (std::uint64_t{pieces_a_span_} * isqrt(times_q16) >> 8) + 1;
    pieces_a_span_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, max_pieces_a_span));
  }
  return {pieces_a_span_ * spans(), length_of(measured.length_e7, other_way_e7)};
}

PlanePoint Nurbs::next(std::uint32_t) { return place(++done_, pieces_a_span_); }

}  // namespace lamplock::program
