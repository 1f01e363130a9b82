// Random jobs of rows for the tests of files, records and the link.
#pragma once

#include <cstdint>
#include <random>

#include "host/job/job.hpp"

namespace lamplock::test {

/// Rows along X of one line or several, with runs of every length and power, inside the default
/// work space.
inline job::Job random_row_job(std::size_t lines, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto pick = [&random](std::int64_t from, std::int64_t to) {
    return std::uniform_int_distribution<std::int64_t>(from, to)(random);
  };
  job::Job job;
  job.header = job::make_header({}, {}, lines);
  job.header.mode = wire::mode_rows;
  job.header.origin_steps = {1, 2, 3, 0};
  StepPosition at{};
  std::uint32_t feed_milli = 6'000'000;
  while (job.rows.lines.size() < lines) {
    const bool light = !job.rows.lines.empty() && pick(0, 4) != 0;
    job::Line line{{at, light, light ? feed_milli : 0}, job.rows.runs.size(), 0};
    // Always a different position.
    const auto before = at;
    do {
      at[0] = static_cast<std::int32_t>(pick(-10'000, 10'000));
      if (!light) at[1] = static_cast<std::int32_t>(pick(-10'000, 10'000));
    } while (at[0] == before[0]);
    line.to.steps = at;
    if (light) {
      const auto count = pick(0, 3) == 0 ? pick(1, wire::max_runs_a_line) : pick(1, 20);
      for (std::int64_t i = 0; i < count; ++i)
        job.rows.runs.push_back(wire::max_run(static_cast<std::uint16_t>(pick(0, 65'535)),
                                              static_cast<std::uint32_t>(pick(1, 70))));
      line.runs = static_cast<std::size_t>(count);
      if (pick(0, 9) == 0) feed_milli = static_cast<std::uint32_t>(pick(1, 60'000'000));
    }
    job.rows.lines.push_back(line);
  }
  return job;
}

}  // namespace lamplock::test
