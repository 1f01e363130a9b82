#include "host/estimate/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/lamp/shot_scheduler.hpp"
#include "host/error.hpp"
#include "host/estimate/job_plan.hpp"
#include "host/estimate/settings_check.hpp"
#include "host/link/dialog.hpp"
#include "host/link/line_port.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/report/shot_beats.hpp"
#include "host/units.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/lamp_settings.hpp"

namespace lamplock::estimate {
namespace {

using settings::Id;

/// Points between two reports of progress.
constexpr std::size_t points_per_news = 4096;

sim::WorldConfig world_of(const settings::Values& values) {
  sim::WorldConfig world;
  world.lamp = sim::lamp_of(values);
  return world;
}

/// A run of the job, or of its begin, on the virtual board.
class Trial {
 public:
  Trial(const job::Job& job, const EstimateOptions& options)
      : board_(job.settings, world_of(job.settings)),
        transport_(board_),
        sender_(unlocked(transport_, job.settings), job, sending(options)) {}

  /// Runs until the first shot was reported, or to the end. False if the job has ended, because it
  /// fires no shot.
  bool run_to_first_shot() {
    while (sender_.status().shots == 0)
      if (!sender_.step()) return false;
    return true;
  }
  void run_to_end(const std::function<void(std::size_t)>& progress) {
    while (sender_.step())
      if (progress) progress(sender_.points_fired());
  }

  const wire::Status& status() const { return sender_.status(); }
  const sim::Shots& shots() const { return board_.world().laser().shots(); }

  machine::PlanPace plan_pace() const { return board_.controller().runner().plan_pace(); }

 private:
  /// A machine that homes is locked at its power-up.
  static link::Transport& unlocked(link::Transport& transport, const settings::Values& values) {
    if (values.whole(Id::homing) != 0) {
      link::LinePort port(transport);
      link::unlock(port);
    }
    return transport;
  }
  static link::SenderOptions sending(const EstimateOptions& options) {
    link::SenderOptions sending;
    sending.first_index = options.first;
    sending.first_fired = options.fired;
    sending.job_speed = options.job_speed;
    sending.session = link::simulated_session;
    sending.can_continue = false;
    return sending;
  }

  sim::VirtualBoard board_;
  link::SimulatedTransport transport_;
  link::JobSender sender_;
};

/// Minimum beats from one shot to the next at the maximum shot rate.
std::int32_t min_beats(const settings::Values& values) {
  const std::int64_t rate = values.milli(Id::max_shot_rate);
  return static_cast<std::int32_t>((values.milli(Id::lamp_frequency) + rate - 1) / rate);
}

/// Counts the beats of a plan by their reasons, as the shot scheduler does.
class BeatCount {
 public:
  BeatCount(std::int32_t min_beats, Estimate& estimate)
      : min_beats_(min_beats), estimate_(estimate) {}

  void add(const Way& way) {
    // Beats in which the shot rate permits no shot.
    const std::int64_t kept_back = fired_ ? min_beats_ - 1 - since_shot_ : 0;
    const auto between = static_cast<std::uint32_t>(way.beats - 1);
    const auto kept = static_cast<std::uint32_t>(std::clamp<std::int64_t>(kept_back, 0, between));
    ledger_.count(BeatReason::protection, kept);
    ledger_.count(BeatReason::moving, between - kept);
    ledger_.count(way.shot ? BeatReason::fired : BeatReason::no_point_due, 1);
    since_shot_ += way.beats;
    if (fired_) beat_ += static_cast<std::uint32_t>(way.beats), add_time(way);
    if (way.shot) shot();
  }

  void finish(const settings::Values& values) {
    estimate_.shots = ledger_.shots();
    estimate_.beats = ledger_.beats();
    estimate_.beats_by_reason = ledger_.by_reason();
    const double beat_s = 1 / in_units(values, Id::lamp_frequency);
    // A free-running lamp has its own period; otherwise beats are whole ticks.
    const bool slave = values.whole(Id::lamp_mode) == static_cast<int>(settings::LampMode::slave);
    const auto beats = static_cast<double>(estimate_.beats);
    const auto ticks = static_cast<double>(ticks_at_shot_q16_) / full_tick_q16;
    if (estimate_.beats != 0)
      estimate_.time_s = slave ? beats * beat_s : ticks / ticks_per_second + beat_s;
  }

 private:
  void add_time(const Way& way) { ticks_q16_ += std::uint64_t{way.ticks} * way.tick_q16; }
  void shot() {
    fired_ = true;
    since_shot_ = 0;
    estimate_.beat_of_shot.push_back(beat_);
    ticks_at_shot_q16_ = ticks_q16_;
  }

  std::int32_t min_beats_;
  Estimate& estimate_;
  lamp::BeatLedger ledger_;
  std::int64_t since_shot_ = 0;
  bool fired_ = false;
  std::uint32_t beat_ = 0;
  std::uint64_t ticks_q16_ = 0, ticks_at_shot_q16_ = 0;
};

void add_plan(const job::Job& job, const EstimateOptions& options, const machine::PlanPace& pace,
              Estimate& estimate) {
  const std::int32_t least = min_beats(job.settings);
  BeatCount count(least, estimate);
  std::size_t news = options.first + points_per_news;
  plan_job(job, {pace, options.first, least}, [&](const Way& way) {
    count.add(way);
    if (way.point < news) return;
    news += points_per_news;
    if (options.progress) options.progress(way.point);
  });
  count.finish(job.settings);
}

/// Adds the numbers of a completed run.
void add_run(const job::Job& job, const Trial& trial, Estimate& estimate) {
  const wire::Status& status = trial.status();
  estimate.shots = status.shots;
  estimate.beats = status.beats;
  estimate.beats_by_reason = status.beats_by_reason;
  const sim::Shots& shots = trial.shots();
  if (shots.empty()) return;
  estimate.time_s = sim::seconds(shots.back().at - shots.front().at) +
                    1 / in_units(job.settings, Id::lamp_frequency);
  estimate.beat_of_shot = report::beats_from_first(shots, job.settings);
}

void check(const job::Job& job, const EstimateOptions& options) {
  if (job.is_rows())
    throw Error(Exit::bad_input, options.input,
                "is a raster job (rows); estimate reads jobs of points only",
                "lamplock raster prints the time when it makes the job");
  check_settings(job.settings);
  if (options.first < job.targets.size()) return;
  throw Error(Exit::bad_input, fmt::format("--from {}", options.first),
              fmt::format("the job has {} points", job.targets.size()),
              "points count from 0; give a smaller number");
}

}  // namespace

Estimate estimate_job(const job::Job& job, const EstimateOptions& options) {
  check(job, options);
  Estimate estimate;
  estimate.beat_of_shot.reserve(job.targets.size() - options.first);
  Trial trial(job, options);
  const bool fires = trial.run_to_first_shot();
  const bool on_board = !fires || waits_for_beam(job);
  if (on_board) trial.run_to_end(options.progress);
  estimate.beats_before = trial.status().beats_before;
  if (!trial.shots().empty()) estimate.time_before_s = sim::seconds(trial.shots().front().at);
  if (on_board)
    add_run(job, trial, estimate);
  else
    add_plan(job, options, trial.plan_pace(), estimate);
  return estimate;
}

}  // namespace lamplock::estimate
