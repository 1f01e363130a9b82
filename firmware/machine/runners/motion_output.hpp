// The output of motion: the ring of segments and the tick generator that reads it.
//
// In:  segments of the job runner or of the program runner: only one of them moves the machine at a
//      time.
// Out: ticks, by the board's fill interrupt.
// Who: the controller owns it; stepper/segment_queue.hpp and stepper/tick_generator.hpp describe
//      what is shared with interrupts.
#pragma once

#include <cstdint>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/stepper/segment_queue.hpp"
#include "firmware/stepper/tick_generator.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

class MotionOutput {
 public:
  MotionOutput() = default;
  MotionOutput(const MotionOutput&) = delete;
  MotionOutput& operator=(const MotionOutput&) = delete;

  stepper::SegmentQueue& segments() { return segments_; }
  stepper::TickGenerator& generator() { return generator_; }
  const stepper::TickGenerator& generator() const { return generator_; }
  /// Changes of outputs at ticks of the motion.
  stepper::ChangeQueue& changes() { return changes_; }

  /// True if nothing moves and nothing is committed.
  bool at_rest() const {
    return !generator_.running() && segments_.empty() && segments_.released();
  }

  /// Lags of the drives and the lead of the laser, from the settings; they take effect with the
  /// next set_leads().
  [[gnu::cold]] void set_lags(const settings::Values& values);
  /// Sets the leads of axes and laser, in ticks of their present length; at rest only. Masked.
  [[gnu::cold]] void set_leads(lamp::BeatClock& clock);

 private:
  stepper::SegmentQueue segments_;
  stepper::ChangeQueue changes_;
  stepper::TickGenerator generator_{segments_, &changes_};
  PerAxis<std::uint32_t> lag_clocks_{};
  std::int32_t laser_lead_clocks_ = 0;
};

}  // namespace lamplock::machine
