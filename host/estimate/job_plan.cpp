#include "host/estimate/job_plan.hpp"

#include <fmt/format.h>

#include <memory>

#include "firmware/machine/runners/next_window.hpp"
#include "firmware/program/pulse_decoder.hpp"
#include "host/error.hpp"
#include "shared/wire/framing.hpp"
#include "shared/work_space.hpp"

namespace lamplock::estimate {
namespace {

/// The job runner's work in a job without faults: one window after the other.
class WindowStream {
 public:
  WindowStream(const job::Job& job, const PlanOptions& options)
      : job_(job),
        options_(options),
        encoder_(job, options.first),
        limits_(work_space(job.settings)) {
    decoder_.begin(job::header_from(job, options.first));
    run_.mode = static_cast<wire::JoinMode>(job.header.mode);
    run_.points_total = static_cast<std::uint32_t>(job.targets.size());
    run_.min_beats = options.min_beats;
    queue_.reset(static_cast<std::uint32_t>(options.first));
    window_.continue_at({queue_.begin(), 0});
    plan_.begin_job(job.settings, beat_ticks(job.settings), options.pace.long_tick_q16);
    for (stepper::AxisState& axis : start_.axis) axis.position_q64 = stepper::middle_of_step(0);
  }

  void run(const SeeWay& see) {
    while (window_.place().point < run_.points_total) {
      receive();
      make_plan();
      hand_out(see);
    }
  }

 private:
  /// Encodes and decodes records, so that targets are those that the machine reads.
  void receive() {
    while (encoder_.index() < job_.targets.size() && queue_.free() != 0) {
      const auto payload = encoder_.next(wire::max_payload, queue_.free());
      if (decoder_.decode(payload, queue_, limits_) == Result::ok) continue;
      throw Error(Exit::bad_input, fmt::format("point {}", decoder_.refused_index()),
                  "is refused by the decoder of the board",
                  "correct its position, laser channel or number of shots");
    }
  }

  void make_plan() {
    window_.fill_request(
        {start_.at_rest(), off_target_, options_.pace.wanted.job_speed < wire::full_job_speed});
    motion::PlanRequest& request = plan_.request();
    request.queue = &queue_;
    request.mode = run_.mode;
    request.min_beats = run_.min_beats;
    request.start = start_;
    request.follows = !off_target_;
    plan_.start(options_.pace);
    while (plan_.advance(job_.settings, job_.settings)) {
    }
    if (plan_.found()) return;
    // The same message as in the sender.
    throw Error(Exit::bad_input, fmt::format("point {}", request.points[plan_.failed()]),
                "cannot be reached within the machine's limits",
                "check speed, acceleration and beats");
  }

  void hand_out(const SeeWay& see) {
    const std::uint32_t count = plan_.count();
    for (std::uint32_t i = 0; i < count; ++i) {
      const stepper::Segment& segment = plan_.segment(i);
      see({plan_.request().points[i], plan_.beats(i), segment.shot.present,
           static_cast<std::uint32_t>(segment.ticks), plan_.tick_length_q16()});
    }
    const machine::Place next = window_.place_after(0, count);
    // Targets leave the queue with their last flash; some flashes of the next one may be planned.
    while (queue_.begin() != next.point) queue_.mark_done(queue_.begin());
    window_.continue_at(next);
    start_ = plan_.segment(count - 1).end;
    if (start_.at_rest())
      for (stepper::AxisState& axis : start_.axis) axis.speed_q62 = 0;
    off_target_ = false;
  }

  const job::Job& job_;
  const PlanOptions& options_;
  job::RecordEncoder encoder_;
  program::PulseDecoder decoder_;
  StepLimits limits_;
  motion::PointQueue queue_;
  lamp::BeamPath beam_;  ///< not configured: takes no time
  machine::RunOptions run_;
  machine::WindowPlan plan_;
  machine::NextWindow window_{queue_, beam_, run_, plan_.request()};
  motion::MotionState start_;
  bool off_target_ = true;
};

}  // namespace

void plan_job(const job::Job& job, const PlanOptions& options, const SeeWay& see) {
  std::make_unique<WindowStream>(job, options)->run(see);
}

bool waits_for_beam(const job::Job& job) {
  lamp::BeamPath path;
  path.configure(job.settings);
  lamp::Beam last;
  bool first = true;
  for (const wire::Target& target : job.targets) {
    if (target.shots == 0) continue;
    const lamp::Beam beam{target.channel, target.energy};
    if (!first && path.needs_rest(last, beam)) return true;
    last = {beam.channel, beam.energy != 0 ? beam.energy : last.energy};
    first = false;
  }
  return false;
}

}  // namespace lamplock::estimate
