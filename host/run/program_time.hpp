// The time that a program of G-code still takes, from the plan of the board's own planner.
//
// In:  a function that plans the program with changes of the overrides; the overrides now. Out:
//      seconds. Who: ProgramControl.
//
// After a change the whole program is planned again in the background, with all changes at their
// times; until that is done, the time of the old plan is scaled by the feeds.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "host/program/speed_change.hpp"
#include "host/run/background.hpp"

namespace lamplock::run {

/// The remaining time of one program.
class ProgramTime {
 public:
  using Changes = std::vector<program_run::SpeedChange>;
  /// The time of the whole program [s] with these changes; nothing if it is not known. It is called
  /// in another thread.
  using Plan = std::function<std::optional<double>(const Changes&)>;

  /// `planned_s`: without changes.
  ProgramTime(std::optional<double> planned_s, Plan plan)
      : planned_s_(planned_s), plan_(std::move(plan)) {}

  /// The time of another plan is scaled until this ends.
  bool is_planning() const { return next_.is_busy(); }
  /// Seconds to the end of a program that has run for `run_s`, without its waits, and has these
  /// overrides from now on; nothing where that is not known. Never waits for a plan.
  std::optional<double> left_s(double run_s, int feed_percent, int rapid_percent);

 private:
  std::optional<double> planned_s_;
  Plan plan_;
  Changes changes_;
  std::size_t planned_changes_ = 0;  ///< of changes_, in planned_s_
  std::size_t begun_changes_ = 0;    ///< in the plan that is being made
  Background<std::optional<double>> next_;
};

}  // namespace lamplock::run
