// Random machines and paths for tests of the line planner.
#pragma once

#include <random>

#include "tests/motion/line_machine.hpp"

namespace lamplock::test {

using LineRandom = std::mt19937_64;

inline double between(LineRandom& random, double low, double high) {
  return low * std::pow(high / low, std::uniform_real_distribution<double>(0, 1)(random));
}

/// 1 to 4 axes; steps, speeds, accelerations over a decade or two, equal for all axes or not.
inline LineMachine random_machine(LineRandom& random) {
  LineMachine m;
  m.axes = 1 + static_cast<int>(random() % 4);
  const bool alike = random() % 2 == 0;
  for (int a = 0; a < m.axes; ++a) {
    const std::size_t k = index(a), first = alike ? 0 : k;
    m.steps_mm[k] = between(random, 40, 800);
    m.speed_mm_s[k] = std::min(between(random, 10, 1000), 9e5 / m.steps_mm[k]);
    m.accel_mm_s2[k] = between(random, 100, 20000);
    m.steps_mm[k] = m.steps_mm[first];
    m.speed_mm_s[k] = m.speed_mm_s[first];
    m.accel_mm_s2[k] = m.accel_mm_s2[first];
    // In thousandths, as stored in the setting: rounding of a low jump would be visible.
    if (random() % 4 == 0) m.jump_mm_s[k] = std::round(between(random, 0.1, 20) * 1e3) / 1e3;
  }
  m.deviation_mm = between(random, 0.001, 0.1);
  return m;
}

/// Adds limits of jerk at which the acceleration rises in 0.1 to 100 ms; some axes have none.
inline void limit_jerk(LineRandom& random, LineMachine& m) {
  for (std::size_t a = 0; a < static_cast<std::size_t>(m.axes); ++a)
    if (random() % 8 != 0)
      m.jerk_m_s3[a] = std::max(0.01, m.accel_mm_s2[a] * 1e-3 / between(random, 1e-4, 0.1));
}

/// In whole steps or with fractions, half and half. Lengths over decades around `scale_mm`,
/// directions at random, slightly changed, or kept; reversals; feeds over decades, rapids, stops.
inline std::vector<LineTarget> random_lines(LineRandom& random, const LineMachine& m,
                                            std::size_t count, double scale_mm) {
  std::normal_distribution<double> normal;
  std::vector<LineTarget> targets;
  LineVector at{}, direction{};
  double mm_s = between(random, 2, 500);
  const bool whole = random() % 2 == 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto kind = random() % 8;
    const double bend = i == 0 || kind == 0 ? 1 : kind < 4 ? 0.1 : 0;
    double squares = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(m.axes); ++a) {
      direction[a] = (1 - bend) * direction[a] + bend * normal(random);
      if (kind == 7 && random() % 8 == 0) direction[a] = -direction[a];
      squares += direction[a] * direction[a];
    }
    const double length = scale_mm * between(random, 0.05, 20);
    LineTarget t;
    for (std::size_t a = 0; a < static_cast<std::size_t>(m.axes); ++a) {
      direction[a] /= std::sqrt(squares);
      at[a] += length * direction[a];
      const double steps = at[a] * m.steps_mm[a];
      put_place(t, static_cast<int>(a), whole ? std::round(steps) : steps);
    }
    if (random() % 8 == 0) mm_s = between(random, 2, 500);
    t.feed_um_min = static_cast<std::uint32_t>(mm_s * 60e3);
    t.rapid = random() % 16 == 0;
    t.exact_stop = random() % 16 == 0;
    targets.push_back(t);
  }
  return targets;
}

}  // namespace lamplock::test
