// Random jobs and records for the tests of the link.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "host/job/job.hpp"
#include "shared/wire/records.hpp"

namespace lamplock::test {

/// A job of points inside the default work space, with records of every kind.
inline job::Job random_job(std::size_t points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto pick = [&random](int from, int to) {
    return std::uniform_int_distribution<>(from, to)(random);
  };
  job::Job job;
  job.header.points_total = static_cast<std::uint32_t>(points);
  StepPosition at{};
  for (std::size_t i = 0; i < points; ++i) {
    const int reach = pick(0, 9) == 0 ? 9000 : 200;
    wire::Target target;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] += pick(-reach, reach);
      if (at[axis] < -10000 || at[axis] > 10000) at[axis] = 0;
    }
    target.steps = at;
    if (pick(0, 19) == 0) target.beats = static_cast<std::uint16_t>(pick(1, 300));
    if (pick(0, 9) == 0) target.shots = 0;
    if (target.shots != 0 && pick(0, 29) == 0) {
      target.channel = static_cast<std::uint8_t>(pick(0, 3));
      target.energy = static_cast<std::uint16_t>(pick(0, 65535));
    }
    job.targets.push_back(target);
  }
  return job;
}

inline bool same(const wire::Target& a, const wire::Target& b) {
  return a.steps == b.steps && a.beats == b.beats && a.shots == b.shots && a.channel == b.channel &&
         a.energy == b.energy;
}

}  // namespace lamplock::test
