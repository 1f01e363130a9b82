#include "host/run/remaining_time.hpp"

#include <algorithm>
#include <array>

#include "host/error.hpp"
#include "host/estimate/estimate.hpp"

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

}  // namespace

RemainingTime::RemainingTime(const job::Job& job, std::size_t first, std::uint32_t job_speed)
    : first_(first) {
  if (job.is_rows()) return;
  estimate::EstimateOptions options;
  options.first = first;
  options.job_speed = job_speed;
  const estimate::Estimate estimated = estimate::estimate_job(job, options);
  if (estimated.beats == 0) return;
  beat_s_ = estimated.time_s / static_cast<double>(estimated.beats);
  beat_.reserve(job.targets.size() - first);
  std::size_t shots = 0;
  for (std::size_t i = first; i < job.targets.size(); ++i) {
    shots = std::min<std::size_t>(shots + job.targets[i].shots, estimated.beat_of_shot.size());
    beat_.push_back(shots == 0 ? 0 : estimated.beat_of_shot[shots - 1]);
  }
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

RemainingTime remaining_time(const job::Job& job, link::Transport& port, std::size_t first,
                             std::uint32_t job_speed) {
  if (job.is_rows()) return {};
  job::Job on_machine = job;
  try {
    link::LinePort lines(port);
    on_machine.settings = settings_in_job(job, link::read_settings(lines, quick));
  } catch (const Error&) {
    // Whether it is there at all the sender finds out.
  }
  return {on_machine, first, job_speed};
}

std::optional<double> RemainingTime::left_s(std::size_t done) const {
  if (beat_.empty() || done < first_) return std::nullopt;
  if (done - first_ >= beat_.size()) return 0.0;
  return static_cast<double>(beat_.back() - beat_[done - first_]) * beat_s_;
}

}  // namespace lamplock::run
