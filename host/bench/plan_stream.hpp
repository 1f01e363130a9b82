// A whole stream of points planned by the firmware's planner, as the machine does it.
//
// In:  limits, mode, all points. Out: every segment and the beats of each.
// Who: `lamplock bench`, the tests of planner and stepper. This is the one place outside the
//      firmware that knows how the machine cuts a stream into windows (job_runner.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/motion/planner.hpp"

namespace lamplock::bench {

/// Every segment of a stream, and the beats of each.
struct StreamPlan {
  Result result = Result::ok;
  std::vector<stepper::Segment> segments;
  std::vector<std::int32_t> beats;

  long total_beats() const {
    long sum = 0;
    for (const std::int32_t b : beats) sum += b;
    return sum;
  }
};

/// Sees every window: the planner after planning it, and what it was asked.
using WindowObserver = std::function<void(const motion::Planner&, const motion::PlanRequest&)>;

/// How a stream is planned.
struct StreamOptions {
  motion::JoinMode mode = motion::JoinMode::free;
  std::uint32_t queued_at_once = motion::PointQueue::capacity;  ///< how far the queue is filled
};

/// Rest at the machine's zero, on lattice tick 0.
stepper::MotionState rest_at_zero();

/// Plans a stream that starts at rest at the machine's zero. Result: unreachable, with what was
/// planned before.
StreamPlan plan_stream(const motion::Limits& limits, const std::vector<motion::Target>& targets,
                       const StreamOptions& options, motion::Planner& planner,
                       const WindowObserver& observe = {});

}  // namespace lamplock::bench
