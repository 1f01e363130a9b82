// Plans one window of a job: chooses the limits, and other limits if there is no way under these.
//
// In:  a request (points, start), the requested pace, the settings.
// Out: segments of the planner, or the point that cannot be reached; how many of them to hand out.
// Who: the job runner; start() and the functions after it are short. advance() does a slice, mostly
//      less than a millisecond, a few where a window is set up, 10 ms at most (planner.hpp),
//      perhaps on another core, which then owns the whole object (work_exchange.hpp).
//
// Attempts, in this order until one finds a way:
//   wanted   limits for the shortest tick to expect and the requested job speed
//   faster   from rest, a way that fails can only be too long for so slow a machine: twice the job
//            speed
//   before   the lamp has become faster, or the job speed was reduced, and the speeds planned under
//            the old limits exceed the new ones: the old ones are used once more. At another job
//            speed that plan ends at rest, from which any limits are possible
// and then, as master of the lamp, longer ticks where they save time (period_tolerance).
//
// As slave the lamp drifts while a plan is run, so limits are the tighter the longer that takes.
// The limits wanted first hold for short_plan_ticks(), and no more of the plan is handed out; the
// next plan knows the lamp as it is then. A plan that cannot be cut so short, because its ways are
// long, jerk is limited or planning is slow, is made again with limits for long_plan_ticks, and the
// next plan begins with these.
//
// Job speed: s % is the job's speed limits times s/100, accelerations times (s/100)^2 and jerks
// times (s/100)^3, so that the same way is run more slowly. Brakes are as hard as the fastest job
// speed so far (at least 100 %) permits: all motion that still runs stops within its planned path.
#pragma once

#include <cstdint>

#include "firmware/motion/free/planner.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/job_header.hpp"

namespace lamplock::machine {

/// A job's settings at a job speed: limits of the axes scaled, never above the machine's own and
/// never below what the table permits.
settings::Values at_job_speed(const settings::Values& job, const settings::Values& own,
                              std::uint32_t percent);

/// Parameters of the limits.
struct Pace {
  std::uint32_t tick_q16 = 0;  ///< shortest tick over the nominal one
  std::uint32_t job_speed = wire::full_job_speed;
  friend bool operator==(const Pace&, const Pace&) = default;
};

/// As slave a plan that can be cut is handed out up to this time after its start: 100 ms, or 8
/// beats where these take longer.
constexpr std::uint32_t short_plan_ticks(std::uint32_t beat_ticks) {
  constexpr std::uint32_t min_ticks = ticks_per_second / 10, min_beats = 8;
  return min_beats * beat_ticks > min_ticks ? min_beats * beat_ticks : min_ticks;
}
/// As slave any other plan is handed out up to this time after its start, with limits for more
/// drift: 2 s, or twice the time of a short plan where that is longer.
constexpr std::uint32_t long_plan_ticks(std::uint32_t beat_ticks) {
  constexpr std::uint32_t min_ticks = 2 * ticks_per_second;
  const std::uint32_t ticks = 2 * short_plan_ticks(beat_ticks);
  return ticks > min_ticks ? ticks : min_ticks;
}

/// Conditions of a plan.
struct PlanPace {
  Pace wanted;                                  ///< as slave for a plan of short_ticks
  std::uint32_t long_tick_q16 = full_tick_q16;  ///< shortest tick within long_plan_ticks()
  std::uint32_t max_tick_q16 = full_tick_q16;   ///< maximum length of a tick, as master
  std::uint32_t short_ticks = 0;                ///< as slave short_plan_ticks(), otherwise 0
  std::uint32_t long_ticks = 0;                 ///< as slave long_plan_ticks(), otherwise 0
  bool may_cut = false;                         ///< a plan may be cut to short_ticks
};

/// Plans one window at a time.
class WindowPlan {
 public:
  /// A job begins, or its beat changes: limits at full job speed. The settings have been checked.
  [[gnu::cold]] void begin_job(const settings::Values& values, std::uint32_t beat_ticks,
                               std::uint32_t tick_q16);

  motion::PlanRequest& request() { return request_; }
  const motion::PlanRequest& request() const { return request_; }
  /// Begins to plan the request.
  [[gnu::cold]] void start(const PlanPace& pace);

  /// Plans a slice; false when there is nothing left to do.
  bool advance(const settings::Values& values, const settings::Values& own);
  // Results, after advance() has returned false.
  /// The target is reached; otherwise failed() is the index in the request where the way ends.
  bool found() const { return found_; }
  std::uint32_t failed() const { return planner_.failed(); }
  /// Number of segments to hand out, at least 1.
  std::uint32_t count() const { return count_; }
  /// Duration of these.
  std::uint64_t planned_ticks() const;
  const stepper::Segment& segment(std::uint32_t i) const { return planner_.segment(i); }
  std::int32_t beats(std::uint32_t i) const { return planner_.beats(i); }

  /// The plan is for ticks of this length, its limits for this shortest tick.
  std::uint32_t tick_length_q16() const { return tick_length_q16_; }
  std::uint32_t min_tick_q16() const { return pace_.tick_q16; }
  const motion::BrakeLimits& brake_limits() const { return brake_limits_; }

 private:
  enum class Step : std::uint8_t { ready, planning, over };
  enum class Attempt : std::uint8_t { wanted, before, longer };
  static constexpr std::uint32_t longer_tries = 3;
  /// A plan is not cut to fewer segments: windows would be planned again for each of them.
  static constexpr std::uint32_t min_count = 2;

  bool make_limits(const settings::Values& values, const settings::Values& own, const Pace& pace,
                   motion::Limits& limits) const;
  bool begin_attempt(const settings::Values& values, const settings::Values& own);
  const motion::Limits* attempt_limits(const settings::Values& values, const settings::Values& own);
  void set_brake_limits(const settings::Values& values, const settings::Values& own,
                        std::uint32_t tick_q16);
  void end_attempt(bool found);
  void end_wanted(bool found);
  void end_longer(bool found);
  void finish(bool found);
  bool choose_count();
  bool between_rests() const;
  std::uint32_t longer_tick_q16() const;

  motion::Planner planner_;
  motion::PlanRequest request_;
  motion::Limits limits_, new_limits_;
  motion::BrakeLimits brake_limits_;
  Pace brake_pace_;      ///< of brake_limits_
  Pace pace_;            ///< of limits_
  PlanPace conditions_;  ///< at start()
  Pace trying_;
  std::uint32_t beat_ticks_ = 1;
  std::uint32_t fastest_ = wire::full_job_speed;  ///< job speed so far
  std::uint32_t count_ = 0;
  std::uint32_t tick_length_q16_ = full_tick_q16;
  std::uint32_t longer_ = 0;    ///< tries of longer ticks so far
  std::uint64_t min_time_ = 0;  ///< of them; ticks times their length
  Step step_ = Step::over;
  Attempt attempt_ = Attempt::wanted;
  bool found_ = false;
  bool is_long_ = false;  ///< the last plan had limits for long_plan_ticks()
};

}  // namespace lamplock::machine
