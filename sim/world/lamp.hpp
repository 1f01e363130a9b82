// The flash lamp of the laser: drives LAMP SYNC as real lamps do, faults included.
//
// In:  its configuration; in triggered mode the rising edges of LAMP TRIGGER.
// Out: LAMP SYNC. A free-running lamp keeps an ideal phase, integrated period by period in whole
//      picoseconds with the remainder carried, so that it is as exact after hours as at the start;
//      jitter moves each edge about that phase and never accumulates. A triggered lamp raises
//      LAMP SYNC at the very time of the trigger, from inside the call that raised the trigger.
// Who: World calls next_event() and advance(); both are a comparison when nothing is due.
//
// Counting: a flash is light. A drop-out is a period without light, a runt is noise on the wire,
// and the second edge of a doubled flash is an echo on the wire: none of them is a flash, so a
// doubled flash counts once. Flashes are numbered from 1; that number is the beat of a shot.
//
// All randomness comes from one generator; every period draws the same amount, so that switching
// one fault on does not change the others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/world/pins.hpp"
#include "sim/world/random.hpp"

namespace lamplock::sim {

/// Configuration of the lamp; probabilities are per period, 0..1.
struct LampConfig {
  double frequency_hz = 100;    ///< nominal; in triggered mode only sets where runts may fall
  double jitter_us = 0;         ///< every edge uniformly +- this about its ideal phase
  double wander = 0;            ///< relative, peak to peak of the period, as a sine
  double wander_period_s = 10;  ///< period of that sine
  double dropout = 0;           ///< probability that a flash is missing
  double runt = 0;              ///< probability of an extra pulse of 0.2..1.9 us at a random phase
  double doubled = 0;           ///< probability of a second full edge 3..200 us after the edge
  double pulse_us = 20;         ///< width of LAMP SYNC
  double phase_us = 0;          ///< first edge, after the lamp is on
  double on_after_s = 0;        ///< the lamp is dark (and ignores triggers) before
  bool triggered = false;       ///< flashes on LAMP TRIGGER instead of running freely
  std::uint64_t seed = 1;
};

/// The lamp. Construct it once per bus; it must live as long as the bus is driven.
class Lamp final : public PinListener {
 public:
  /// Throws std::invalid_argument if the numbers do not describe a lamp (frequency or pulse not
  /// positive, a probability outside 0..1, jitter, pulse or wander too large for the period).
  Lamp(const LampConfig& config, PinBus& bus);
  Lamp(const Lamp&) = delete;
  Lamp& operator=(const Lamp&) = delete;

  /// Time of its next change (or of a flash that drops out); `never` if there is none.
  Picoseconds next_event() const { return next_ < count_ ? edges_[next_].at : never; }

  /// Applies all changes up to and including `to`, in order.
  void advance(PinBus& bus, Picoseconds to) {
    while (next_event() <= to) apply_next(bus);
  }

  /// Number of real flashes so far.
  std::int64_t flashes() const { return flashes_; }

  /// Number of lamp periods so far, those whose flash dropped out included.
  std::int64_t periods() const { return periods_; }

  /// A flash: its number (from 1) and the time of its edge.
  struct Flash {
    std::int64_t number = 0;  ///< 0: there was none
    Picoseconds at = 0;
  };

  /// Latest flash at or before `at`; remembers only the last few flashes, enough for listeners
  /// whose board delivers its changes in slices of time shorter than a few periods.
  Flash flash_before(Picoseconds at) const;

  /// Trigger input.
  void pin_changed(Pin pin, bool level, Picoseconds at) override;

 private:
  enum class Kind : std::uint8_t { flash, dropped, rise, fall };
  struct Edge {
    Picoseconds at;
    Kind kind;
  };

  void add(Picoseconds at, Kind kind) { edges_[count_++] = {at, kind}; }
  void add_pulse(Picoseconds rise, Picoseconds fall, Kind kind);
  void make_period(Picoseconds ideal, Picoseconds next_ideal);
  void make_next_period();
  void apply_next(PinBus& bus);

  LampConfig config_;
  PinBus* bus_;
  Random random_;
  Picoseconds jitter_;
  Picoseconds pulse_;
  Picoseconds on_after_;
  Picoseconds wander_period_;
  double period_;                ///< nominal, ps
  Picoseconds ideal_ = 0;        ///< ideal phase of the next period to make
  double ideal_remainder_ = 0;   ///< and its fraction of a picosecond
  std::array<Edge, 6> edges_{};  ///< of one period: flash, echo, runt; two edges each
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::int64_t flashes_ = 0;
  std::int64_t periods_ = 0;
  static constexpr std::size_t remembered_flashes = 16;
  std::array<Flash, remembered_flashes> recent_{};
};

}  // namespace lamplock::sim
