// The motion along one block from rest to rest, in steps of control.
//
// In:  length and limits of a block, the law of the jerk. Out: numbers of steps and the distance at
//      each. Who: optimise(); CSV, chart and program are made of the distances.
//
// `printed` is the recipe that reproduces the tables of patent PL 242312 B1. Its acceleration drops
// to 0 at once before the hold and at the end, so that the real jerk there is far above the limit.
// `strict` keeps every limit at every step; its acceleration over time:
//
//     A_m        ____                  J_i grows in the first part of the ramp, its mirror image
//            .'       '.               ends the ramp; braking is the same backwards in time.
//          .'           '. ___hold____
//         /                           '.           .'
//        rise   level   fall            '.._____..'
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "host/feed_optimiser/jerk_law.hpp"
#include "host/feed_optimiser/limits.hpp"

namespace lamplock::feed_optimiser {

enum class Variant { printed, strict };

/// Length and limits of one block.
struct Task {
  double length_mm = 0;
  PathLimits limits{};
};

struct Profile {
  Variant variant = Variant::strict;
  std::size_t accelerate = 0, hold = 0, brake = 0;  ///< steps
  double jerk_cap = 0;                              ///< mm/s3, of the law
  // strict
  std::size_t rise = 0, level = 0;  ///< steps with growing, and with constant acceleration
  double scale = 1;                 ///< of the jerk, so that the block ends at its end
  // printed
  double switch_jerk = 0;  ///< from which the law is subtracted in braking, mm/s3
  double missed_mm = 0;    ///< by the simulated braking

  std::size_t steps() const { return accelerate + hold + brake; }
};

/// Throws Error(bad_input) if a block needs more steps than memory has room for.
void require_step_count(double steps);

/// The patent's recipe. `limits.jerk_mm_s3` is the limit along the path.
Profile printed_profile(const Task& task, const LawTable& table);
/// The least number of steps of control within all limits, up to rounding to steps.
Profile strict_profile(const Task& task, const LawTable& table);

/// The distance from the begin of the block before the first step and after each step: steps() + 1
/// values, the last one is exactly `length_mm`.
std::vector<double> distances(const Profile& profile, const Task& task, const LawTable& table);

/// The value of the law at each step in the way of the patent's tables, mm/s3: J_i while
/// accelerating, 0 in the hold, J_switch - J_i while braking. For `strict` the jerk itself, signed.
std::vector<double> law_values(const Profile& profile, const LawTable& table);

}  // namespace lamplock::feed_optimiser
