// Plans a whole stream of points with the firmware's planner, like the machine.
//
// In:  limits, mode, all points. Out: every segment and the beats of each.
// Who: `lamplock bench`, the tests of planner and stepper. Outside the firmware, only this file
//      cuts a stream into windows like the machine (job_runner.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/motion/free/planner.hpp"

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

/// Called with every window: the planner after planning it, and its request.
using WindowObserver = std::function<void(const motion::Planner&, const motion::PlanRequest&)>;

/// Options of the planning.
struct StreamOptions {
  wire::JoinMode mode = wire::JoinMode::free;
  std::uint32_t queued_at_once = motion::PointQueue::capacity;  ///< points in the queue
};

/// Rest at the machine's zero, on lattice tick 0.
stepper::MotionState rest_at_zero();

/// Plans a stream that starts at rest at the machine's zero. The result may be unreachable, with
/// the plan up to that point.
StreamPlan plan_stream(const motion::Limits& limits, const std::vector<wire::Target>& targets,
                       const StreamOptions& options, motion::Planner& planner,
                       const WindowObserver& observe = {});

}  // namespace lamplock::bench
