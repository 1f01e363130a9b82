// The beat clock: where the lamp is, and how long the next ticks have to be.
//
// In:  accepted LAMP SYNC edges with their time in system clocks (beat interrupt).
// Out: spans of ticks with their length in clocks (timing interrupt, up to 1 ms ahead), such that
//      the lattice tick of beat k falls on edge k + delay; the beat number of every edge.
// Budget: no division outside configure(); a handful of 64-bit products per edge or span.
//
//   edge k-1           edge k             edge k+1 (predicted)
//      |--- period ------|------ period -----|
//      |<delay>|         |<delay>|           |<delay>|
//           tick (k-1)N       tick kN             tick (k+1)N
//
// As slave a tracker with two states (phase, period) predicts the next edge. Its gains are those
// of the steady-state Kalman filter for the drift and jitter that the settings expect (Kalata,
// "The tracking index", 1984). The lattice follows the line through the predicted edges; a tick is
// stretched or shrunk by at most the slew limit while the machine moves, by more while it stands.
// As master, and on a free beat, a tick is exactly nominal and the lamp follows us.
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::lamp {

/// Runs shorter than this are not LAMP SYNC: the laser guarantees more than 2 us. Boards reject
/// them before they report an edge.
inline constexpr std::uint32_t min_sync_clocks = 2 * clocks_per_us;

/// `ticks` ticks from `first_tick` on, evenly spread over `clocks` system clocks.
struct TickSpan {
  std::uint64_t first_tick = 0;
  std::uint64_t first_clock = 0;
  std::uint32_t ticks = 0;
  std::uint32_t clocks = 0;
};

/// What an edge turned out to be.
struct EdgeInfo {
  bool valid = false;        ///< belongs to a beat (otherwise spurious or not locked)
  std::uint64_t beat = 0;    ///< its number: lattice tick tick_of_beat(beat)
  std::uint32_t missed = 0;  ///< beats without an edge before it
  bool unlocked = false;     ///< a flash while the clock still looks for the rhythm of the lamp
};

/// One per controller.
class BeatClock {
 public:
  /// Takes settings over; the lattice goes on from where it is, the lock is lost.
  void configure(const settings::Values& values);

  /// An edge of LAMP SYNC at `clock`, runts already removed.
  EdgeInfo edge(std::uint64_t clock);
  /// Length of the next ticks, at most `max_ticks` of them, never across a beat.
  TickSpan next_span(std::uint32_t max_ticks);

  /// Motion is planned up to this tick: the slew limit holds before it.
  void set_motion_end(std::uint64_t tick) { motion_end_tick_ = tick; }

  std::uint32_t beat_ticks() const { return beat_ticks_; }
  /// Lattice tick of a beat, and the first beat at or after a tick (main loop: divides).
  std::uint64_t tick_of_beat(std::uint64_t beat) const {
    return origin_tick_ + (beat - origin_beat_) * beat_ticks_;
  }
  std::uint64_t beat_at_or_after(std::uint64_t tick) const {
    return origin_beat_ + (tick - origin_tick_ + beat_ticks_ - 1) / beat_ticks_;
  }
  std::uint64_t next_tick() const { return tick_; }  ///< first tick without a length
  bool locked() const { return locked_; }
  /// Locked, and the lattice has caught up with the lamp: motion may begin.
  bool settled() const;
  /// Shortest tick to expect over the nominal one, Q16, slew included.
  std::uint32_t shortest_tick_q16() const;

  settings::LampMode mode() const { return mode_; }
  std::uint32_t edges() const { return edges_; }        ///< since power-up, runts not counted
  std::uint32_t spurious() const { return spurious_; }  ///< edges that belong to no beat
  std::uint32_t lock_losses() const { return losses_; }

 private:
  void set_gains(const settings::Values& values);
  /// A time in clocks, Q16. Wraps after 26 days: only differences mean anything.
  using ClockQ16 = std::uint64_t;

  EdgeInfo acquire(ClockQ16 now_q16);
  EdgeInfo track(ClockQ16 clock_q16);
  void lock(ClockQ16 clock_q16);
  void lose();
  std::int64_t lattice_error_q16() const;
  EdgeInfo nearest_beat(ClockQ16 clock_q16);

  settings::LampMode mode_ = settings::LampMode::free_beat;
  std::uint32_t beat_ticks_ = 1;
  std::int64_t nominal_q16_ = 0;   ///< clocks per beat
  std::int64_t range_q16_ = 0;     ///< how far the period may be from nominal, clocks
  std::int64_t jitter_q16_ = 0;    ///< clocks
  std::int64_t delay_q16_ = 0;     ///< edge to shot, clocks
  std::int64_t per_beat_q48_ = 0;  ///< 1 / N
  std::int64_t slew_q32_ = 0;      ///< share of a tick
  std::int64_t phase_gain_q16_ = 0;
  std::int64_t period_gain_q16_ = 0;
  std::uint32_t lock_edges_ = 0;
  std::int64_t per_lock_q32_ = 0;  ///< 1 / lock_edges

  // The lamp.
  bool locked_ = false;
  std::uint32_t good_edges_ = 0;
  ClockQ16 first_edge_q16_ = 0, last_edge_q16_ = 0;
  std::int64_t period_q16_ = 0;       ///< tracked
  ClockQ16 predicted_q16_ = 0;        ///< next edge
  std::uint64_t predicted_beat_ = 0;  ///< its number
  std::uint32_t strays_in_a_row_ = 0;
  std::uint32_t edges_ = 0;
  std::uint32_t spurious_ = 0;
  std::uint32_t losses_ = 0;

  // The lattice.
  std::uint64_t tick_ = 0;
  std::uint64_t origin_tick_ = 0;  ///< where the present beats began to be counted
  std::uint64_t origin_beat_ = 0;  ///< and the number of that beat
  std::uint64_t beat_ = 0;         ///< beat that tick_ is in
  std::uint32_t tick_in_beat_ = 0;
  std::uint64_t clock_ = 0;    ///< time of tick_, whole clocks
  ClockQ16 clock_q16_ = 0;     ///< the same with its fraction
  std::int64_t tick_q32_ = 0;  ///< tracked length of a tick, clocks
  std::uint64_t motion_end_tick_ = 0;
};

}  // namespace lamplock::lamp
