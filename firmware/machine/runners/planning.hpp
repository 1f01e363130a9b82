// The objects that plan: one window of a job, or one batch of lines of a program. They are never
// used at the same time, so they share their memory and one hand-over to the planning core.
//
// In:  window() or lines(), filled by the main loop while they are at home (work_exchange.hpp).
// Out: the same, planned.
// Who: the controller owns it, job runner and program runner use it; plan(): the main loop, or
//      another core that only plans.
#pragma once

#include <cstdint>
#include <new>

#include "firmware/machine/runners/line_work.hpp"
#include "firmware/machine/runners/window_plan.hpp"
#include "firmware/machine/runners/work_exchange.hpp"

namespace lamplock::machine {

class Planning {
 public:
  Planning() { new (&window_) WindowPlan; }
  Planning(const Planning&) = delete;
  Planning& operator=(const Planning&) = delete;

  WorkExchange& work_exchange() { return work_exchange_; }
  const WorkExchange& work_exchange() const { return work_exchange_; }
  WindowPlan& window() { return window_; }
  LineWork& lines() { return lines_; }

  /// Selects what is planned from now on; at home only. The previous data is lost.
  [[gnu::cold]] void use_windows() {
    if (of_lines_) new (&window_) WindowPlan;
    of_lines_ = false;
  }
  void use_lines() {
    if (!of_lines_) new (&lines_) LineWork;
    of_lines_ = true;
  }

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
  WorkExchange work_exchange_;
  bool of_lines_ = false;
  union {
    WindowPlan window_;  // NOLINT(readability-identifier-naming): they are private
    LineWork lines_;     // NOLINT(readability-identifier-naming)
  };
};

}  // namespace lamplock::machine
