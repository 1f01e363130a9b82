#include "host/cli/foresight.hpp"

#include <algorithm>
#include <array>

#include "host/error.hpp"
#include "host/estimate/estimate.hpp"

namespace lamplock::cli {
namespace {

using settings::Id;

/// A board tells its settings in a few ms; one that speaks only frames should not be waited for.
constexpr link::Patience quick{std::chrono::milliseconds(300), std::chrono::milliseconds(1000)};

/// What decides how fast a job goes; wiring and switches are the machine's own business.
constexpr std::array of_the_beat{Id::lamp_mode,     Id::lamp_frequency,   Id::q_switch_delay,
                                 Id::lock_range,    Id::slew_limit,       Id::lock_edges,
                                 Id::lamp_jitter,   Id::lamp_drift,       Id::period_tolerance,
                                 Id::lamp_warm_up,  Id::max_shot_rate,    Id::shutter_open,
                                 Id::shutter_close, Id::attenuator_settle};
constexpr std::array of_axes{Id::max_rate_x, Id::acceleration_x, Id::speed_jump_x, Id::drive_lag_x,
                             Id::jerk_x};

}  // namespace

Foresight::Foresight(const job::Job& job, std::size_t first, std::uint32_t job_speed)
    : first_(first) {
  if (job.is_rows()) return;
  estimate::EstimateOptions options;
  options.first = first;
  options.job_speed = job_speed;
  const estimate::Estimate foreseen = estimate::estimate_job(job, options);
  if (foreseen.beats == 0) return;
  beat_s_ = foreseen.time_s / static_cast<double>(foreseen.beats);
  beat_.reserve(job.targets.size() - first);
  std::size_t shots = 0;
  for (std::size_t i = first; i < job.targets.size(); ++i) {
    shots = std::min<std::size_t>(shots + job.targets[i].shots, foreseen.beat_of_shot.size());
    beat_.push_back(shots == 0 ? 0 : foreseen.beat_of_shot[shots - 1]);
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

Foresight foresee(const job::Job& job, link::Transport& port, std::size_t first,
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

std::optional<double> Foresight::left_s(std::size_t done) const {
  if (beat_.empty() || done < first_) return std::nullopt;
  if (done - first_ >= beat_.size()) return 0.0;
  return static_cast<double>(beat_.back() - beat_[done - first_]) * beat_s_;
}

}  // namespace lamplock::cli
