#include "firmware/program/curves/spline_length.hpp"

#include <bit>

namespace lamplock::program {
namespace {

/// 2^13 per edge on each of three axes: the chord is below 3 sqrt(3) 2^13, its square below 2^31.
constexpr int edge_bits = 13;
constexpr int max_depth = 7;
/// Chord and polygon are close when they differ by less than a 512th of the polygon; a part is
/// negligible when they differ by less than a 4096th of the whole. Tried on 3000 curves: the
/// maximum error of the length is 0.07 %.
constexpr int close_bits = 9, short_bits = 12;

/// Root of a number, within 1 and 2^-16 of itself: eight bits from a table, doubled by Newton.
std::uint32_t short_root(std::uint32_t x) {
  if (x == 0) return 0;
  const int shift = std::countl_zero(x) & ~1;
  const std::uint32_t n = x << shift;
  const std::uint32_t r8 = std::uint32_t{detail::root_table[(n >> 24) - 64]} << 8;
  return (r8 + n / r8) >> (1 + shift / 2);
}

/// Edges of a control polygon on one axis.
struct Edges {
  std::int32_t first, middle, last;

  std::int32_t sum() const { return first + middle + last; }
  /// Of the part between k/2^depth and (k + 1)/2^depth, 2^depth times as long. The edges are the
  /// derivative (over 3) and a part's are its blossom q(a, b) = E0 + (a + b) F + a b G at (a, a),
  /// (a, b) and (b, b).
  Edges part(std::int32_t k, int depth) const {
    const std::int32_t slope = middle - first, bend = last - 2 * middle + first;
    const std::int32_t half = 1 << (2 * depth) >> 1;
    const auto at = [&](std::int32_t a, std::int32_t b) {
      const std::int32_t scaled =
          first * (1 << (2 * depth)) + (a + b) * slope * (1 << depth) + a * b * bend;
      return (scaled + half) >> (2 * depth);
    };
    return {at(k, k), at(k, k + 1), at(k + 1, k + 1)};
  }
};

std::uint32_t norm(std::int32_t x, std::int32_t y, std::int32_t z) {
  return short_root(static_cast<std::uint32_t>(x * x + y * y + z * z));
}

/// Lower and upper bound of the length of a cubic. The third axis moves evenly: all its edges are
/// z.
struct Bounds {
  std::uint32_t chord, polygon;
};
Bounds bounds_of(const Edges& x, const Edges& y, std::int32_t z) {
  return {norm(x.sum(), y.sum(), 3 * z),
          norm(x.first, y.first, z) + norm(x.middle, y.middle, z) + norm(x.last, y.last, z)};
}

/// Twice 2^max_depth times the length.
std::uint32_t scaled_length(const Edges& x, const Edges& y, std::int32_t z) {
  const std::uint32_t whole = bounds_of(x, y, z).polygon;
  std::uint32_t sum = 0;
  std::int32_t k = 0;
  int depth = 0;
  do {
    const Bounds part = bounds_of(x.part(k, depth), y.part(k, depth), z);
    const std::uint32_t between = part.polygon > part.chord ? part.polygon - part.chord : 0;
    const bool close =
        between <= part.polygon >> close_bits || between <= whole << depth >> short_bits;
    if (!close && depth < max_depth) {
      k *= 2;
      ++depth;
      continue;
    }
    sum += (part.chord + part.polygon) << (max_depth - depth);
    for (++k; depth > 0 && k % 2 == 0; --depth) k /= 2;
  } while (k == 0 || depth > 0);
  return sum;
}

std::int32_t shortened(std::int64_t v, int shift) {
  if (shift <= 0) return static_cast<std::int32_t>(v * (std::int64_t{1} << -shift));
  // Rounded; a result one above 13 bits does no harm.
  return static_cast<std::int32_t>(((v >> (shift - 1)) + 1) >> 1);
}

/// The same with full precision.
struct LongEdges {
  std::int64_t first, middle, last;

  LongEdges(const SplineRequest& request, std::uint8_t axis)
      : first(request.first_control[axis] - request.start[axis]),
        middle(request.second_control[axis] - request.first_control[axis]),
        last(request.end[axis] - request.second_control[axis]) {}
  std::uint64_t bits() const {
    return static_cast<std::uint64_t>(abs64(first) | abs64(middle) | abs64(last));
  }
  Edges scaled(int shift) const {
    return {shortened(first, shift), shortened(middle, shift), shortened(last, shift)};
  }
};

}  // namespace

std::int64_t spline_length(const SplineRequest& request, std::int64_t other_way_e7) {
  const LongEdges x(request, request.plane.first), y(request, request.plane.second);
  const std::int64_t z = other_way_e7 / 3;
  const std::uint64_t bits = x.bits() | y.bits() | static_cast<std::uint64_t>(z);
  if (bits == 0) return other_way_e7;
  const int shift = static_cast<int>(std::bit_width(bits)) - edge_bits;
  const std::uint64_t length = scaled_length(x.scaled(shift), y.scaled(shift), shortened(z, shift));
  constexpr int more = max_depth + 1;
  return static_cast<std::int64_t>(shift > more ? length << (shift - more)
                                                : length >> (more - shift));
}

}  // namespace lamplock::program
