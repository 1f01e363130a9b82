// The objects that plan: one window of a job, or one batch of lines of a program. They are never
// used at the same time, so they share their memory and one hand-over to the planning core.
//
// In:  window() or lines(), filled by the main loop while they are at home (work_exchange.hpp).
// Out: the same, planned; the planner that the board must load.
// Who: the controller owns it, job runner and program runner use it; plan(): the main loop, or
//      another core that only plans.
//
// A board without memory for three planners loads the one that is needed (planner_kind.hpp) into
// the place of the last one:
//
//   runner     use_lines()            waits: may_hand_out() is false              hands out
//   board               missing_planner()  set_loaded(none)  copies  set_loaded(lines)
//   planner    idle ........................................................... | plans
//
// The runner selects a planner only while nothing is handed out, and hands out only when that
// planner is loaded. So no slice runs from the selection to the end of the copy, and the core that
// plans never executes memory that is being written.
#pragma once

#include <cstdint>
#include <new>

#include "firmware/machine/runners/line_work.hpp"
#include "firmware/machine/runners/planner_kind.hpp"
#include "firmware/machine/runners/window_plan.hpp"
#include "firmware/machine/runners/work_exchange.hpp"

namespace lamplock::machine {

class Planning {
 public:
  /// `loads`: the board loads planners; otherwise all of them are present.
  explicit Planning(bool loads) : loads_(loads) { new (&window_) WindowPlan; }
  Planning(const Planning&) = delete;
  Planning& operator=(const Planning&) = delete;

  WorkExchange& work_exchange() { return work_exchange_; }
  const WorkExchange& work_exchange() const { return work_exchange_; }
  WindowPlan& window() { return window_; }
  LineWork& lines() { return lines_; }

  /// Selects what is planned from now on; at home only. The previous data is lost.
  [[gnu::cold]] void use_windows(wire::JoinMode mode) {
    if (of_lines_) new (&window_) WindowPlan;
    of_lines_ = false;
    needed_ = planner_of(mode);
  }
  void use_lines() {
    if (!of_lines_) new (&lines_) LineWork;
    of_lines_ = true;
    needed_ = PlannerKind::lines;
  }

  /// The data is at home, and the planner for it is loaded.
  bool may_hand_out() const { return work_exchange_.is_owned() && planner_ready(); }
  /// The planner that the board must load; none while there is no need, or a slice may run.
  PlannerKind missing_planner() const {
    return planner_ready() || !work_exchange_.is_owned() ? PlannerKind::none : needed_;
  }
  /// What the board has loaded; none from the first change of its memory on.
  void set_loaded(PlannerKind kind) { loaded_ = kind; }

  /// Plans a slice of what is handed out, with the settings of the job and of the machine; false if
  /// there is nothing more to do.
  bool plan(const settings::Values& values, const settings::Values& own) {
    return work_exchange_.slice(
        [&] { return of_lines_ ? lines_.advance() : window_.advance(values, own); });
  }
  /// Recalls what is handed out; waits for the end of a slice. Unmasked.
  void recall() {
    work_exchange_.recall();
    while (!work_exchange_.is_owned()) {
    }
  }

 private:
  bool planner_ready() const { return !loads_ || loaded_ == needed_; }

  WorkExchange work_exchange_;
  const bool loads_;
  bool of_lines_ = false;
  PlannerKind needed_ = PlannerKind::none;  ///< none: nothing was begun yet
  PlannerKind loaded_ = PlannerKind::none;
  union {
    WindowPlan window_;  // NOLINT(readability-identifier-naming): they are private
    LineWork lines_;     // NOLINT(readability-identifier-naming)
  };
};

}  // namespace lamplock::machine
