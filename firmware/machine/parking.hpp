// Parking: behind an open door the tool goes up and away, and comes back before the program goes
// on.
//
// In:  the settings, where the machine stands, whether the door is open and somebody said go on.
// Out: moves of Z from rest to rest, one at a time.
// Who: the controller, main loop, unmasked; a move is some 5000 cycles.
//
//   stopping -> up by $56 at $57 -> to $58 at $59 -> parked -> back at $59 -> down at $57 -> gone
//
// A door that opens on the way back breaks that off; the tool goes up again then. Where the machine
// stands higher than $58 already it stays.
#pragma once

#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

class Parking {
 public:
  enum class Stage : std::uint8_t {
    off,       ///< no door, or nothing to be parked
    stopping,  ///< the program comes to rest
    pulling_out,
    leaving,
    parked,
    returning,
    lowering
  };

  /// A door has opened; `values`: whether and how it parks.
  void begin(const settings::Values& values);
  void end() {
    stage_ = Stage::off;
    called_back_ = false;
  }
  /// The program is to go on: false if nothing of parking stands in its way.
  bool call_back() { return called_back_ = stage_ != Stage::off; }
  /// A door has opened once more: the tool stays away. True if it is on its way back, which is to
  /// be broken off; before that there is nothing but the program's own way to rest, or the way up.
  bool stay_away() {
    called_back_ = false;
    return comes_back();
  }
  /// The tool stays where it comes to rest, until somebody says go on.
  void stay_here() {
    stage_ = Stage::parked;
    called_back_ = false;
  }
  Stage stage() const { return stage_; }
  /// It has the machine: the program is at rest.
  bool holds_machine() const { return stage_ != Stage::off && stage_ != Stage::stopping; }
  /// On its way back, or about to be.
  bool comes_back() const { return stage_ == Stage::returning || stage_ == Stage::lowering; }

  /// The machine stands at `at`. True if it is to do `move`; else it is parked, or back at its
  /// place (off).
  bool next(const stepper::MotionState& at, const motion::BrakeLimits& limits,
            stepper::Segment& move);

 private:
  bool come_back(const stepper::MotionState& at, const motion::BrakeLimits& limits,
                 stepper::Segment& move);
  bool go(const stepper::MotionState& at, Int128 to_q64, std::int64_t speed_q62,
          const motion::BrakeLimits& limits, stepper::Segment& move) const;

  Stage stage_ = Stage::off;
  bool called_back_ = false;
  Int128 place_q64_, up_q64_, target_q64_;  ///< of Z: where the program goes on, above it, parked
  std::int32_t pull_out_steps_ = 0;
  std::int64_t slow_q62_ = 0, fast_q62_ = 0;  ///< steps a tick
};

}  // namespace lamplock::machine
