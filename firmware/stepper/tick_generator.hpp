// The tick generator: Bresenham in time.
//
// In:  segments (SegmentQueue).
// Out: ticks, ahead of time, as runs of constant acceleration: in blocks that end where any axis or
//      lattice bit changes (fill), or for each axis separately (fill_axes), so that an axis costs
//      nothing for changes of the others. Without a segment: ticks without motion. The gate of a
//      continuous laser is a lattice bit, high exactly in the ticks of segments that have power.
// Who: the fill interrupt of the board (lowest of the motion interrupts), when its output needs
//      ticks. Budget: no division, some twenty 32-bit products per run.
//
// Each axis distributes its steps over the ticks by its own accumulator; a minor axis does not
// depend on a major one. Remainders stay in the 64-bit fraction and are carried from block to block
// and from segment to segment for as long as the machine is powered.
//
// A drive follows its steps with a lag. So each axis reads the segments earlier than the lattice by
// a lead, the lag of its drive: at tick t of the lattice its drive does what was planned for t. The
// axis with the longest lead begins segments; the lattice, whose bits have no lead, releases them;
// in between they stay in the queue. Planning and braking start at the head, the tick up to which
// the longest lead has read: all axes will reach that state.
//
// Where two axes share two motors (CoreXY, a ganged axis: shared/kinematics.hpp), the output is the
// runs of the motors, which are made only here; such axes have the same lead. All other code, and
// all callers, use axes.
//
// A continuous laser is a reader, too. A laser that responds late has a lead; one that responds
// before the axes have arrived has a lag, and then it releases the segments. It is dark while the
// lattice is at rest, whatever it reads. Cells of a line have a separate axis (beam_axis.hpp),
// whose edges are lattice bits like the gate.
//
//   ticks:   released | read by axes with a lead ... | may be replanned
//                     tick()                         head() = tick() + longest lead
#pragma once

#include <cstdint>

#include "firmware/stepper/beam_axis.hpp"
#include "firmware/stepper/change_queue.hpp"
#include "firmware/stepper/motor_runs.hpp"
#include "firmware/stepper/segment_power.hpp"
#include "firmware/stepper/segment_queue.hpp"
#include "firmware/stepper/tick_block.hpp"

namespace lamplock::stepper {

/// Lattice pulses of the lamp trigger; period 0 = none.
struct TriggerPattern {
  std::uint32_t period_ticks = 0;  ///< a beat
  std::uint32_t width_ticks = 0;
  std::uint64_t first_tick = 0;  ///< where the first pulse starts
};

/// Runs segments. All times are ticks of the lattice.
class TickGenerator {
 public:
  /// `changes`: outputs that change at ticks of the lattice, or null.
  [[gnu::cold]] explicit TickGenerator(SegmentQueue& queue, ChangeQueue* changes = nullptr);

  /// Which motors move which axes; to be set before the first motion.
  [[gnu::cold]] void set_kinematics(const Kinematics& kinematics) { kinematics_ = kinematics; }
  const Kinematics& kinematics() const { return kinematics_; }

  /// Ticks that each axis is ahead of the lattice, the same for both axes of a pair, and those of
  /// the laser, negative for a lag; only while nothing moves.
  [[gnu::cold]] void set_leads(const PerAxis<std::uint32_t>& ticks, std::int32_t laser_ticks = 0);

  /// Shifts the arm window: the shot is decided `ticks` before it is fired.
  void set_arm_lead(std::uint32_t ticks) { arm_lead_ticks_ = ticks; }
  void set_trigger(const TriggerPattern& pattern) {
    trigger_ = pattern;
    trigger_on_ = pattern.first_tick;
  }

  /// Cells of lines, pulses of a continuous laser.
  BeamAxis& beam() { return beam_; }
  const BeamAxis& beam() const { return beam_; }

  /// Scales the power of all ticks that are filled from now on; at most 2. Main loop.
  void set_power_scale(std::uint32_t scale_q15) { power_scale_q15_ = scale_q15; }
  /// Before light at rest, whose permitted power no scale exceeds.
  void limit_power_scale() {
    if (power_scale_q15_ > full_scale_q15) power_scale_q15_ = full_scale_q15;
  }
  /// The next tick to be filled is in a segment with power. Fill interrupt masked.
  bool in_light() const {
    return laser_.left != 0 && power_axis_ >= 0 && lattice_.left != 0 && may_shine_;
  }

  /// Start of the last lamp trigger pulse that was filled; 0 = none.
  std::uint64_t last_trigger() const { return last_trigger_; }

  /// Next block, at most `max_ticks` long.
  void fill(TickBlock& block, std::uint32_t max_ticks);
  /// The next `ticks` ticks, fewer than 2^16, of every motor separately and of the lattice bits.
  /// Calls of the board, for each of them from the first tick to the last:
  ///   put_still(motor, ticks)       then set_step(motor, step) with the motor's last position
  ///   put_axis(motor, run, ticks)
  ///   put_bits(bits, ticks)
  ///   put_power(power, ticks)       of a continuous laser; where it changes evenly at most a power
  ///                                 cell, with the power in the middle of these ticks
  template <class Board>
  void fill_axes(std::uint32_t ticks, Board& board);

  /// The next tick of the lattice to be filled.
  std::uint64_t tick() const { return tick_; }
  /// The first tick that no axis has read.
  std::uint64_t head() const { return tick_ + lead_; }
  /// Ticks that the axis with the longest lead is ahead.
  std::uint32_t lead() const { return lead_; }
  /// State of all axes at the head (main loop: it is ahead of what was filled).
  MotionState state() const;
  /// Accelerations at the head; in ramps those of the straight ramp that the stairs approximate.
  PerAxis<std::int64_t> accelerations_q62() const;
  /// True if the head is in a segment.
  bool running() const { return running_; }
  /// Motion has ended with speed, or a segment was late: a fault, until halt().
  bool underrun() const { return underrun_; }
  /// The segment at the head; valid while running().
  const Segment& segment() const { return queue_.at(queue_.begun() - 1); }

  /// Replaces the motion from the head on (brake). The segment starts at state(); all segments of
  /// the queue must have begun. Fill interrupt masked.
  [[gnu::cold]] void replace(const Segment& segment);
  /// Disarms the shot at the end of the segment at the head. Fill interrupt masked.
  [[gnu::cold]] void take_back_shot();
  /// Stops dead where the machine is (e-stop): speed is lost, position kept, the queue emptied.
  [[gnu::cold]] void halt();
  /// Sets the position of every axis; at rest only (power-up, after a dead stop).
  [[gnu::cold]] void set_position(const StepPosition& steps);
  /// The same, given the positions of the motors.
  [[gnu::cold]] void set_motors(const StepPosition& motors);
  /// At rest: moves every axis to the middle of its step, the axes of a pair to the steps of their
  /// motors; this is no motion.
  [[gnu::cold]] void settle();

 private:
  /// Position of one reader in the segments that have begun.
  struct Reader {
    std::uint32_t lead = 0;     ///< ticks ahead of the lattice
    std::uint32_t segment = 0;  ///< index of its segment, or of the next one if it is in none
    std::uint32_t left = 0;     ///< ticks left in it; 0 = in none
  };
  struct Run {
    AxisRun run;
    Reader at;
    std::uint32_t left = 0;      ///< ticks left in this piece
    std::uint32_t next_run = 0;  ///< ticks of the same stair after the axis has reversed
    std::uint32_t to_turn = 0;   ///< ticks of the phase until then; 0 = it does not reverse
    std::uint16_t phase = 0;     ///< lead, cruise, tail; then there is no more
    std::uint16_t stair = 0;     ///< next one
  };
  struct PhaseView {
    std::int64_t accel_q62;
    std::uint32_t ticks, turn_ticks;
    std::uint8_t ramp;
  };
  struct Window {
    std::uint64_t on = 0, off = 0;
    void cut(std::uint64_t tick) {
      if (off > tick) off = tick;
    }
  };

  void begin_segment(std::uint64_t tick);
  void begin_segments(std::uint32_t ticks);
  template <class Board>
  void fill_axis(int axis, std::uint32_t ticks, Board& board);
  template <class Board>
  [[gnu::noinline]] void fill_motors(std::uint32_t ticks, Board& board);
  template <class Board>
  void fill_pair(const AxisPair& pair, std::uint32_t ticks, Board& board);
  template <class Board>
  static void put_motor(int motor, AxisRun run, std::uint32_t ticks, Board& board);
  AxisRun run_of_motor(const AxisPair& pair, bool second) const;
  std::uint32_t pair_ticks(const AxisPair& pair, std::uint64_t tick, std::uint32_t ticks);
  template <class Board>
  void fill_bits(std::uint32_t ticks, Board& board);
  template <class Board>
  [[gnu::noinline]] void fill_power(std::uint32_t tick, std::uint32_t ticks, Board& board) const;
  template <class Board>
  void put_stretch(PowerStretch stretch, std::uint32_t ticks, Board& board) const;
  /// The laser is in a segment with power, and the lattice is in a segment that moves or is made
  /// for light at rest.
  bool shines() const { return in_light() && beam_.lit(); }
  /// Power at a tick of the lattice (lower half of its number) and how it changes from there.
  PowerStretch power_stretch(std::uint32_t tick) const;
  std::uint32_t run_ticks(Run& run, int axis, std::uint64_t tick, std::uint32_t ticks) const;
  bool enter(Reader& reader, std::uint64_t tick) const;
  static PhaseView phase_of(const AxisProfile& profile, std::uint32_t phase);
  static PhaseView begin_phase(Run& run, const AxisProfile& profile, std::uint32_t phase);
  static bool next_stair(Run& run, const PhaseView& phase);
  static void next_piece(Run& run, const AxisProfile& profile);
  void next_piece(Run& run, int axis) const;
  static void run_on(AxisRun& run, std::uint32_t ticks);
  void advance_run(Run& run, int axis, std::uint32_t ticks) const;
  void run_to_head(Run& run, int axis) const;
  std::int64_t acceleration_q62(const Run& run, int axis) const;
  bool shorten(Reader& reader, std::uint32_t ticks) const;
  static void set_rest(Run& run);
  void enter_lattice();
  void enter_laser(std::uint64_t tick);
  void open_window();
  static void pass(Reader& reader, std::uint32_t ticks);
  void cut_windows();
  /// Up to a change, if it is among these ticks.
  static std::uint32_t limit_to(std::uint64_t change, std::uint64_t tick, std::uint32_t ticks) {
    return change > tick && change - tick < ticks ? static_cast<std::uint32_t>(change - tick)
                                                  : ticks;
  }
  std::uint32_t limit_by(const Reader& reader, std::uint64_t tick, std::uint32_t ticks) const;
  std::uint32_t wait(Run& run, int axis, std::uint64_t tick, std::uint32_t ticks) const;
  std::uint32_t limit_by_motion(std::uint32_t ticks);
  std::uint32_t limit_by_bits(std::uint64_t tick, std::uint32_t ticks) const;
  std::uint32_t limit_by_laser(std::uint64_t tick, std::uint32_t ticks);
  std::uint32_t limit_by_power(std::uint32_t ticks) const;
  std::uint8_t bits(std::uint64_t tick) const;
  void advance(std::uint32_t ticks);
  void advance_bits(std::uint64_t tick, std::uint32_t ticks);
  void release();

  SegmentQueue& queue_;
  ChangeQueue* const changes_;
  std::uint64_t tick_ = 0;
  std::uint32_t lead_ = 0;  ///< the longest of all axes
  bool running_ = false;
  bool underrun_ = false;
  bool may_shine_ = false;       ///< in the segment of the lattice
  std::int8_t power_axis_ = -1;  ///< of the segment of the laser
  std::uint32_t left_ = 0;       ///< ticks left in the segment at the head
  PerAxis<Run> runs_{};
  Kinematics kinematics_;
  Reader lattice_;  ///< bits have no lead
  Reader laser_;
  std::uint32_t laser_lag_ticks_ = 0;  ///< 0 if it has a lead
  volatile std::uint32_t power_scale_q15_ = full_scale_q15;
  BeamAxis beam_;  ///< of the segment that the laser is in
  Window window_, old_window_;
  /// where the last brake began: no earlier window continues after it
  std::uint64_t cut_tick_ = 0;
  std::uint32_t arm_lead_ticks_ = 0;
  TriggerPattern trigger_;
  std::uint64_t trigger_on_ = 0;    ///< tick of the next or present trigger pulse
  std::uint64_t last_trigger_ = 0;  ///< tick of the last one that has begun
};

template <class Board>
void TickGenerator::fill_axes(std::uint32_t ticks, Board& board) {
  begin_segments(ticks);
  if (kinematics_.coupled())
    fill_motors(ticks, board);
  else
    for (int a = 0; a < max_axes; ++a) fill_axis(a, ticks, board);
  fill_bits(ticks, board);
  tick_ += ticks;
  release();
}

template <class Board>
void TickGenerator::fill_axis(int a, std::uint32_t ticks, Board& board) {
  Run& r = runs_[index(a)];
  std::uint64_t tick = tick_ + r.at.lead;
  std::uint32_t still = 0;
  while (ticks != 0) {
    const std::uint32_t n = run_ticks(r, a, tick, ticks);
    if (r.run.is_at_rest()) {
      still += n;
    } else {
      if (still != 0) board.put_still(a, still);
      still = 0;
      board.put_axis(a, r.run, n);
    }
    advance_run(r, a, n);
    tick += n;
    ticks -= n;
  }
  if (still != 0) board.put_still(a, still);
  board.set_step(a, r.run.step());
}

template <class Board>
void TickGenerator::fill_motors(std::uint32_t ticks, Board& board) {
  for (int a = 0; a < max_axes; ++a)
    if (!kinematics_.in_pair(a)) fill_axis(a, ticks, board);
  for (const AxisPair& pair : kinematics_.pairs()) fill_pair(pair, ticks, board);
}

template <class Board>
void TickGenerator::fill_pair(const AxisPair& pair, std::uint32_t ticks, Board& board) {
  std::uint64_t tick = tick_ + runs_[pair.first].at.lead;
  while (ticks != 0) {
    const std::uint32_t n = pair_ticks(pair, tick, ticks);
    for (const bool second : {false, true})
      put_motor(pair.motor(second), run_of_motor(pair, second), n, board);
    advance_run(runs_[pair.first], pair.first, n);
    advance_run(runs_[pair.second], pair.second, n);
    tick += n;
    ticks -= n;
  }
  for (const bool second : {false, true})
    board.set_step(pair.motor(second), run_of_motor(pair, second).step());
}

template <class Board>
void TickGenerator::put_motor(int motor, AxisRun run, std::uint32_t ticks, Board& board) {
  if (run.is_at_rest()) return board.put_still(motor, ticks);
  const std::uint32_t n = ticks_one_way(run, ticks);
  board.put_axis(motor, run, n);
  if (n == ticks) return;
  run_on(run, n);
  board.put_axis(motor, run, ticks - n);
}

template <class Board>
void TickGenerator::fill_bits(std::uint32_t ticks, Board& board) {
  for (std::uint64_t tick = tick_; ticks != 0;) {
    if (lattice_.left == 0 && enter(lattice_, tick)) enter_lattice();
    const std::uint32_t n =
        limit_by_bits(tick, limit_by_laser(tick, limit_by(lattice_, tick, ticks)));
    board.put_bits(bits(tick), n);
    fill_power(static_cast<std::uint32_t>(tick), n, board);
    tick += n;
    ticks -= n;
    advance_bits(tick, n);
  }
}

template <class Board>
void TickGenerator::fill_power(std::uint32_t tick, std::uint32_t ticks, Board& board) const {
  if (!shines()) return board.put_power(0, ticks);
  while (ticks != 0) {
    const PowerStretch stretch = power_stretch(tick);
    const std::uint32_t n = stretch.ticks < ticks ? stretch.ticks : ticks;
    put_stretch(stretch, n, board);
    tick += n;
    ticks -= n;
  }
}

template <class Board>
void TickGenerator::put_stretch(PowerStretch stretch, std::uint32_t ticks, Board& board) const {
  const auto power = [scale_q15 = std::uint32_t{power_scale_q15_}](std::uint32_t power_q16) {
    return scaled_power(rounded_power(power_q16), scale_q15);
  };
  if (stretch.slope_q16 == 0) return board.put_power(power(stretch.power_q16), ticks);
  while (ticks != 0) {
    const std::uint32_t n = ticks < power_cell_ticks ? ticks : power_cell_ticks;
    board.put_power(power(stretch.power_q16 + stretch.slope_q16 * (n / 2)), n);
    stretch.power_q16 += stretch.slope_q16 * n;
    ticks -= n;
  }
}

}  // namespace lamplock::stepper
