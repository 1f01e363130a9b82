#include "host/run/remaining_time.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "host/error.hpp"
#include "host/estimate/estimate.hpp"
#include "host/raster/row_motion.hpp"
#include "shared/look_ahead.hpp"

namespace lamplock::run {
namespace {

using settings::Id;

/// A board reports its settings in a few ms; the host does not wait for one that knows only frames.
constexpr link::Patience quick{std::chrono::milliseconds(300), std::chrono::milliseconds(1000)};

/// Settings that decide the speed of a job; wiring and switches do not.
constexpr std::array of_the_beat{Id::lamp_mode,     Id::lamp_frequency,   Id::q_switch_delay,
                                 Id::lock_range,    Id::slew_limit,       Id::lock_edges,
                                 Id::lamp_jitter,   Id::lamp_drift,       Id::period_tolerance,
                                 Id::lamp_warm_up,  Id::max_shot_rate,    Id::shutter_open,
                                 Id::shutter_close, Id::attenuator_settle};
constexpr std::array of_axes{Id::max_rate_x, Id::acceleration_x, Id::speed_jump_x, Id::drive_lag_x,
                             Id::jerk_x};

/// After a change of the job speed: the window under way and the next one, which is planned.
constexpr std::size_t windows_at_old_speed = 2;

/// Ends an estimate that is not needed any more.
struct Cancelled {};

}  // namespace

RemainingTime::RemainingTime(job::Job job, std::size_t first, std::uint32_t job_speed)
    : job_(std::make_shared<const job::Job>(std::move(job))),
      plans_{plan_of(*job_, first, job_speed, is_cancelled_)} {}

RemainingTime::~RemainingTime() { is_cancelled_ = true; }

/// Throws Error for a job that cannot be planned: it must not begin.
RemainingTime::Plan RemainingTime::plan_of(const job::Job& job, std::size_t first,
                                           std::uint32_t job_speed,
                                           const std::atomic<bool>& is_cancelled) {
  try {
    return job.is_rows() ? plan_rows(job, job_speed)
                         : plan_points(job, first, job_speed, is_cancelled);
  } catch (const Cancelled&) {
    return {job_speed, first, {}};
  }
}

RemainingTime::Plan RemainingTime::plan_points(const job::Job& job, std::size_t first,
                                               std::uint32_t job_speed,
                                               const std::atomic<bool>& is_cancelled) {
  Plan plan{job_speed, first, {}};
  estimate::EstimateOptions options;
  options.first = first;
  options.job_speed = job_speed;
  options.progress = [&is_cancelled](std::size_t) {
    if (is_cancelled) throw Cancelled();
  };
  const estimate::Estimate estimated = estimate::estimate_job(job, options);
  if (estimated.beats == 0) return plan;
  const double beat_s = estimated.time_s / static_cast<double>(estimated.beats);
  const auto last = static_cast<double>(estimated.beats - 1);
  plan.left_s.reserve(job.targets.size() - first);
  std::size_t shots = 0;
  for (std::size_t i = first; i < job.targets.size(); ++i) {
    shots = std::min<std::size_t>(shots + job.targets[i].shots, estimated.beat_of_shot.size());
    const std::uint32_t beat = shots == 0 ? 0 : estimated.beat_of_shot[shots - 1];
    plan.left_s.push_back(static_cast<float>((last - beat) * beat_s));
  }
  return plan;
}

RemainingTime::Plan RemainingTime::plan_rows(const job::Job& job, std::uint32_t job_speed) {
  Plan plan{job_speed, 0, {}};
  const std::vector<double> ends = raster::line_ends_s(job, job_speed);
  double begin = 0;
  for (const double end : ends) {
    plan.left_s.push_back(static_cast<float>(ends.back() - begin));
    begin = end;
  }
  return plan;
}

std::optional<double> RemainingTime::Plan::at(std::size_t done) const {
  if (left_s.empty() || done < first) return std::nullopt;
  return done - first < left_s.size() ? left_s[done - first] : 0.0;
}

void RemainingTime::adopt(Plan made) {
  std::erase_if(plans_, [&made](const Plan& plan) { return plan.first >= made.first; });
  plans_.push_back(std::move(made));
}

std::optional<double> RemainingTime::planned_s(std::size_t done) const {
  double left_s = 0;
  for (std::size_t i = plans_.size(); i-- > 0;) {
    const Plan& plan = plans_[i];
    const auto from_here = plan.at(std::max(done, plan.first));
    if (!from_here) return std::nullopt;
    const bool is_last = i + 1 == plans_.size();
    left_s += *from_here - (is_last ? 0.0 : plan.at(plans_[i + 1].first).value_or(0));
    if (plan.first <= done) return left_s;
  }
  return std::nullopt;
}

/// The board plans points by windows, and is a window ahead. Lines of rows take their speed when
/// they begin.
std::size_t RemainingTime::first_not_planned(std::size_t done) const {
  if (job_->is_rows()) return done;
  const std::size_t begin = plans_.front().first;
  return begin + commit_points * ((done - begin) / commit_points + windows_at_old_speed);
}

std::optional<double> RemainingTime::left_s(std::size_t done, std::uint32_t job_speed) {
  if (auto made = next_.take()) adopt(std::move(*made));
  const auto left = planned_s(done);
  if (!left || plans_.back().job_speed == job_speed) return left;
  const std::size_t from = std::min(first_not_planned(done), job_->size() - 1);
  if (!next_.is_busy())
    next_.start([this, from, job_speed, job = job_] {
      return plan_of(*job, from, job_speed, is_cancelled_);
    });
  const double after = planned_s(from).value_or(0);
  return *left - after + after * plans_.back().job_speed / job_speed;
}

settings::Values settings_in_job(const job::Job& job, const link::BoardSettings& machine) {
  settings::Values values = job.settings;
  const auto take = [&](Id id) {
    if (machine.has(id)) values.set_milli(id, machine.values.milli(id));
  };
  for (const Id id : of_the_beat) take(id);
  for (const Id x_row : of_axes)
    for (int axis = 0; axis < max_axes; ++axis) take(settings::for_axis(x_row, axis));
  return job::apply_overrides(values, job.header);
}

job::Job job_on_machine(const job::Job& job, link::Transport& port) {
  job::Job on_machine = job;
  try {
    link::LinePort lines(port);
    on_machine.settings = settings_in_job(job, link::read_settings(lines, quick));
  } catch (const Error&) {
    // Whether it is there at all the sender finds out.
  }
  return on_machine;
}

}  // namespace lamplock::run
