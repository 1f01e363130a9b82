#include "host/bench/plan_stream.hpp"

#include <algorithm>
#include <memory>

namespace lamplock::bench {
namespace {

/// Cuts one stream into windows.
class Stream {
 public:
  Stream(const motion::Limits& limits, const std::vector<wire::Target>& targets,
         const StreamOptions& options)
      : targets_(targets),
        total_(static_cast<std::uint32_t>(targets.size())),
        ahead_(std::max(options.queued_at_once, window_points + run_horizon)),
        queue_(std::make_unique<motion::PointQueue>()) {
    queue_->reset(0);
    request_.queue = queue_.get();
    request_.mode = options.mode;
    request_.limits = &limits;
    request_.start = rest_at_zero();
    plan_.segments.reserve(targets.size());
    plan_.beats.reserve(targets.size());
  }

  StreamPlan run(motion::Planner& planner, const WindowObserver& observe) {
    while (next_ < total_) {
      ask();
      std::uint32_t failed = 0;
      plan_.result = planner.plan(request_, failed);
      if (plan_.result != Result::ok) break;
      if (observe) observe(planner, request_);
      take(planner);
    }
    return std::move(plan_);
  }

 private:
  void ask() {
    while (queue_->end() < total_ && queue_->size() < ahead_) queue_->push(targets_[queue_->end()]);
    request_.count = std::min(window_points, total_ - next_);
    for (std::uint32_t i = 0; i < request_.count; ++i) request_.points[i] = next_ + i;
    request_.follows = next_ != 0;
    request_.rest_at_end = next_ + request_.count == total_;
    request_.known_end = std::min(next_ + request_.count + run_horizon, total_);
  }

  void take(const motion::Planner& planner) {
    const std::uint32_t count = request_.commits();
    for (std::uint32_t i = 0; i < count; ++i) {
      plan_.segments.push_back(planner.segment(i));
      plan_.beats.push_back(planner.beats(i));
      queue_->mark_done(next_++);
    }
    request_.start = planner.segment(count - 1).end;
  }

  const std::vector<wire::Target>& targets_;
  std::uint32_t total_, ahead_;
  std::uint32_t next_ = 0;  ///< first point not committed
  std::unique_ptr<motion::PointQueue> queue_;
  motion::PlanRequest request_;
  StreamPlan plan_;
};

}  // namespace

stepper::MotionState rest_at_zero() {
  stepper::MotionState state;
  for (stepper::AxisState& axis : state.axis) axis.position_q64 = stepper::middle_of_step(0);
  return state;
}

StreamPlan plan_stream(const motion::Limits& limits, const std::vector<wire::Target>& targets,
                       const StreamOptions& options, motion::Planner& planner,
                       const WindowObserver& observe) {
  return Stream(limits, targets, options).run(planner, observe);
}

}  // namespace lamplock::bench
