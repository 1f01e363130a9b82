// Distances from one place to a few darts. In: darts and a place. Out: a set with one bit for each
// dart. Called by the search for gaps, which spends most of its time here.
//
// Places are rounded to floats relative to a block: the caller chooses to which side a comparison
// errs (Doubt).
//
// A processor with SSE2 (every x86-64) compares four darts at once; elsewhere a loop compares one
// after the other.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/geometry/point.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lamplock::points {

/// Bit i: dart i of a list of up to 64.
using DartSet = std::uint64_t;

inline constexpr std::size_t max_set_size = 64;

/// Calls `visit(i)` for every dart of a set.
template <class Visit>
void for_each_of(DartSet set, const Visit& visit) {
  for (; set != 0; set &= set - 1) visit(static_cast<std::size_t>(std::countr_zero(set)));
}

/// A dart is in all of the sets.
template <std::size_t count>
bool have_common_dart(const std::array<DartSet, count>& sets) {
  DartSet common = ~DartSet{0};
  for (const DartSet set : sets) common &= set;
  return common != 0;
}

/// A place relative to the low corner of a block, in distances.
struct PlaceInBlock {
  float x = 0, y = 0, z = 0;
};

/// Where a block is and how long a distance is.
struct BlockUnits {
  geometry::Point low;
  double per_mm = 1;  // distances

  PlaceInBlock place_of(const geometry::Point& place) const {
    return {static_cast<float>((place.x - low.x) * per_mm),
            static_cast<float>((place.y - low.y) * per_mm),
            static_cast<float>((place.z - low.z) * per_mm)};
  }
  float square_of(double length_mm) const {
    const auto length = static_cast<float>(length_mm * per_mm);
    return length * length;
  }
};

/// How a comparison treats a dart that is as far as the limit except for rounding.
enum class Doubt { is_within, is_outside };

/// Factor of the square of a distance, which decides such a case: a coordinate is at most 22 (a
/// block has 16 distances, the radius of a dart beside it 6) and is rounded by 22 * 2^-24. With two
/// places and three axes, the square of a distance of at least 1 changes by at most
/// 22 * 2^-24 * 2 * 3^0.5 * 2 = 0.9e-5 of itself.
constexpr float factor_of(Doubt doubt) { return doubt == Doubt::is_within ? 1 - 2e-5F : 1 + 2e-5F; }

/// Darts after the end of a list that darts_within() may read.
inline constexpr std::size_t read_ahead = 3;

/// The darts, at most 64, whose square of the distance from `place` is less than `square` and, if
/// `own` is given, less than their own of these squares.
inline DartSet darts_within(const float* x, const float* y, const float* z, const float* own,
                            std::size_t count, const PlaceInBlock& place, float square,
                            Doubt doubt) {
  if (count == 0) return 0;
  const float factor = factor_of(doubt);
  DartSet set = 0;
#if defined(__SSE2__)
  const __m128 px = _mm_set1_ps(place.x), py = _mm_set1_ps(place.y), pz = _mm_set1_ps(place.z),
               squares = _mm_set1_ps(square), factors = _mm_set1_ps(factor);
  for (std::size_t i = 0; i < count; i += 4) {
    const __m128 dx = _mm_sub_ps(_mm_loadu_ps(x + i), px), dy = _mm_sub_ps(_mm_loadu_ps(y + i), py),
                 dz = _mm_sub_ps(_mm_loadu_ps(z + i), pz);
    const __m128 apart =
        _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
    const __m128 limit = own != nullptr ? _mm_min_ps(squares, _mm_loadu_ps(own + i)) : squares;
    const int four = _mm_movemask_ps(_mm_cmplt_ps(_mm_mul_ps(apart, factors), limit));
    set |= static_cast<DartSet>(four) << i;
  }
  return set & ~DartSet{0} >> (max_set_size - count);
#else
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - place.x, dy = y[i] - place.y, dz = z[i] - place.z;
    const float limit = own != nullptr ? std::min(square, own[i]) : square;
    set |= DartSet{(dx * dx + dy * dy + dz * dz) * factor < limit} << i;
  }
  return set;
#endif
}

/// Up to 64 darts of a block, each with its radius.
class NearDarts {
 public:
  explicit NearDarts(const BlockUnits& units) : units_(units) {}

  std::size_t size() const { return size_; }
  bool is_full() const { return size_ == max_set_size; }
  void clear() { size_ = 0; }

  /// Adds a dart; does nothing if the list is full.
  void add(const PlaceInBlock& place, double radius_mm) {
    if (is_full()) return;
    x_[size_] = place.x;
    y_[size_] = place.y;
    z_[size_] = place.z;
    own_[size_] = units_.square_of(radius_mm);
    ++size_;
  }

  /// The darts from number `first` that are nearer to a place than `radius_mm` and than their own
  /// radius: each excludes a dart of this radius from the place.
  DartSet excluding(const geometry::Point& place, double radius_mm, std::size_t first = 0,
                    Doubt doubt = Doubt::is_outside) const {
    if (first == size_) return 0;
    return darts_within(&x_[first], &y_[first], &z_[first], &own_[first], size_ - first,
                        units_.place_of(place), units_.square_of(radius_mm), doubt)
           << first;
  }

 private:
  BlockUnits units_;
  std::size_t size_ = 0;
  std::array<float, max_set_size + read_ahead> x_{}, y_{}, z_{};
  std::array<float, max_set_size + read_ahead> own_{};  // squares of radii
};

}  // namespace lamplock::points
