// A servo drive with an encoder on the load: the load follows the pulses with a following error.
//
// In:  each step of one axis, with its time (the drive's pure delay is in it).
// Out: the position of the load at any time, in steps with a fraction; the encoder's count there.
// The position loop is a linear system of first or second order. Its command is constant between
// two steps, so the state at the next one, and at any time between, has a closed form: no
// integration step is needed, and reading a state does not change later ones.
// Who: the drives call load_moves(). A table of errors reads the states afterwards, so the state at
//      each step is kept (32 bytes a step, only where an axis has a servo).
#pragma once

#include <cstdint>
#include <vector>

#include "sim/world/drives.hpp"

namespace lamplock::sim {

/// The defaults are the machine of "programmed synchronisation of two AC servo drives".
struct ServoConfig {
  double steps_per_rev = 512;
  double counts_per_rev = 2048;  ///< of the encoder; four times its lines
  double mm_per_rev = 78;
  int order = 2;                ///< 1: x' = (r - x)/T;  2: T^2 x'' + 2 D T x' + x = r
  double time_constant_ms = 5;  ///< T
  double damping = 1;           ///< D
};

/// One servo axis; must live as long as the drives.
class Servo final : public LoadListener {
 public:
  /// Throws std::invalid_argument if the numbers do not describe a servo.
  Servo(const ServoConfig& config, int axis, Drives& drives);
  Servo(const Servo&) = delete;
  Servo& operator=(const Servo&) = delete;

  /// Command of the pulses up to and including `at`, in steps.
  double command_at(Picoseconds at) const { return state_before(at).command; }
  /// Position of the load, in steps.
  double load_at(Picoseconds at) const;
  /// Command less load.
  double following_error_at(Picoseconds at) const { return command_at(at) - load_at(at); }
  /// The encoder's counter; at its zero the load is at position 0. A count reaches equally far on
  /// both sides of its position, so that a load at rest is not at the edge between two counts.
  std::int64_t counts_at(Picoseconds at) const;
  /// The position that a diagnostics program computes from the counter.
  double encoder_mm_at(Picoseconds at) const;
  double mm_per_step() const { return config_.mm_per_rev / config_.steps_per_rev; }

  void load_moves(int axis, std::int32_t place, Picoseconds at) override;

 private:
  /// State from a step on; the last command lasts until the next step.
  struct State {
    Picoseconds at;
    double command;
    double lag;    ///< command less load
    double speed;  ///< of the load, steps/s
  };
  const State& state_before(Picoseconds at) const;
  State after(const State& state, Picoseconds at) const;

  ServoConfig config_;
  std::vector<State> states_;
};

}  // namespace lamplock::sim
