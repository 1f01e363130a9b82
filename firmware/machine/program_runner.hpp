// The program runner: from lines of a program to committed motion, without a lamp.
//
// In:  lines in steps (take), orders: overrides, hold, resume, cancel; halt.
// Out: segments for the tick generator.
// Called from the main loop, as the job runner is, in four steps, so that interrupts are masked for
// the short ones alone:
//
//   prepare()  masked     sees what was run; decides whether to plan a batch, and hands it out
//   plan()     unmasked   the batch (line_work.hpp), by the main loop or by another core
//   stage()    unmasked   copies it to the place it is handed out from, with a brake behind it
//   commit()   masked     hands it out
//
// What is handed out always ends at rest: behind it stands a brake, which the next batch replaces.
// A batch that comes too late, because the other core or the main loop was slow, finds it begun:
// the machine brakes then, each axis by itself and dark, maybe beside its path, goes back dark to
// where that began, and on from there as after a hold. Nothing else leaves the path: holds and
// overrides are the planner's.
//
//   time:  past | filled (2 ms ahead) | committed, at most `horizon_ticks` | end_ | brake
//
// So an order is in force after horizon_ticks, the longest batch and the filled ticks: 30 ms at
// most, or 38 ms where jerk is limited and segments are longer (line_slice.hpp). What is broken off
// (a jog, a move whose guard has seen something) brakes after the filled ticks alone.
//
// The planner counts ticks from the begin of the program; what it plans from rest is moved to where
// the lattice is by then. Segments know nothing of beats. Where the lattice follows a lamp (slave)
// ticks are as long as the lamp makes them, so that a program and the beats keep step.
#pragma once

#include <cstdint>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/machine/motion_output.hpp"
#include "firmware/machine/planning.hpp"

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

  /// Lines may come from now on; the machine is at rest, nothing is planned. Errors as
  /// motion::make_limits(). Not masked: some milliseconds.
  [[gnu::cold]] Result begin(const settings::Values& values, std::uint32_t tick_q16);
  bool begun() const { return begun_; }
  /// Nothing is planned any more, at once; what was handed out goes on to its end, which is a rest.
  /// At rest the machine is in the middle of its steps then, which is no motion.
  void end();
  /// Takes a line; false if there is no room now. Between begin() and end().
  bool take(const motion::LineTarget& line);

  /// So many pixels more with this power, full_power = all, of the next line that has them; false
  /// if there is no room now.
  [[gnu::cold]] bool add_pixels(std::uint16_t power, std::uint32_t count);
  /// The same, as it came; there must be room.
  void add_run(std::uint16_t run) { generator_.beam().table().put(run); }
  /// Places for runs of pixels, and for a header before the first of each line.
  std::uint32_t free_runs() const { return generator_.beam().table().free(); }
  /// What was not run will not be: idle().
  void forget_pixels() { generator_.beam().table().forget(); }
  /// That line is about to be taken: where its powers are.
  std::uint16_t end_pixels() { return generator_.beam().table().end_list(); }
  /// It will not come.
  void drop_pixels() { generator_.beam().table().drop_list(); }
  /// What lines with pulses have: so many thousandths of one a millimetre, each so long. False
  /// while that has to wait: lines that were taken have others.
  [[gnu::cold]] bool set_pulses(std::uint32_t milli_per_mm, std::uint32_t length_ns);

  /// 10 to 200, 1 to 100, 10 to 200.
  void set_overrides(std::uint32_t feed_percent, std::uint32_t rapid_percent,
                     std::uint32_t power_percent);
  /// Comes to rest on the path and stays there.
  void hold() { orders_.held = true; }
  void resume() { orders_.held = false; }
  bool held() const { return orders_.held; }
  /// Comes to rest on the path and forgets all lines; none are taken until idle().
  void cancel();
  /// Comes to rest at once, each axis as it can, beside the path if need be, or where it is braked
  /// to already if that is sooner: what was taken is gone, and nothing is taken until the next
  /// begin(), which is due when idle(). A hold stays. Masked.
  /// `at_contact`: of a switch or a probe. Elsewhere a brake does not leave the work space.
  [[gnu::cold]] void break_off(bool at_contact = false);
  bool broken_off() const { return broken_off_; }

  /// A motion beside the program, held and at rest: begins as soon as can be. Before resume()
  /// others have to bring the machine back. Masked.
  [[gnu::cold]] void run_aside(const stepper::Segment& motion);
  /// Brakes it.
  [[gnu::cold]] void break_off_aside();
  /// The machine stands, its last step is out, and nothing of the program is on its way.
  bool stands_aside() const;
  const motion::BrakeLimits& brake_limits() const { return brake_limits_; }

  /// Either is under way.
  bool cancelling() const { return orders_.cancel || (broken_off_ && !stands_); }

  /// True if there is a batch to be planned, or one to commit. Masked.
  bool prepare();
  /// A batch can be handed out at once, which whoever plans waits for.
  bool batch_waits() const { return begun_ && planning_.hand_over().complete() && batch_fits(); }
  void stage();
  /// True if something was handed out. Masked.
  bool commit();
  /// Stops dead: what was taken is gone. Masked.
  [[gnu::cold]] void halt();

  /// Every line was run to its end, and the machine stands: its last step is out. As of the last
  /// prepare().
  bool idle() const { return !begun_ || stands_; }
  /// As idle(), and what is handed out is at its end, or will be before anything could be planned.
  bool drained() const { return !begun_ || drained_; }
  /// Lines that can be taken before the planner is full, about.
  std::uint32_t free() const;
  /// N word of the line that is run; 0 = none.
  std::uint32_t line() const;
  /// The same of the first line that was not run to its end, while the machine stands; 0 where it
  /// does not, or that is not known. `at_end`: it stands in the last step of that. Masked.
  [[gnu::cold]] std::uint32_t first_line_at_rest(bool& at_end) const;
  /// Lines that can be taken now.
  std::uint32_t free_lines() const { return planning_.lines().inbox().free(); }
  /// Tick that is filled next, of which line() is; and whether it has been put out since.
  std::uint64_t head() const { return generator_.head(); }
  [[gnu::cold]] bool played(std::uint64_t tick) const;
  /// How often a batch came too late.
  std::uint32_t starvations() const { return starvations_; }

 private:
  bool is_still() const;
  bool stands() const;
  bool brake_begun() const { return segments_.size() < brakes_; }
  bool wants_batch() const;
  bool batch_fits() const;
  void choose_pace();
  void hand_out();
  std::uint64_t start_tick() const;
  void write(std::uint32_t i, stepper::Segment& segment) const;
  void miss();
  void finish_batch();
  [[gnu::cold]] void brake_at_once(std::uint64_t rest_tick, bool anywhere);
  [[gnu::cold]] bool brake_after_segment();

  lamp::BeatClock& clock_;
  stepper::SegmentQueue& segments_;
  MotionOutput& output_;
  stepper::TickGenerator& generator_;
  Planning& planning_;
  motion::BrakeLimits brake_limits_;
  std::uint32_t tick_q16_ = full_tick_q16;  ///< shortest that limits were made for
  bool begun_ = false;
  bool drained_ = true;             ///< the planner has nothing left
  bool stands_ = true;              ///< idle()
  bool resting_ = true;             ///< what is handed out ends at rest, without a brake
  bool lost_ = false;               ///< the brake was run: the next batch goes back to the path
  bool broken_off_ = false;         ///< the planner knows nothing of where the machine is
  bool staged_ = false;             ///< the batch lies in the queue, but for its first segment
  std::uint32_t brakes_ = 0;        ///< at the end of the queue: 0 or 1
  std::uint64_t offset_ticks_ = 0;  ///< lattice over planner
  std::uint64_t end_tick_ = 0;      ///< where what is handed out ends, without the brake
  stepper::MotionState rest_;       ///< where the brake ends
  std::uint32_t power_percent_ = 100;
  std::uint32_t pulse_ns_ = 0;
  bool pulses_taken_ = false;         ///< by lines, since others were set
  std::uint32_t pace_percent_ = 100;  ///< of the overrides, so that planning keeps ahead
  LineOrders orders_, given_;         ///< wanted; those of the last batch
  std::uint32_t lines_ = 0;           ///< known to the planner after the last batch
  std::uint32_t starvations_ = 0;
};

}  // namespace lamplock::machine
