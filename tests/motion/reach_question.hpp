// Random questions for both widths of reach(): reach.hpp in 64 bits, scaled_reach.hpp in 32.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <ostream>
#include <random>

#include "firmware/motion/profile/reach.hpp"
#include "firmware/motion/profile/scaled_reach.hpp"

namespace lamplock::test {

/// A question for both widths: all of it in units of the narrower one.
struct Question {
  motion::AxisScale axis;
  motion::SpeedInterval from;
  std::int64_t q_q32 = 0;
  std::int32_t beats = 1;
  motion::MeanSpeed mean;

  std::int64_t limit_q32() const { return axis.q32(axis.limit_qs); }
  std::int64_t way_qs() const { return q_q32 >> (32 - axis.bits); }
  motion::SpeedRange scaled_from() const {
    return {axis.scaled(from.lo_q32), axis.scaled(from.hi_q32)};
  }
  Question mirrored() const {
    Question other = *this;
    other.from = {-from.hi_q32, -from.lo_q32};
    other.q_q32 = -q_q32;
    other.mean = {-mean.up_qs, -mean.down_qs};
    return other;
  }
  friend std::ostream& operator<<(std::ostream& out, const Question& ask) {
    return out << "from [" << ask.from.lo_q32 << ", " << ask.from.hi_q32 << "] q " << ask.q_q32
               << " beats " << ask.beats << " limit " << ask.limit_q32() << " bits "
               << ask.axis.bits;
  }
};

/// Up to `longest` beats, displacements near those of the middle of the interval, so that most can
/// be reached.
inline Question random_question(std::mt19937_64& random, int longest) {
  constexpr double unit_q32 = 4294967296.0;
  std::uniform_real_distribution<double> around(-1, 1);
  Question ask;
  ask.beats = 1 + static_cast<std::int32_t>(std::pow(longest, std::fabs(around(random)))) % longest;
  const double t = ask.beats;
  const double limit = std::min(std::pow(10.0, 1.5 * around(random)) * t, 8000.0);
  ask.axis = motion::make_scale(static_cast<std::int64_t>(limit * unit_q32));
  double a = around(random) * std::min(limit, 2 * t), b = around(random) * std::min(limit, 2 * t);
  if (a > b) std::swap(a, b);
  if (random() % 3 == 0) b = a;
  if (random() % 5 == 0) a = b = 0;
  const double q = (a + b) / 2 * t + around(random) * t * t / 2;
  const auto whole = [&ask](double x, double most) {
    const auto x_q32 = static_cast<std::int64_t>(std::clamp(x, -most, most) * unit_q32);
    return x_q32 >> (32 - ask.axis.bits) << (32 - ask.axis.bits);
  };
  ask.from = {whole(a, limit), whole(b, limit)};
  ask.q_q32 = whole(q, limit * t);
  ask.mean = motion::mean_speed(ask.way_qs(), ask.beats);
  return ask;
}

/// The two widths, with 64-bit answers. `roots`: number of roots each may round.
struct Wide {
  static constexpr double roots = 4;
  static double unit(const Question& /*ask*/) { return std::ldexp(1.0, -32); }
  static std::optional<motion::SpeedInterval> reach(const Question& ask) {
    motion::SpeedInterval to;
    if (!motion::reach(ask.from, ask.q_q32, ask.beats, ask.limit_q32(), to)) return std::nullopt;
    return to;
  }
};
struct Scaled {
  static constexpr double roots = 6;
  static double unit(const Question& ask) { return std::ldexp(1.0, -ask.axis.bits); }
  static std::optional<motion::SpeedInterval> reach(const Question& ask) {
    motion::SpeedRange to{};
    if (!motion::reach(ask.axis, ask.scaled_from(), ask.mean, ask.beats, to)) return std::nullopt;
    return motion::SpeedInterval{ask.axis.q32(to.lo_qs), ask.axis.q32(to.hi_qs)};
  }
};

/// Tolerance of a result: rounding inwards by some units next to a vertical tangent moves a root by
/// up to the root of these units.
template <class Width>
double hair(const Question& ask) {
  const double limit = std::ldexp(static_cast<double>(ask.limit_q32()), -32);
  const double unit = Width::unit(ask);
  return Width::roots * std::sqrt(ask.beats * (ask.beats + limit) * unit) + 8 * unit;
}

}  // namespace lamplock::test
