// Jobs with several flashes at a point, moves without a shot, and dwells; and their checks.
#pragma once

#include "tests/board/board_cable.hpp"

namespace lamplock::test {

/// A walk in which about every third target is not a point with one shot.
inline job::Job mixed_job(const job::Profile& profile, std::size_t points, std::uint64_t seed,
                          JoinMode mode) {
  job::Job job = job_for(histogram_walk(points, seed), profile, mode);
  std::mt19937_64 random(seed);
  const Pick<int> pick(random);
  std::vector<wire::Target> targets;
  for (wire::Target target : job.targets) {
    const int kind = pick(0, 11);
    if (kind == 0) target.shots = 0;
    if (kind == 1 || kind == 2) target.shots = static_cast<std::uint8_t>(pick(2, 5));
    if (kind == 3 && pick(0, 3) == 0) target.shots = static_cast<std::uint8_t>(pick(17, 40));
    targets.push_back(target);
    if (kind != 4) continue;
    target.shots = 0;
    target.beats = static_cast<std::uint16_t>(pick(1, 12));
    targets.push_back(target);
  }
  job.targets = targets;
  job.header.points_total = static_cast<std::uint32_t>(targets.size());
  return job;
}

/// Target of each shot of a job, in order.
inline std::vector<std::size_t> ordered_shots(const job::Job& job) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < job.targets.size(); ++i)
    order.insert(order.end(), job.targets[i].shots, i);
  return order;
}

/// Every point was fired exactly as often as ordered, in order, at its place.
inline void expect_as_ordered(const Rig& rig, const job::Job& job) {
  const std::vector<std::size_t> order = ordered_shots(job);
  ASSERT_EQ(rig.shots().size(), order.size());
  ASSERT_EQ(rig.board.lattice_shots().size(), order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    ASSERT_EQ(rig.board.lattice_shots()[i].steps, job.targets[order[i]].steps)
        << "shot " << i << ", point " << order[i];
}

/// No step and no shot between the last flash before each dwell and its end.
inline void expect_dwells(const Rig& rig, const job::Job& job, double hz) {
  const auto beat = static_cast<Picoseconds>(1e12 / hz);
  std::size_t shot = 0;
  for (const wire::Target& target : job.targets) {
    shot += target.shots;
    const bool dwell = target.shots == 0 && target.beats != 0;
    if (!dwell || shot == 0) continue;
    const Picoseconds from = rig.shots()[shot - 1].at + 20 * ps_per_us;
    const Picoseconds to = from + target.beats * beat - 100 * ps_per_us;
    ASSERT_FALSE(rig.monitor.stepped(from, to)) << "dwell after shot " << shot - 1;
    ASSERT_EQ(rig.monitor.fired(from, to), 0u) << "dwell after shot " << shot - 1;
  }
}

}  // namespace lamplock::test
