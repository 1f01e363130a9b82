// A job that is to be done on a board, and what it is about.
//
// In:  the commands that make or read jobs. Out: what runs, reports and foresees them.
#pragma once

#include <string>
#include <vector>

#include "host/cli/board_options.hpp"
#include "host/job/job.hpp"
#include "host/points/point.hpp"

namespace lamplock::cli {

struct Work {
  std::string input;          ///< file
  points::PointCloud points;  ///< as ordered, one per target that is no pause; none of rows
  job::Job job;
  std::vector<std::string> warnings{};  ///< about the points
};

/// With --fired: the first point wants fewer flashes than it did. Throws Error(bad_input).
void take_off_fired(Work& work, const BoardOptions& options);

}  // namespace lamplock::cli
