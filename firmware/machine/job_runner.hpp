// The job runner: from queued points to committed motion and shots, and back to what was missed.
//
// In:  targets (decoder), outcomes of shots (scheduler), the lamp (beat clock), orders: hold,
//      resume, stop.
// Out: segments for the tick generator, plans of beats for the shot scheduler.
// Called from the main loop, but for plan(). One window is planned at a time, in five steps, so
// that a board with real interrupts masks beat and fill interrupts for the short ones alone:
//
//   look_ahead() unmasked finds the points of the next window
//   prepare()  masked     reads outcomes, takes back what was missed, decides whether to plan
//   plan       unmasked   a slice of it (planning.hpp, window_plan.hpp), on data that no interrupt
//                         touches, until it is complete: by the main loop, or by another core
//                         while that goes on
//   stage()    unmasked   copies what is next to the place it is handed out from, and its brake;
//                         where interrupts are masked for it, which is said once (Parts::staged)
//   commit()   masked     hands the plan out; a start from rest moves on by whole beats if planning
//                         has outlasted its margin
//
// Planning is ahead of the queues: a plan is made as soon as the one before is handed out, and
// waits for room. It is handed out in parts, for which room is there sooner, and which keep
// interrupts masked for a small part of the quickest beat only.
//
// Of the rest, what touches motion or shots (read_outcomes, brake, halt) is called masked.
//
// Who owns what while a plan is handed out (hand_over.hpp):
//
//   the planner's     plan_ with request, limits and scratch memory
//   nobody changes    the settings that plan() is given; targets from the first one in the request
//                     on, up to its known_end: they are not done yet, so no new ones take their
//                     place
//   the main loop's   everything else: queue_ (but for those targets), clock_, shots_, segments_,
//                     generator_, brake_limits_, where the next plan starts
//
// A plan that is not wanted any more is only marked so, and the planner stops after the slice it is
// in. Until then no other is begun, and who wants to change settings or to begin a job waits for
// it: Planning::recall(), or asks for plan_at_home() where it must not wait.
//
// One primitive serves start, resume, a missed flash, starvation and re-lock: plan from the state
// where committed motion ends to the points that are not done yet, in order.
//
//   points:   done | committed | provisional | planned next ... | received
//             begin()           window_.place()                   end()
//   time:     past | filled (2 ms ahead) | committed | plan_state_ | provisional | rest
//
// What is handed out always ends at rest: behind the committed segments stands a provisional one, a
// brake. The next plan, which starts at plan_state_, replaces it; one that comes too late, because
// planning took long or the host was slow, finds it begun and starts anew where it ends. So no
// delay of the main loop can end motion with speed.
//
// What a window is, with several flashes of a target and beams that need time, is in
// next_window.hpp.
//
// Where the machine is as quick as planning, or nearly so, it would starve: started at once, the
// next plan has to be there when this one ends, and any of the next few windows may take longer to
// plan or less to run. So where a plan took more than half as long as its motion lasts, the start
// comes as much later as a plan takes: the machine is a window ahead then, and starves no sooner
// than that is used up.
//
// Determinism: a window of `window_points` points is planned when all of them are known, and the
// first `commit_points` are committed; what is shorter is planned when the last point is known.
// So the plan depends on the points alone; only provisional motion that was begun changes it, and
// is counted as starvation.
#pragma once

#include <cstdint>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/shot_scheduler.hpp"
#include "firmware/machine/motion_output.hpp"
#include "firmware/machine/next_window.hpp"
#include "firmware/machine/planning.hpp"
#include "firmware/motion/point_queue.hpp"

namespace lamplock::machine {

/// How a board takes the parts of a plan: straight from commit(), or from where stage() has put
/// them before, so that commit() is short and interrupts are masked for little.
enum class Parts : std::uint8_t { straight, staged };

/// What commit() has found to hand out.
enum class Committed : std::uint8_t { nothing, part, no_way };

/// Runs one job at a time.
class JobRunner {
 public:
  [[gnu::cold]] JobRunner(lamp::BeatClock& clock, lamp::ShotScheduler& shots, MotionOutput& output,
                          Planning& planning, Parts parts);
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Starts a job whose first point has index `first`, at full job speed; the machine must be at
  /// rest, no plan handed out.
  [[gnu::cold]] void begin(const RunOptions& options, const settings::Values& values,
                           std::uint32_t first);
  /// 1..highest_job_speed percent from the next plan on.
  void set_job_speed(std::uint32_t percent) { job_speed_ = percent; }
  std::uint32_t job_speed() const { return job_speed_; }
  /// Goes on under another beat, which the clock has already; the machine is at rest, no plan is
  /// handed out and the board holds no token. What was planned and not fired is planned anew.
  [[gnu::cold]] void change_beat(const settings::Values& values, std::int32_t least_beats);
  // Points of a program (RunOptions::of_program): how many will come nobody knows.
  static constexpr std::uint32_t open_end = ~0u;
  /// False if there is no room.
  bool take(const motion::Target& target) {
    if (!queue_.push(target)) return false;
    options_.points_total = open_end;
    return true;
  }
  /// For now no more will come: what was taken is run to its end.
  void close() { options_.points_total = queue_.end(); }
  /// Every point is done, and the machine stands.
  bool drained() const { return queue_.size() == 0 && at_rest(); }
  /// Of feed and rapids, percent; from the next window on.
  void set_overrides(std::uint32_t feed_percent, std::uint32_t rapid_percent) {
    options_.feed_percent = feed_percent;
    options_.rapid_percent = rapid_percent;
  }

  motion::PointQueue& queue() { return queue_; }
  const motion::PointQueue& queue() const { return queue_; }

  /// Finds the next window, so that prepare() need not: some 100 us. Not masked, directly before
  /// it; may be left out.
  void look_ahead();
  /// Reads outcomes; true if `go` and there is a plan to be made, or one to commit.
  bool prepare(bool go);
  /// Nobody plans, and nobody will before the next prepare().
  bool plan_at_home() const;
  /// Copies what was planned to where it is handed out from (Parts::staged): in motion every beat
  /// may have a shot, and none is served during commit(). Not masked.
  void stage();
  /// Hands out a part of what was planned, unless it comes too late for what it starts from; or
  /// there is no way to failed_point().
  Committed commit();
  /// Another part of the plan can be handed out.
  bool part_waits() const { return plan_stands() == PlanStands::part; }
  /// What the hardware has done so far, nothing else.
  void read_outcomes();
  /// Brakes every axis at its limit, from the next tick to be filled.
  [[gnu::cold]] void brake();
  /// Stops dead (e-stop): the position in steps is kept, whether the motors kept it is unknown.
  [[gnu::cold]] void halt();

  /// True if nothing moves and nothing is committed.
  bool at_rest() const { return output_.at_rest(); }
  /// Every point of the job is done.
  bool complete() const { return queue_.begin() == options_.points_total; }
  /// First point that is not done, outcomes counted that prepare() has not read yet. Beat
  /// interrupt, or main loop with it masked.
  std::uint32_t first_unfired();
  bool starving() const { return starving_; }
  /// The next points wait for the shutter or the attenuator.
  bool waiting_for_beam() const { return waiting_for_beam_; }
  std::uint32_t starvations() const { return starvations_; }
  std::uint32_t failed_point() const { return failed_point_; }
  std::uint32_t misses() const { return misses_; }
  /// Shortest tick to expect over the nominal one, rounded down to a coarse grid. Masked.
  std::uint32_t shortest_tick_q16() const;
  /// Motion ended with speed; the provisional rest makes that impossible.
  bool underrun() const { return generator_.underrun(); }

  stepper::TickGenerator& generator() { return generator_; }
  const stepper::TickGenerator& generator() const { return generator_; }

 private:
  [[gnu::cold]] void clear();
  /// Counting outcomes for first_unfired() begins anew.
  void recount() { count_ = {0, queue_.begin(), 0}; }
  /// Handed out at once: some 40 us with interrupts masked, a small part of the quickest beat.
  static constexpr std::uint32_t part_segments = 8;

  /// How far the plan is.
  enum class PlanStands : std::uint8_t {
    none,     ///< nothing is planned
    at_work,  ///< it is not complete
    no_way,   ///< it has come to nothing
    full,     ///< no room for its next part
    part      ///< which can be handed out
  };
  /// What first_unfired() has counted: outcomes not read yet, up to this flash.
  struct Count {
    std::uint32_t outcomes = 0;
    std::uint32_t point = 0;
    std::uint32_t fired = 0;
  };
  [[gnu::cold]] void go_back();
  PlanStands plan_stands() const;
  std::uint32_t part() const;
  void begin_plan();
  bool may_plan();
  [[gnu::cold]] bool beam_ready();
  [[gnu::cold]] bool prepare_start();
  std::uint64_t start_beat(std::uint64_t later_ticks) const;
  /// The start waits until the next plan will be there too.
  [[gnu::cold]] bool starts_late() const;
  [[gnu::cold]] void start_later();
  void commit_plan();
  void write_segment(std::uint32_t i, std::uint64_t late_ticks, stepper::Segment& segment) const;
  void push(std::uint32_t i, std::uint64_t late_ticks, std::uint64_t& beat);
  void commit_brake();
  stepper::MotionState brake_from(const stepper::MotionState& head);
  void take_back_provisional();
  void keep_provisional();
  bool provisional_begun() const { return segments_.size() < provisional_; }

  lamp::BeatClock& clock_;
  lamp::ShotScheduler& shots_;
  const Parts parts_;
  motion::PointQueue queue_;
  MotionOutput& output_;
  stepper::SegmentQueue& segments_;
  HandOver& hand_over_;  ///< of plan_, from prepare() to commit()
  WindowPlan& plan_;     ///< in a job
  Planning& planning_;
  RunOptions options_;
  NextWindow window_;                 ///< its place() is the first flash not committed
  motion::BrakeLimits brake_limits_;  ///< of what was committed last
  bool waiting_for_beam_ = false;
  std::uint32_t job_speed_ = full_job_speed;
  stepper::TickGenerator& generator_;
  std::uint32_t first_ = 0;         ///< first point of the job
  std::uint32_t received_ = 0;      ///< end of the queue when it last grew
  std::uint64_t receive_tick_ = 0;  ///< and when that was
  bool from_rest_ = true;           ///< the next window starts on a fresh beat
  std::uint32_t handed_ = 0;        ///< segments of the plan that have been handed out
  std::uint32_t staged_ = 0;  ///< and of the next part, which lies in the queue but for its first
  bool returning_ = false;
  bool astray_ = true;   ///< the next window does not start at the target before it
  bool braked_ = false;  ///< shots handed out before a brake are not judged yet
  bool starving_ = false;
  std::uint64_t asked_tick_ = 0;     ///< when the plan was asked for
  std::uint64_t plan_ticks_ = 0;     ///< what it has taken
  stepper::MotionState plan_state_;  ///< where committed motion ends
  std::uint64_t plan_beat_ = 0;      ///< on which beat
  std::uint32_t provisional_ = 0;    ///< segments at the end of the queue that may be taken back
  stepper::MotionState rest_state_;  ///< where these end, at rest
  Place rest_next_;                  ///< and the first flash behind them
  std::uint32_t starvations_ = 0;
  std::uint32_t misses_ = 0;
  std::uint32_t failed_point_ = 0;
  Count count_;
};

}  // namespace lamplock::machine
