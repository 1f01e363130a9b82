// Distances from one place to a few darts. In: darts and a place. Out: a set with one bit for each
// dart. Called by the search for gaps, which spends most of its time here.
//
// A processor with SSE2 (every x86-64) compares two darts at once; elsewhere the loop for the last
// dart does all of them, with the same result.
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

/// The darts, at most 64, whose square of the distance from `place` is less than `square_mm2` and,
/// if `own_mm2` is given, less than their own of these squares.
inline DartSet darts_within(const double* x, const double* y, const double* z,
                            const double* own_mm2, std::size_t count, const geometry::Point& place,
                            double square_mm2) {
  DartSet set = 0;
  std::size_t i = 0;
#if defined(__SSE2__)
  const __m128d px = _mm_set1_pd(place.x), py = _mm_set1_pd(place.y), pz = _mm_set1_pd(place.z),
                square = _mm_set1_pd(square_mm2);
  for (; i + 2 <= count; i += 2) {
    const __m128d dx = _mm_sub_pd(_mm_loadu_pd(x + i), px),
                  dy = _mm_sub_pd(_mm_loadu_pd(y + i), py),
                  dz = _mm_sub_pd(_mm_loadu_pd(z + i), pz);
    const __m128d apart =
        _mm_add_pd(_mm_add_pd(_mm_mul_pd(dx, dx), _mm_mul_pd(dy, dy)), _mm_mul_pd(dz, dz));
    const __m128d limit =
        own_mm2 != nullptr ? _mm_min_pd(square, _mm_loadu_pd(own_mm2 + i)) : square;
    const int both = _mm_movemask_pd(_mm_cmplt_pd(apart, limit));
    set |= static_cast<DartSet>(both) << i;
  }
#endif
  for (; i < count; ++i) {
    const double dx = x[i] - place.x, dy = y[i] - place.y, dz = z[i] - place.z;
    const double limit = own_mm2 != nullptr ? std::min(square_mm2, own_mm2[i]) : square_mm2;
    set |= DartSet{dx * dx + dy * dy + dz * dz < limit} << i;
  }
  return set;
}

/// Up to 64 darts, each with its radius.
class NearDarts {
 public:
  std::size_t size() const { return size_; }
  bool is_full() const { return size_ == max_set_size; }
  void clear() { size_ = 0; }

  /// Adds a dart; does nothing if the list is full.
  void add(const geometry::Point& place, double radius_mm) {
    if (is_full()) return;
    x_[size_] = place.x;
    y_[size_] = place.y;
    z_[size_] = place.z;
    radius_mm2_[size_] = radius_mm * radius_mm;
    ++size_;
  }

  /// The darts from number `first` that are nearer to a place than `radius_mm` and than their own
  /// radius: each excludes a dart of this radius from the place.
  DartSet excluding(const geometry::Point& place, double radius_mm, std::size_t first = 0) const {
    if (first == size_) return 0;
    return darts_within(&x_[first], &y_[first], &z_[first], &radius_mm2_[first], size_ - first,
                        place, radius_mm * radius_mm)
           << first;
  }

 private:
  std::size_t size_ = 0;
  std::array<double, max_set_size> x_{}, y_{}, z_{}, radius_mm2_{};
};

}  // namespace lamplock::points
