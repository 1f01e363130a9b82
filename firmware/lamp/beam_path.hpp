// The beam path: the open shutter, the value of the attenuator, and whether a shot may pass.
//
// In:  the needs of the next shots (main loop, as they are planned; beat interrupt, as each is
//      handed out), whether any shot is permitted, the present clock.
// Out: at most one open shutter, the value of the attenuator, and when both are settled.
// Level: configure, update, cut, prepare: main loop, beat interrupt masked. take: beat interrupt.
//
//   closed --prepare--> closing of the last one --close time--> opening --open time--> ready
//      ^                                                                                  |
//      +---- no shot permitted (hold, door, alarm, not locked, no job), no shot for 1 s --+
//
// A shutter that needs time is changed at rest only: the job runner ends a run of points where
// needs_rest() is true, and starts the next one when prepare() returns that the beam is ready.
// Values that need no time change in take(), with the token of the next shot, after the previous
// shot. Two shutters are never open together: one opens after the other has had its time to close.
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::lamp {

/// Settings of the beam for a shot.
struct Beam {
  std::uint8_t channel = 0;  ///< 0..3
  std::uint16_t energy = 0;  ///< of the attenuator, 65535 = full; 0 = keep the current value
};

/// One per controller.
class BeamPath {
 public:
  static constexpr std::uint8_t no_channel = 0xff;
  /// Without a shot the shutter closes after this time.
  static constexpr std::uint64_t idle_clocks = std::uint64_t{clock_hz};

  void configure(const settings::Values& values) {
    using settings::Id;
    // Thousandths of a millisecond are microseconds.
    const auto clocks = [&values](Id id) {
      return static_cast<std::uint64_t>(values.milli(id)) * clocks_per_us;
    };
    open_clocks_ = clocks(Id::shutter_open);
    close_clocks_ = clocks(Id::shutter_close);
    settle_clocks_ = clocks(Id::attenuator_settle);
    ready_ = false;
  }
  /// The attenuator's value of the last job no longer applies.
  void begin_job() {
    energy_ = 0;
    ready_ = false;
  }

  /// To be called about every millisecond; `in_use`: the machine moves or a shot is planned.
  void update(bool in_use, std::uint64_t clock) {
    now_ = clock;
    if (in_use) used_ = clock;
    if (cut_ || now_ - used_ > idle_clocks) close();
    cut_ = false;
  }
  /// No shot is permitted: everything off immediately.
  void cut() {
    ready_ = false;
    cut_ = true;
  }
  /// To be called until it returns true (the beam is ready), at rest and with no shot planned.
  bool prepare(const Beam& beam) {
    used_ = now_;
    if (channel_ != beam.channel) close_shutter();
    const std::uint16_t energy = beam.energy != 0 ? beam.energy : energy_;
    if (attenuator_ != energy) {
      attenuator_ = energy_ = energy;
      ready_not_before(now_ + settle_clocks_);
    }
    if (channel_ == no_channel) {
      if (now_ < closed_at_) return false;
      channel_ = beam.channel;
      ready_not_before(now_ + open_clocks_);
    }
    ready_ = now_ >= ready_at_;
    return ready_;
  }
  /// The beam is ready for this without prepare().
  bool is_ready_for(const Beam& beam) const {
    return (ready_ || at_once()) && !needs_rest({channel_, attenuator_}, beam);
  }
  /// The machine must wait for shutter or attenuator between two points.
  bool needs_rest(const Beam& from, const Beam& to) const {
    const bool other_channel = from.channel != to.channel && (open_clocks_ | close_clocks_) != 0;
    const bool other_energy = to.energy != 0 && from.energy != to.energy && settle_clocks_ != 0;
    return other_channel || other_energy;
  }

  /// Prepares for the token of a shot through `beam`; false if the beam is not ready for it.
  bool take(const Beam& beam) {
    if (!is_ready_for(beam)) return false;
    channel_ = beam.channel;
    if (beam.energy != 0) energy_ = beam.energy;
    attenuator_ = energy_;
    cut_ = false;
    return true;
  }

  /// Bit of the open shutter, or 0.
  std::uint8_t shutters() const {
    const bool open = channel_ != no_channel && !cut_;
    return open ? static_cast<std::uint8_t>(1u << channel_) : std::uint8_t{0};
  }
  std::uint16_t attenuator() const { return cut_ ? std::uint16_t{0} : attenuator_; }

 private:
  bool at_once() const { return (open_clocks_ | close_clocks_ | settle_clocks_) == 0; }
  void ready_not_before(std::uint64_t clock) {
    if (ready_at_ < clock) ready_at_ = clock;
  }
  void close_shutter() {
    ready_ = false;
    if (channel_ == no_channel) return;
    channel_ = no_channel;
    closed_at_ = now_ + close_clocks_;
  }
  void close() {
    close_shutter();
    attenuator_ = 0;
  }

  std::uint64_t open_clocks_ = 0, close_clocks_ = 0, settle_clocks_ = 0;
  std::uint64_t now_ = 0;
  std::uint64_t used_ = 0;       ///< when a shot was last planned or prepared for
  std::uint64_t closed_at_ = 0;  ///< when the last closing shutter has closed
  std::uint64_t ready_at_ = 0;
  std::uint8_t channel_ = no_channel;  ///< of the open or opening shutter
  std::uint16_t attenuator_ = 0;       ///< current output
  std::uint16_t energy_ = 0;           ///< last value of this job
  bool ready_ = false;
  bool cut_ = false;  ///< off at the pins; closes at the next update(), which has the time
};

}  // namespace lamplock::lamp
