// The program runner: from lines of a program to committed motion, without a lamp.
//
// In:  lines in steps (take), commands: overrides, hold, resume, cancel; halt.
// Out: segments for the tick generator.
// Who: the main loop, like the job runner, in four steps, so that interrupts are masked only in the
//      short ones:
//
//   prepare()  masked     reads what was run; decides whether to plan a batch or to hand it out
//   plan()     unmasked   the batch (line_work.hpp), by the main loop or by another core
//   stage()    unmasked   copies it to its place in the queue, followed by a brake
//   commit()   masked     hands it out
//
// Motion that is handed out always ends at rest: it is followed by a brake, which the next batch
// replaces. If a batch is late, because the other core or the main loop was slow, the brake has
// begun: the machine brakes, each axis separately and dark, maybe beside its path, returns dark to
// where the brake began, and continues from there as after a hold. Nothing else leaves the path:
// the planner applies holds and overrides.
//
//   time:  past | filled (2 ms ahead) | committed, at most `horizon_ticks` | end_ | brake
//
// So a command takes effect after horizon_ticks, the longest batch and the filled ticks: 30 ms at
// most, or 38 ms where jerk is limited and segments are longer (line/slice.hpp). Motion that is
// broken off (a jog, a move whose guard was triggered) brakes after the filled ticks alone.
//
// The planner counts ticks from the begin of the program; a batch planned from rest is moved to the
// present tick of the lattice. Segments have no beats. Where the lattice follows a lamp (slave) the
// lamp sets the length of ticks, so that programs and beats stay in step.
#pragma once

#include <cstdint>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/machine/runners/motion_output.hpp"
#include "firmware/machine/runners/planning.hpp"

namespace lamplock::machine {

/// Runs the lines of one program at a time.
class ProgramRunner {
 public:
  ProgramRunner(lamp::BeatClock& clock, MotionOutput& output, Planning& planning)
      : clock_(clock),
        segments_(output.segments()),
        output_(output),
        generator_(output.generator()),
        planning_(planning) {}
  ProgramRunner(const ProgramRunner&) = delete;
  ProgramRunner& operator=(const ProgramRunner&) = delete;

  /// Lines may follow; the machine is at rest, nothing is planned. Errors as motion::make_limits().
  /// Not masked: some milliseconds.
  [[gnu::cold]] Result begin(const settings::Values& values, std::uint32_t tick_q16);
  bool begun() const { return begun_; }
  /// Ends planning at once; motion that was handed out runs to its end, a rest. At rest the machine
  /// moves to the middle of its steps, which is no motion.
  void end();
  /// Accepts a line; false if there is no room now. Between begin() and end().
  bool take(const motion::LineTarget& line);

  /// Adds pixels of one power, full_power = all, to the next line that has pixels; false if there
  /// is no room now.
  [[gnu::hot]] bool add_pixels(std::uint16_t power, std::uint32_t count);
  /// The same for a run as it was received; there must be room.
  void add_run(std::uint16_t run) { generator_.beam().table().put(run); }
  /// Room for runs of pixels and for a header before the first of each line.
  std::uint32_t free_runs() const { return generator_.beam().table().free(); }
  /// Drops the pixels that were not run: only while idle().
  void forget_pixels() { generator_.beam().table().forget(); }
  /// The line of these pixels is about to be taken: sets where its powers are, and its time.
  void end_pixels(motion::LineTarget& line);
  /// The line of these pixels is not taken.
  void drop_pixels() { generator_.beam().table().drop_list(); }
  /// Pulses of lines: thousandths of a pulse per millimetre, and their length. False while accepted
  /// lines have other pulses: call again later.
  [[gnu::cold]] bool set_pulses(std::uint32_t milli_per_mm, std::uint32_t length_ns);

  /// Percent: 10 to 200, 1 to 100, 10 to 200.
  void set_overrides(std::uint32_t feed_percent, std::uint32_t rapid_percent,
                     std::uint32_t power_percent);
  /// Stops on the path and stays there.
  void hold() {
    orders_.held = true;
    end_light();
  }
  bool shines_at_rest() const { return shines_at_rest_; }
  void resume() { orders_.held = false; }
  bool held() const { return orders_.held; }
  /// Stops on the path and drops all lines; none are accepted until idle().
  void cancel();
  /// Stops at once, each axis as fast as it can, possibly beside the path, or at the end of the
  /// present brake if that is sooner. All lines are dropped, and none is accepted until the next
  /// begin(), which is due when idle(). A hold stays. Masked. `at_contact`: of a switch or a probe.
  /// In other cases a brake does not leave the work space.
  [[gnu::cold]] void abort_move(bool at_contact = false);
  bool broken_off() const { return broken_off_; }

  /// At rest: the laser has this power after the override, full_power = all, but at most
  /// `max_power`, for this number of ticks, or until end_light(), a hold, a cancel or a lower
  /// override. Masked.
  [[gnu::cold]] void shine_at_rest(std::uint16_t power, std::uint16_t max_power,
                                   std::uint32_t ticks);
  /// Ends that light, if it shines. Masked.
  [[gnu::cold]] void end_light();

  /// A motion beside the program, held and at rest: begins as soon as possible. Before resume() the
  /// caller must move the machine back. Masked.
  [[gnu::cold]] void run_detour(const stepper::Segment& motion);
  /// Brakes it.
  [[gnu::cold]] void abort_detour();
  /// The machine is at rest, its last step is out, and no motion of the program is queued.
  bool detour_finished() const;
  const motion::BrakeLimits& brake_limits() const { return brake_limits_; }

  /// A cancel or a abort_move() is in progress.
  bool cancelling() const { return orders_.cancel || (broken_off_ && !stands_); }

  /// True if there is a batch to be planned, or one to commit, or lines may be taken again. Masked.
  bool prepare();
  /// No line should be taken before the next prepare(): a batch can be handed out at once, and the
  /// next one cannot be planned before; or one may be wanted by now.
  bool batch_waits() const {
    if (!begun_) return false;
    return taken_ >= max_taken || (planning_.work_exchange().complete() && batch_fits());
  }
  void stage();
  /// True if something was handed out. Masked.
  bool commit();
  /// Stops dead: what was taken is gone. Masked.
  [[gnu::cold]] void halt();

  /// Every line was run to its end, and the machine is at rest: its last step is out. As of the
  /// last prepare().
  bool idle() const { return !begun_ || stands_; }
  /// idle(), or the motion handed out ends before more could be planned.
  bool drained() const { return !begun_ || drained_; }
  /// Estimate of the lines that can be accepted before the planner is full.
  std::uint32_t free() const;
  /// N word of the line that runs; 0 = none.
  std::uint32_t line() const;
  /// N word of the first line that was not run to its end, while the machine is at rest; 0 if it
  /// moves or the line is not known. `at_end`: the machine is in the last step of that line.
  /// Masked.
  [[gnu::cold]] std::uint32_t first_line_at_rest(bool& at_end) const;
  /// Lines that can be accepted now.
  std::uint32_t free_lines() const { return planning_.lines().inbox().free(); }
  /// Tick that is filled next, to which line() refers; whether a tick has been put out.
  std::uint64_t head() const { return generator_.head(); }
  [[gnu::cold]] bool played(std::uint64_t tick) const;
  /// Number of batches that were late.
  std::uint32_t starvations() const { return starvations_; }

 private:
  bool is_still() const;
  bool is_at_rest() const;
  bool brake_begun() const { return segments_.size() < brakes_; }
  bool wants_batch() const;
  bool batch_fits() const;
  void choose_pace();
  void hand_out();
  std::uint64_t start_tick() const;
  void write(std::uint32_t i, stepper::Segment& segment) const;
  void miss();
  void finish_batch();
  /// Lines between two calls of prepare(), which may want a batch: six milliseconds, where a piece
  /// of an arc takes 250 us, so that a batch is handed out with most of the horizon left.
  static constexpr std::uint32_t max_taken = 24;

  std::uint16_t overridden(std::uint32_t power) const;
  [[gnu::cold]] void brake_at_once(std::uint64_t rest_tick, bool anywhere);
  [[gnu::cold]] bool brake_after_segment();

  lamp::BeatClock& clock_;
  stepper::SegmentQueue& segments_;
  MotionOutput& output_;
  stepper::TickGenerator& generator_;
  Planning& planning_;
  motion::BrakeLimits brake_limits_;
  std::uint32_t tick_q16_ = full_tick_q16;  ///< shortest tick that limits were made for
  bool begun_ = false;
  bool drained_ = true;             ///< the planner has nothing left
  bool stands_ = true;              ///< idle()
  bool resting_ = true;             ///< motion handed out ends at rest, without a brake
  bool lost_ = false;               ///< the brake was run: the next batch returns to the path
  bool broken_off_ = false;         ///< the planner does not know the position
  bool shines_at_rest_ = false;     ///< the motion handed out is a dwell with light
  std::uint8_t light_percent_ = 0;  ///< power override at the begin of that dwell
  bool staged_ = false;             ///< the batch is in the queue, except for its first segment
  std::uint32_t brakes_ = 0;        ///< at the end of the queue: 0 or 1
  std::uint64_t offset_ticks_ = 0;  ///< lattice minus planner
  std::uint64_t end_tick_ = 0;      ///< end of the motion handed out, without the brake
  stepper::MotionState rest_;       ///< where the brake ends
  std::uint32_t power_percent_ = 100;
  std::uint32_t pulse_ns_ = 0;
  std::uint32_t taken_ = 0;           ///< lines since prepare(), without a batch in progress
  bool pulses_taken_ = false;         ///< by lines, since the pulses were set
  std::uint32_t pace_percent_ = 100;  ///< factor on overrides that keeps planning ahead of motion
  LineOrders orders_, given_;         ///< requested; those of the last batch
  std::uint32_t lines_ = 0;           ///< known to the planner after the last batch
  std::uint32_t starvations_ = 0;
};

}  // namespace lamplock::machine
