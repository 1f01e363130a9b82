// The job runner: from queued points to committed motion and shots, and back to missed points.
//
// In:  targets (decoder), outcomes of shots (scheduler), the lamp (beat clock), commands: hold,
//      resume, stop.
// Out: segments for the tick generator, plans of beats for the shot scheduler.
// Who: the main loop, except for plan(). One window is planned at a time, in five steps, so that a
//      board with real interrupts masks beat and fill interrupts only in the short ones:
//
//   look_ahead() unmasked finds the points of the next window
//   prepare()  masked     reads outcomes, takes back missed points, decides whether to plan
//   plan       unmasked   a slice of it (planning.hpp, window_plan.hpp), on data that no interrupt
//                         uses, until it is complete: by the main loop or another core
//   stage()    unmasked   copies the next part to its place in the queue, and its brake; for boards
//                         that mask interrupts (HandoutMode::staged)
//   commit()   masked     hands the plan out; a start from rest moves by whole beats if planning
//                         took longer than its margin
//
// Planning is ahead of the queues: a plan is made as soon as the previous one is handed out, and
// waits for room. It is handed out in parts, because room for a part is available earlier, and a
// part masks interrupts only for a small part of the shortest beat. As slave a plan is made only
// plan_ahead_ticks before the committed motion ends, or twice the time of the slowest plan
// of the job where that is more: its limits are for the lamp as it is then, and the shorter the
// time until the plan has been run, the less the lamp can drift.
//
// The other functions that change motion or shots (read_outcomes, brake, halt) are called masked.
//
// Ownership while a plan is handed out (work_exchange.hpp):
//
//   planner           plan_ with request, limits and scratch memory
//   constant          the settings that plan() is given; targets from the first one in the request
//                     on, up to its known_end: they are not done yet, so no others replace
//                     them
//   main loop         everything else: queue_ (except for those targets), clock_, shots_,
//                     segments_, generator_, brake_limits_, where the next plan starts
//
// A plan that is no longer needed is only marked so, and the planner stops after its present slice.
// Until then no other plan is begun; code that changes settings or begins a job waits for it with
// Planning::recall(), or, where it must not wait, polls plan_at_home().
//
// One primitive serves start, resume, a missed flash, starvation and re-lock: plan from the state
// where committed motion ends to the points that are not done yet, in order.
//
//   points:   done | committed | provisional | planned next ... | received
//             begin()           window_.place()                   end()
//   time:     past | filled (2 ms ahead) | committed | plan_state_ | provisional | rest
//
// Motion that is handed out always ends at rest: the last segment is provisional, a brake. The next
// plan, which starts at plan_state_, replaces it. If that plan is late, because planning or the
// host was slow, the brake has begun, and the next plan starts where the brake ends. So no delay of
// the main loop can end motion with speed.
//
// next_window.hpp defines a window: several flashes of a target, beams that need time.
//
// Where motion takes about as long as planning, the machine would starve: after a start at once,
// the next plan must be ready when this one ends, and any of the next few windows may take longer
// to plan or less to run. So where a plan took more than half of the duration of its motion, the
// start is delayed by the time of one plan: the machine is then a window ahead, and starves only
// when that reserve is used up.
//
// Determinism: a window of `window_points` points is planned when all of them are known, and the
// first `commit_points` are committed; a shorter one is planned when the last point is known. So
// the plan depends on the points alone; only provisional motion that was begun changes it, and is
// counted as starvation.
#pragma once

#include <cstdint>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/shot_scheduler.hpp"
#include "firmware/machine/runners/motion_output.hpp"
#include "firmware/machine/runners/next_window.hpp"
#include "firmware/machine/runners/planning.hpp"
#include "firmware/motion/point_queue.hpp"

namespace lamplock::machine {

/// How a board accepts the parts of a plan: directly from commit(), or copied by stage()
/// beforehand, so that commit() is short and masks interrupts for less time.
enum class HandoutMode : std::uint8_t { straight, staged };

/// Result of commit().
enum class Committed : std::uint8_t { nothing, part, no_way };

/// Runs one job at a time.
class JobRunner {
 public:
  [[gnu::cold]] JobRunner(lamp::BeatClock& clock, lamp::ShotScheduler& shots, MotionOutput& output,
                          Planning& planning, HandoutMode parts);
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Starts a job whose first point has index `first`, at full job speed; the machine must be at
  /// rest, no plan handed out.
  [[gnu::cold]] void begin(const RunOptions& options, const settings::Values& values,
                           std::uint32_t first);
  /// A job was begun and not ended; its points may all be done.
  bool begun() const { return begun_; }
  /// No more points are run.
  void end() { begun_ = false; }
  /// 1 to max_job_speed percent from the next plan on.
  void set_job_speed(std::uint32_t percent) { job_speed_ = percent; }
  std::uint32_t job_speed() const { return job_speed_; }
  /// Continues with another beat, which the clock has already; the machine is at rest, no plan is
  /// handed out and the board holds no token. What was planned and not fired is planned again.
  [[gnu::cold]] void change_beat(const settings::Values& values, std::int32_t min_beats);
  // Points of a program (RunOptions::of_program): their number is not known beforehand.
  static constexpr std::uint32_t open_end = ~0u;
  /// False if there is no room.
  bool take(const wire::Target& target) {
    if (!queue_.push(target)) return false;
    options_.points_total = open_end;
    return true;
  }
  /// No more points for now: those that were accepted run to their end.
  void close() { options_.points_total = queue_.end(); }
  /// Every point is done, and the machine is at rest.
  bool drained() const { return queue_.size() == 0 && at_rest(); }
  /// Overrides of feed rate and rapids, percent; from the next window on.
  void set_overrides(std::uint32_t feed_percent, std::uint32_t rapid_percent) {
    options_.feed_percent = feed_percent;
    options_.rapid_percent = rapid_percent;
  }

  motion::PointQueue& queue() { return queue_; }
  const motion::PointQueue& queue() const { return queue_; }

  /// Finds the next window and so shortens prepare() by some 100 us. Not masked, directly before
  /// prepare(); optional.
  void look_ahead();
  /// Reads outcomes; true if `go` and there is a plan to make or to commit.
  bool prepare(bool go);
  /// No plan is being made, and none will be before the next prepare().
  bool plan_at_home() const;
  /// Copies the plan to where it is handed out from (HandoutMode::staged). In motion every beat may
  /// have a shot, and none is served during commit(). Not masked.
  void stage();
  /// Hands out a part of the plan, unless it is too late for its start; no_way: failed_point()
  /// cannot be reached.
  Committed commit();
  /// Another part of the plan can be handed out.
  bool part_waits() const { return plan_stands() == PlanStands::part; }
  /// Only reads what the hardware has done so far.
  void read_outcomes();
  /// Brakes every axis at its limit, from the next tick to be filled.
  [[gnu::cold]] void brake();
  /// Stops dead (e-stop): the position in steps is kept; the motors may have lost theirs.
  [[gnu::cold]] void halt();

  /// True if nothing moves and nothing is committed.
  bool at_rest() const { return output_.at_rest(); }
  /// Every point of the job is done.
  bool complete() const { return queue_.begin() == options_.points_total; }
  /// First point that is not done, including outcomes that prepare() has not read yet. Beat
  /// interrupt, or main loop with it masked.
  std::uint32_t first_unfired();
  bool starving() const { return starving_; }
  /// The next points wait for the shutter or the attenuator.
  bool waiting_for_beam() const { return waiting_for_beam_; }
  std::uint32_t starvations() const { return starvations_; }
  std::uint32_t failed_point() const { return failed_point_; }
  std::uint32_t misses() const { return misses_; }
  /// Shortest tick to expect over the nominal one while a plan is run that lasts long, at most
  /// nominal: for limits that hold from one plan to the next. Masked.
  std::uint32_t lasting_min_tick_q16() const;
  /// Conditions of a plan that is made now. Masked.
  [[gnu::cold]] PlanPace plan_pace() const;
  /// Motion ended with speed; the provisional brake prevents that.
  bool underrun() const { return generator_.underrun(); }

  stepper::TickGenerator& generator() { return generator_; }
  const stepper::TickGenerator& generator() const { return generator_; }

 private:
  [[gnu::cold]] void clear();
  /// Restarts the counting of outcomes for first_unfired().
  void recount() { count_ = {0, queue_.begin(), 0}; }
  /// Size of a part: some 40 us with interrupts masked, a small part of the shortest beat.
  static constexpr std::uint32_t part_segments = 8;

  /// Progress of the plan.
  enum class PlanStands : std::uint8_t {
    none,     ///< nothing is planned
    at_work,  ///< not complete
    no_way,   ///< a target cannot be reached
    full,     ///< no room for its next part
    part      ///< the next part can be handed out
  };
  /// Position of the count in first_unfired(): outcomes not read yet, up to this flash.
  struct Count {
    std::uint32_t outcomes = 0;
    std::uint32_t point = 0;
    std::uint32_t fired = 0;
  };
  [[gnu::cold]] void go_back();
  PlanStands plan_stands() const;
  std::uint32_t part() const;
  [[gnu::cold]] void begin_plan();
  bool may_plan();
  std::uint32_t ahead_ticks() const;
  [[gnu::cold]] bool plan_is_due() const;
  [[gnu::cold]] bool beam_ready();
  [[gnu::cold]] bool prepare_start();
  std::uint64_t start_beat(std::uint64_t later_ticks) const;
  /// The start waits until the next plan is ready too.
  [[gnu::cold]] bool starts_late() const;
  [[gnu::cold]] void start_later();
  [[gnu::cold]] void time_plan();
  void commit_plan();
  void write_segment(std::uint32_t i, std::uint64_t late_ticks, stepper::Segment& segment) const;
  void push(std::uint32_t i, std::uint64_t late_ticks, std::uint64_t& beat);
  void commit_brake();
  stepper::MotionState brake_from(const stepper::MotionState& head);
  void take_back_provisional();
  [[gnu::cold]] void keep_provisional();
  bool provisional_begun() const { return segments_.size() < provisional_; }

  lamp::BeatClock& clock_;
  lamp::ShotScheduler& shots_;
  const HandoutMode parts_;
  motion::PointQueue queue_;
  MotionOutput& output_;
  stepper::SegmentQueue& segments_;
  WorkExchange& work_exchange_;  ///< of plan_, from prepare() to commit()
  WindowPlan& plan_;             ///< in a job
  Planning& planning_;
  RunOptions options_;
  NextWindow window_;                 ///< its place() is the first flash not committed
  motion::BrakeLimits brake_limits_;  ///< of the motion committed last
  bool waiting_for_beam_ = false;
  std::uint32_t job_speed_ = wire::full_job_speed;
  stepper::TickGenerator& generator_;
  std::uint32_t first_ = 0;         ///< first point of the job
  std::uint32_t received_ = 0;      ///< end of the queue when it last grew
  std::uint64_t receive_tick_ = 0;  ///< when that was
  bool from_rest_ = true;           ///< the next window starts on a fresh beat
  std::uint32_t handed_ = 0;        ///< segments of the plan that have been handed out
  /// segments of the next part that are in the queue; its first is copied by commit()
  std::uint32_t staged_ = 0;
  bool begun_ = false;
  bool returning_ = false;
  bool off_target_ = true;  ///< the next window does not start at the target before it
  bool braked_ = false;     ///< shots handed out before a brake are not judged yet
  bool starving_ = false;
  std::uint64_t asked_tick_ = 0;     ///< when the plan was requested
  std::uint64_t plan_ticks_ = 0;     ///< planning time used so far
  stepper::MotionState plan_state_;  ///< where committed motion ends
  std::uint64_t plan_beat_ = 0;      ///< beat at that moment
  std::uint32_t provisional_ = 0;    ///< segments at the end of the queue that may be taken back
  stepper::MotionState rest_state_;  ///< where these end, at rest
  Place rest_next_;                  ///< the first flash after them
  std::uint32_t starvations_ = 0;
  std::uint32_t misses_ = 0;
  std::uint32_t slowest_plan_ticks_ = 0;  ///< the longest planning time of this job
  std::uint32_t failed_point_ = 0;
  Count count_;
};

}  // namespace lamplock::machine
