// The law of the jerk: f(n)^g(k) at each step of control, and its sums.
//
// In:  n, k and the growth of both per step. Out: jerk, and for a ramp of acceleration the sums
//      that the profiles need, each in constant time. Who: printed_profile(), strict_profile().
//
// Source: patent PL 242312 B1: f = n + a, g = k + b, where a and b grow by a constant at each step.
// Units: steps of control for time, so that A = sum of J dt^3 is in mm per step^2.
#pragma once

#include <cstddef>
#include <vector>

namespace lamplock::feed_optimiser {

struct JerkLaw {
  double n = 2, k = 7;
  double step_a = 0.05, step_b = 0.05;  ///< growth of a and b per step of control

  friend bool operator==(const JerkLaw&, const JerkLaw&) = default;
};

/// Jerk at the i-th step, mm/s3. Infinite where the power overflows.
double jerk_at(const JerkLaw& law, std::size_t i);

/// Throws Error(bad_input) unless the jerk is positive and finite at the first step and does not
/// fall.
void require_law(const JerkLaw& law);

/// Sums of a law up to the largest jerk that any block permits; built once for all blocks.
class LawTable {
 public:
  /// `max_jerk`: mm/s3, above which every block limits the jerk.
  LawTable(const JerkLaw& law, double max_jerk, double period_s);

  double period_s() const { return period_s_; }
  /// dt^3
  double h() const { return h_; }
  const JerkLaw& law() const { return law_; }

 private:
  friend class JerkRamp;
  JerkLaw law_;
  double period_s_, h_;
  std::vector<double> jerk_;       ///< J_i, ascending
  std::vector<double> accel_;      ///< A_m, after m steps
  std::vector<double> accel_sum_;  ///< A_1 + ... + A_m
};

/// A ramp of acceleration from 0 with min(J_i, cap); lengths in mm and steps of control.
class JerkRamp {
 public:
  JerkRamp(const LawTable& table, double cap);

  /// min(J_i, cap), mm/s3
  double jerk(std::size_t i) const;
  /// Acceleration after m steps, mm/step^2.
  double accel(std::size_t m) const;
  /// Sum of the accelerations after 1 to m steps, mm/step.
  double accel_sum(std::size_t m) const;

 private:
  const LawTable& table_;
  double cap_;
  std::size_t capped_;  ///< first step at which the jerk is the cap
};

}  // namespace lamplock::feed_optimiser
