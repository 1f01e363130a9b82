// Three axes in one vector of floats. In: numbers per axis. Out: the same operation on all axes.
// Called by the model of the planner, whose time is that of these operations.
//
// A processor with SSE2 (every x86-64) has the operations as instructions; elsewhere the plain
// class is used, whose loops of fixed length compilers turn into vectors where they can. Both give
// the same bits, as IEEE 754 fixes the result of every operation here. So an order does not depend
// on the class.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lamplock::order {

/// Four numbers, the last of which is spare: every operation treats it as the others.
class PlainLanes {
 public:
  PlainLanes() = default;
  explicit PlainLanes(float all) : values_{all, all, all, all} {}
  /// x, y, z and the spare number.
  PlainLanes(float x, float y, float z, float spare) : values_{x, y, z, spare} {}

  float operator[](std::size_t axis) const { return values_[axis]; }

  friend PlainLanes operator+(const PlainLanes& p, const PlainLanes& q) {
    return each(p, q, [](float a, float b) { return a + b; });
  }
  friend PlainLanes operator-(const PlainLanes& p, const PlainLanes& q) {
    return each(p, q, [](float a, float b) { return a - b; });
  }
  friend PlainLanes operator*(const PlainLanes& p, const PlainLanes& q) {
    return each(p, q, [](float a, float b) { return a * b; });
  }
  friend PlainLanes operator/(const PlainLanes& p, const PlainLanes& q) {
    return each(p, q, [](float a, float b) { return a / b; });
  }
  friend PlainLanes min(const PlainLanes& p, const PlainLanes& q) {
    return each(p, q, [](float a, float b) { return a < b ? a : b; });
  }
  friend PlainLanes max(const PlainLanes& p, const PlainLanes& q) {
    return each(p, q, [](float a, float b) { return a > b ? a : b; });
  }
  friend PlainLanes abs(const PlainLanes& p) {
    return each(p, p, [](float a, float) { return std::abs(a); });
  }
  friend PlainLanes sqrt(const PlainLanes& p) {
    return each(p, p, [](float a, float) { return std::sqrt(a); });
  }
  /// Per axis `then` where p < q, else `otherwise`.
  friend PlainLanes where_less(const PlainLanes& p, const PlainLanes& q, const PlainLanes& then,
                               const PlainLanes& otherwise) {
    PlainLanes result;
    for (std::size_t i = 0; i < count; ++i)
      result.values_[i] = p.values_[i] < q.values_[i] ? then.values_[i] : otherwise.values_[i];
    return result;
  }
  /// True if p < q on any axis.
  friend bool any_less(const PlainLanes& p, const PlainLanes& q) {
    bool less = false;
    for (std::size_t i = 0; i < count; ++i) less |= p.values_[i] < q.values_[i];
    return less;
  }
  friend bool operator==(const PlainLanes&, const PlainLanes&) = default;

 private:
  static constexpr std::size_t count = 4;

  template <class Operation>
  static PlainLanes each(const PlainLanes& p, const PlainLanes& q, const Operation& operation) {
    PlainLanes result;
    for (std::size_t i = 0; i < count; ++i)
      result.values_[i] = operation(p.values_[i], q.values_[i]);
    return result;
  }

  std::array<float, count> values_{};
};

#if defined(__SSE2__)

/// The same as PlainLanes.
class SseLanes {
 public:
  SseLanes() : values_(_mm_setzero_ps()) {}
  explicit SseLanes(float all) : values_(_mm_set1_ps(all)) {}
  SseLanes(float x, float y, float z, float spare) : values_(_mm_setr_ps(x, y, z, spare)) {}

  float operator[](std::size_t axis) const {
    std::array<float, 4> stored{};
    _mm_storeu_ps(stored.data(), values_);
    return stored[axis];
  }

  friend SseLanes operator+(SseLanes p, SseLanes q) { return _mm_add_ps(p.values_, q.values_); }
  friend SseLanes operator-(SseLanes p, SseLanes q) { return _mm_sub_ps(p.values_, q.values_); }
  friend SseLanes operator*(SseLanes p, SseLanes q) { return _mm_mul_ps(p.values_, q.values_); }
  friend SseLanes operator/(SseLanes p, SseLanes q) { return _mm_div_ps(p.values_, q.values_); }
  friend SseLanes min(SseLanes p, SseLanes q) { return _mm_min_ps(p.values_, q.values_); }
  friend SseLanes max(SseLanes p, SseLanes q) { return _mm_max_ps(p.values_, q.values_); }
  friend SseLanes abs(SseLanes p) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), p.values_); }
  friend SseLanes sqrt(SseLanes p) { return _mm_sqrt_ps(p.values_); }
  friend SseLanes where_less(SseLanes p, SseLanes q, SseLanes then, SseLanes otherwise) {
    const __m128 less = _mm_cmplt_ps(p.values_, q.values_);
    return _mm_or_ps(_mm_and_ps(less, then.values_), _mm_andnot_ps(less, otherwise.values_));
  }
  friend bool any_less(SseLanes p, SseLanes q) {
    return _mm_movemask_ps(_mm_cmplt_ps(p.values_, q.values_)) != 0;
  }
  friend bool operator==(SseLanes p, SseLanes q) {
    constexpr int all = 0b1111;
    return _mm_movemask_ps(_mm_cmpeq_ps(p.values_, q.values_)) == all;
  }

 private:
  SseLanes(__m128 values) : values_(values) {}

  __m128 values_;
};

using Lanes = SseLanes;

#else

using Lanes = PlainLanes;

#endif

}  // namespace lamplock::order
