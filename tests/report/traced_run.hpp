// A job on the virtual board with a motion trace and a monitor of its pins.
#pragma once

#include "host/report/motion_series.hpp"
#include "tests/board/rig.hpp"

namespace lamplock::test {

struct TracedRun {
  TracedRun(const job::Profile& profile, const job::Job& job, const sim::BeatWindow& window,
            const sim::LampConfig& lamp = {},
            sim::MotionTrace::Zero zero = sim::MotionTrace::Zero::first_shot)
      : settings(profile.settings), rig(profile, lamp), trace(rig.board, window, zero) {
    EXPECT_EQ(run_job(rig, job).end, link::JobEnd::done);
  }
  report::MotionSeries series(const sim::BeatWindow& window,
                              report::Fit fit = report::Fit::motion) const {
    return motion_series(trace, settings, window, fit);
  }

  settings::Values settings;
  Rig rig;
  sim::MotionTrace trace;
};

inline constexpr sim::BeatWindow all_beats{-1'000'000, 1'000'000};

}  // namespace lamplock::test
