// A job that is to be done on a board, and what it is about.
//
// In:  the commands that make or read jobs. Out: what runs, reports and foresees them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/job/job.hpp"
#include "host/report/making.hpp"
#include "host/run/board_options.hpp"

namespace lamplock::run {

struct PreparedJob {
  std::string input;            ///< file
  geometry::PointCloud points;  ///< as ordered, one per target that is no pause; none of rows
  job::Job job;
  std::vector<std::string> warnings{};        ///< about the points
  report::Making making{};                    ///< for the report
  std::optional<settings::Values> machine{};  ///< simulated; default: the one that the job is for
};

/// With --fired: takes the flashes that were fired off the first point. Throws Error(bad_input).
void subtract_fired(PreparedJob& prepared, const BoardOptions& options);

}  // namespace lamplock::run
