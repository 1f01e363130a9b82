// What is planned: one window of a job, or one batch of lines of a program. Both never at once, so
// they share their memory, and there is one hand-over to whoever plans.
//
// In:  window() or lines(), filled by the main loop while they are at home (hand_over.hpp).
// Out: the same, worked on.
// Who: the controller owns it, job runner and program runner use it; plan() is called by the main
//      loop, or by another core that does nothing else.
#pragma once

#include <cstdint>
#include <new>

#include "firmware/machine/hand_over.hpp"
#include "firmware/machine/line_work.hpp"
#include "firmware/machine/window_plan.hpp"

namespace lamplock::machine {

class Planning {
 public:
  Planning() { new (&window_) WindowPlan; }
  Planning(const Planning&) = delete;
  Planning& operator=(const Planning&) = delete;

  HandOver& hand_over() { return hand_over_; }
  const HandOver& hand_over() const { return hand_over_; }
  WindowPlan& window() { return window_; }
  LineWork& lines() { return lines_; }

  /// What is planned from now on; at home only. What was there before is gone.
  [[gnu::cold]] void use_windows() {
    if (of_lines_) new (&window_) WindowPlan;
    of_lines_ = false;
  }
  void use_lines() {
    if (!of_lines_) new (&lines_) LineWork;
    of_lines_ = true;
  }

  /// A slice of what is handed out, for a job's settings on a machine with its own; false if there
  /// is nothing more to do.
  bool plan(const settings::Values& values, const settings::Values& own) {
    return hand_over_.slice(
        [&] { return of_lines_ ? lines_.advance() : window_.advance(values, own); });
  }
  /// Takes back what is handed out; waits for the end of a slice. Unmasked.
  void recall() {
    hand_over_.recall();
    while (!hand_over_.at_home()) {
    }
  }

 private:
  HandOver hand_over_;
  bool of_lines_ = false;
  union {
    WindowPlan window_;  // NOLINT(readability-identifier-naming): they are private
    LineWork lines_;     // NOLINT(readability-identifier-naming)
  };
};

}  // namespace lamplock::machine
