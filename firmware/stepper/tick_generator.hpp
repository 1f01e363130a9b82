// The tick generator: Bresenham in time.
//
// In:  segments (SegmentQueue).
// Out: blocks of ticks, ahead of time; when there is no segment, blocks of standing still.
// Called by the fill interrupt of the board (lowest of the motion interrupts) whenever its output
// wants more; budget: no division, a few 64-bit products per axis and block.
//
// Each axis distributes its steps over the ticks by its own accumulator; nothing ties a minor axis
// to a major one. Remainders stay in the 64-bit fraction and are carried from block to block and
// from segment to segment for as long as the machine is powered.
#pragma once

#include <cstdint>

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
  TickGenerator();

  /// How the arm window is shifted: the shot is decided `ticks` before it is fired.
  void set_arm_lead(std::uint32_t ticks) { arm_lead_ticks_ = ticks; }
  void set_trigger(const TriggerPattern& pattern) {
    trigger_ = pattern;
    trigger_on_ = pattern.first_tick;
  }

  /// Where the last pulse of the lamp trigger that was filled has started; 0 if there was none.
  std::uint64_t last_trigger() const { return last_trigger_; }

  /// Next block, at most `max_ticks` long.
  void fill(SegmentQueue& queue, TickBlock& block, std::uint32_t max_ticks);

  /// State at the next tick to be filled.
  MotionState state() const;
  /// True if a segment is being run.
  bool running() const { return running_; }
  /// Motion has ended with speed, or a segment came after its time: a fault, until halt().
  bool underrun() const { return underrun_; }
  /// The segment being run; valid while running().
  const Segment& segment() const { return segment_; }

  /// Replaces what is being run (brake). The segment starts at state(). Fill interrupt masked.
  void replace(const Segment& segment);
  /// Stops dead where the machine is (e-stop): speed is lost, position kept.
  void halt();
  /// Sets the position of every axis; at rest only (power-up, after a dead stop).
  void set_position(const StepPosition& steps);

 private:
  struct Run {
    AxisRun run;
    std::uint32_t left = 0;  ///< ticks left in this piece
    int piece = 0;           ///< which piece comes next
  };
  struct Window {
    std::uint64_t on = 0, off = 0;
  };

  void stand();
  void load(const Segment& segment);
  void next_piece(int axis);
  std::uint32_t limit_to(std::uint64_t change_tick, std::uint32_t ticks) const;
  std::uint32_t limit_by_bits(std::uint32_t ticks) const;
  std::uint8_t bits() const;
  void advance(std::uint32_t ticks);

  std::uint64_t tick_ = 0;
  bool running_ = false;
  bool underrun_ = false;
  std::uint32_t left_ = 0;  ///< ticks left in the segment
  Segment segment_;
  PerAxis<Run> runs_{};
  Window window_, old_window_;
  std::uint32_t arm_lead_ticks_ = 0;
  TriggerPattern trigger_;
  std::uint64_t trigger_on_ = 0;    ///< tick of the next or present trigger pulse
  std::uint64_t last_trigger_ = 0;  ///< and of the last that has begun
};

}  // namespace lamplock::stepper
