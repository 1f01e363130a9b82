// Parking: while the door is open the tool is retracted; it returns before the program continues.
//
// In:  the settings, the position at rest, whether the door is open, a resume.
// Out: moves of Z from rest to rest, one at a time.
// Who: the controller, main loop, unmasked; a move is some 5000 cycles.
//
//   stopping -> up by $56 at $57 -> to $58 at $59 -> parked -> back at $59 -> down at $57 -> gone
//
// A door that opens during the return interrupts it; the tool retracts again. A machine that is
// above $58 already does not move there.
#pragma once

#include <cstdint>

#include "firmware/motion/profile/limits.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::machine {

class Parking {
 public:
  enum class Stage : std::uint8_t {
    off,       ///< no open door, or nothing to park
    stopping,  ///< the program comes to rest
    pulling_out,
    leaving,
    parked,
    returning,
    lowering
  };

  /// A door has opened; `values` decide whether and how it parks.
  void begin(const settings::Values& values);
  void end() {
    stage_ = Stage::off;
    called_back_ = false;
  }
  /// A resume: false if the program may continue at once.
  bool request_return() { return called_back_ = stage_ != Stage::off; }
  /// A door has opened again: the tool stays retracted. True if the tool is returning, and this
  /// must be interrupted; before that only the program's stop or the retraction runs.
  bool cancel_return() {
    called_back_ = false;
    return comes_back();
  }
  /// The tool stays where it stops, until a resume.
  void stay_here() {
    stage_ = Stage::parked;
    called_back_ = false;
  }
  Stage stage() const { return stage_; }
  /// Parking moves the machine: the program is at rest.
  bool holds_machine() const { return stage_ != Stage::off && stage_ != Stage::stopping; }
  /// The tool is returning, or is about to.
  bool comes_back() const { return stage_ == Stage::returning || stage_ == Stage::lowering; }

  /// The machine is at rest at `at`. True if it must run `move`; else it is parked, or back at its
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
  Int128 place_q64_, up_q64_, target_q64_;  ///< of Z: where the program continues, above it, parked
  std::int32_t pull_out_steps_ = 0;
  std::int64_t slow_q62_ = 0, fast_q62_ = 0;  ///< steps a tick
};

}  // namespace lamplock::machine
