// The beat clock: follows the lamp, and sets the length of the next ticks.
//
// In:  accepted LAMP SYNC edges with their time in system clocks (beat interrupt).
// Out: spans of ticks with their length in clocks (beat interrupt, up to 1 ms ahead), such that the
//      lattice tick of beat k is at edge k + delay; the beat number of every edge.
// Who: edge() and next_span() at the level of the beat; functions that divide (documented there):
//      main loop with that masked. Budget: no division at beat level; 4 us a span, 8 us an edge on
//      the board. So values that change only with an edge (length of a tick, where the beats should
//      begin) are calculated there, a span only adds; products of a span fit 32 bits.
//
//   edge k-1           edge k             edge k+1 (predicted)
//      |--- period ------|------ period -----|
//      |<delay>|         |<delay>|           |<delay>|
//           tick (k-1)N       tick kN             tick (k+1)N
//
// As slave a tracker with two states (phase, period) predicts the next edge. It begins as a least
// squares line through the edges seen so far, whose gains fall with their number, and ends with
// those of the steady-state Kalman filter for the drift and jitter that the settings expect
// (Kalata, "The tracking index", 1984). The lattice follows the line through the predicted edges; a
// tick is stretched or shrunk by at most the slew limit while the machine moves, by more at rest,
// and while it moves it is never shorter than the tick that its limits were made for.
//
// Which edges belong to a beat. An edge further from its prediction than jitter and drift can
// explain (and more than 1/32 of a period) is a stray. Strays with their own rhythm inside the lock
// range are the lamp after a jump: the lock is lost and found again in a few edges. Beats with none
// or several edges are a transient fault; if every beat is such, the lamp runs at another
// frequency. Outside the lock range there is no lock, and without a lock no shot and no motion.
//
// At the lattice tick of a beat the loads are at their point. Steps leave before the tick that they
// are planned for, by the lag of their drive (stepper/tick_generator.hpp); lattice and lamp are not
// affected, but no tick may be too short for motion that has begun so much earlier.
//
// As master the lock is lost after 32 triggers without an edge, and returns with the next edge. On
// a free beat a tick is exactly nominal; as master too, unless the planner sets another length
// (set_tick_length()): segments are whole beats in ticks, so a way that takes 1.02 beats is run in
// one beat of ticks that are 2 % longer. Limits in ticks rise with the length of the tick
// (make_limits()), so they hold in real time. The length may change only where every axis rests:
// with the length of a tick the real speed would jump. The edge of a lamp that we trigger is a
// delay before the lattice tick, counted in ticks, and the shot a delay after the edge, counted in
// time: both agree within 1 us, which limits the length where the delay is long.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/beat.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::lamp {

/// Shorter pulses are not LAMP SYNC: the laser guarantees more than 2 us. Boards reject them before
/// they report an edge.
inline constexpr std::uint32_t min_sync_clocks = 2 * clocks_per_us;

/// `ticks` ticks from `first_tick` on, evenly spread over `clocks` system clocks.
struct TickSpan {
  std::uint64_t first_tick = 0;
  std::uint64_t first_clock = 0;
  std::uint32_t ticks = 0;
  std::uint32_t clocks = 0;
};

/// Classification of an edge.
struct EdgeInfo {
  bool valid = false;        ///< belongs to a beat (otherwise spurious or not locked)
  std::uint64_t beat = 0;    ///< its number: lattice tick tick_of_beat(beat)
  std::uint32_t missed = 0;  ///< beats without an edge before it
  /// A flash before the lock; `missed` is then the number of earlier edges that were taken for
  /// strays and were flashes too.
  bool unlocked = false;
};

/// One per controller.
class BeatClock {
 public:
  /// Applies settings; the lattice continues, the lock is lost.
  [[gnu::cold]] void configure(const settings::Values& values);

  /// An edge of LAMP SYNC at `clock`, runts already removed.
  EdgeInfo edge(std::uint64_t clock);
  /// Length of the next ticks, at most `max_ticks` of them, never across a beat.
  TickSpan next_span(std::uint32_t max_ticks);

  /// Motion is planned up to this tick: the slew limit holds before it.
  void set_motion_end(std::uint64_t tick) { motion_end_tick_ = tick; }
  /// Motion from this tick on has limits for ticks that are at least this long (min_tick_q16()
  /// at that time); before it the previous value holds. `from_tick` begins a beat.
  void set_min_tick(std::uint64_t from_tick, std::uint32_t tick_q16);
  /// Maximum ticks by which steps leave before the ticks that they are planned for; at rest only.
  void set_lead(std::uint32_t ticks) { lead_ticks_ = ticks; }
  /// Number of present ticks that take about as long as these clocks (main loop: divides).
  std::uint32_t ticks_in(std::uint32_t clocks) const;

  /// As master: ticks from this one on, which begins a beat, have this length over the nominal one,
  /// instead of earlier settings for them. At most max_tick_q16(), and at most as much below
  /// nominal. No effect in other modes.
  void set_tick_length(std::uint64_t from_tick, std::uint32_t tick_q16);
  /// Motion continues over that tick: no change of the length there or later.
  void keep_tick_length(std::uint64_t from_tick) { length_.keep(from_tick); }
  /// The longest tick that the tolerance of the period (setting 910) and the delay allow.
  std::uint32_t max_tick_q16() const { return max_tick_q16_; }

  std::uint32_t beat_ticks() const { return beat_ticks_; }
  /// From an edge to its lattice tick, rounded down.
  std::uint32_t delay_ticks() const { return delay_ticks_; }
  /// Lattice tick of a beat, and the first beat at or after a tick (main loop: divides).
  std::uint64_t tick_of_beat(std::uint64_t beat) const {
    return origin_tick_ + (beat - origin_beat_) * beat_ticks_;
  }
  std::uint64_t beat_at_or_after(std::uint64_t tick) const {
    return origin_beat_ + (tick - origin_tick_ + beat_ticks_ - 1) / beat_ticks_;
  }
  std::uint64_t next_tick() const { return tick_; }  ///< first tick without a length
  std::uint64_t next_beat() const { return beat_; }  ///< beat of next_tick()
  bool locked() const { return locked_; }
  /// Locked, and the lattice has caught up with the lamp: motion may begin.
  bool settled() const;
  /// Shortest tick to expect within the next `ticks` ticks over the nominal one, Q16, for a lamp
  /// that drifts as the settings say; an eighth of the slew limit remains to shrink ticks. In steps
  /// of about 1/8192, the same for a lamp within 1/16384 of the nominal period. As slave also above
  /// nominal, otherwise nominal (main loop: divides).
  [[gnu::cold]] std::uint32_t min_tick_q16(std::uint32_t ticks) const;

  settings::LampMode mode() const { return mode_; }
  std::uint32_t edges() const { return edges_; }        ///< since power-up, runts not counted
  std::uint32_t spurious() const { return spurious_; }  ///< edges that belong to no beat
  std::uint32_t lock_losses() const { return losses_; }

 private:
  /// A time in clocks, Q16. Wraps after 26 days: only differences are valid.
  using ClockQ16 = std::uint64_t;
  /// Shares of the error of an edge, Q16, that correct phase and period.
  struct Gains {
    std::int32_t phase_q16 = 0;
    std::int32_t period_q16 = 0;
  };

  // Small rather than fast (cold): functions that the main loop calls occasionally.
  [[gnu::cold]] void set_gains(const settings::Values& values);
  [[gnu::cold]] void set_gates(const settings::Values& values);
  [[gnu::cold]] void set_max_tick(const settings::Values& values);
  void set_line(std::uint32_t edges);
  void next_gains();
  void choose_gains();
  std::int64_t gate_q16(std::uint32_t missed) const;
  bool near_nominal(std::int64_t interval_q16, std::int64_t slack_q16) const;

  EdgeInfo acquire(ClockQ16 now);
  EdgeInfo track(ClockQ16 now);
  EdgeInfo stray(ClockQ16 now, std::int64_t error);
  void follow(std::int64_t error, std::uint32_t missed);
  void follow_jump(ClockQ16 now, std::int64_t error, std::uint32_t missed, std::int64_t gate);
  void start_line(ClockQ16 now);
  void draw_line(ClockQ16 now, std::int64_t period_q16, std::uint32_t edges);
  void lock();
  void lose();
  bool outside_range() const;
  std::int64_t tick_of_period_q32(std::int64_t period_q16) const;
  void aim();
  std::int64_t lattice_error_q16() const;
  std::uint32_t steered(std::uint32_t length_q16, std::uint32_t ticks, int fold);
  EdgeInfo nearest_beat(ClockQ16 clock_q16);

  // Members used by every span are first, within reach of short instructions of the board.
  settings::LampMode mode_ = settings::LampMode::free_beat;
  bool locked_ = false;
  bool on_lamp_ = false;  ///< the lattice has caught up with the lamp since the lock
  std::uint32_t beat_ticks_ = 1;
  std::uint32_t tick_in_beat_ = 0;
  std::uint32_t slew_q32_ = 0;  ///< share of a tick
  std::uint64_t tick_ = 0;
  std::uint64_t motion_end_tick_ = 0;
  std::uint64_t beat_ = 0;            ///< beat of tick_
  std::uint64_t clock_ = 0;           ///< time of tick_, whole clocks
  ClockQ16 clock_q16_ = 0;            ///< the same with its fraction
  std::int64_t tick_q32_ = 0;         ///< tracked length of a tick, clocks
  ClockQ16 aim_q16_ = 0;              ///< target time of tick_; both are undefined without a lock
  ClockQ16 beat_aim_q16_ = 0;         ///< target time of the start of the present beat
  std::int64_t period_q16_ = 0;       ///< tracked
  std::uint64_t predicted_beat_ = 0;  ///< its number

  // Settings.
  std::int64_t nominal_q16_ = 0;  ///< clocks per beat
  std::int64_t range_q16_ = 0;    ///< maximum distance of the period from nominal, clocks
  std::int64_t jitter_q16_ = 0;   ///< clocks
  std::int64_t delay_q16_ = 0;    ///< edge to shot, clocks
  std::uint32_t delay_ticks_ = 0;
  std::uint32_t inverse_ = 0;  ///< 2^(31 + inverse_bits_) / N: at most 2^31
  int inverse_bits_ = 0;
  std::int64_t drift_q32_ = 0;  ///< share of the period, per beat
  Gains steady_;
  std::int64_t innovation_q16_ = 0;  ///< remaining error under steady drift
  std::int64_t gate_q16_ = 0;        ///< gate_q16(0)
  std::uint32_t lock_edges_ = 0;

  // The lamp.
  std::uint32_t good_edges_ = 0;    ///< in the present line, during the search for the lock
  std::uint32_t line_edges_ = 0;    ///< the same for the gains, limited
  Gains line_;                      ///< of a least squares line through these
  Gains gains_;                     ///< in use: the larger ones of line_ and steady_
  std::int64_t uncertain_q16_ = 0;  ///< of the period: share of the jitter passed by the gain
  ClockQ16 last_edge_q16_ = 0;      ///< that belonged to the rhythm
  ClockQ16 edge_before_q16_ = 0;
  ClockQ16 predicted_q16_ = 0;         ///< next edge
  std::uint32_t strays_in_a_row_ = 0;  ///< since the last beat with one edge
  std::uint32_t stray_rhythm_ = 0;     ///< number of these that are a period apart
  ClockQ16 first_stray_q16_ = 0, last_stray_q16_ = 0;
  bool crowded_ = false;            ///< an edge in the middle of this beat
  std::uint32_t odd_beats_ = 0;     ///< beats in a row with none or several edges
  std::int32_t far_off_ = 0;        ///< edges in a row too early (negative) or too late
  std::uint32_t silent_beats_ = 0;  ///< as master: triggers in a row without an edge
  std::uint32_t edges_ = 0;
  std::uint32_t spurious_ = 0;
  std::uint32_t losses_ = 0;

  // The lattice.
  std::uint64_t origin_tick_ = 0;  ///< tick from which the present beats are counted
  std::uint64_t origin_beat_ = 0;  ///< number of the beat at that tick
  std::uint32_t lead_ticks_ = 0;
  /// A length of ticks in clocks, by tick: the first one holds now, the others from their tick on.
  template <std::size_t places>
  class Schedule {
   public:
    void reset(std::int64_t q32) { steps_[0] = {0, q32}, count_ = 1; }
    /// Value at tick `now`, which must not decrease.
    std::int64_t at(std::uint64_t now) {
      while (count_ > 1 && steps_[1].from_tick <= now) {
        for (std::uint32_t i = 1; i < count_; ++i) steps_[i - 1] = steps_[i];
        --count_;
      }
      return steps_[0].q32;
    }
    /// Maximum from tick `now`, which must not decrease, to the one before `until`.
    std::int64_t most(std::uint64_t now, std::uint64_t until) {
      std::int64_t q32 = at(now);
      for (std::uint32_t i = 1; i < count_; ++i)
        if (steps_[i].from_tick < until && steps_[i].q32 > q32) q32 = steps_[i].q32;
      return q32;
    }
    /// Removes changes from that tick on.
    void keep(std::uint64_t from_tick) {
      while (count_ > 1 && steps_[count_ - 1].from_tick >= from_tick) --count_;
    }
    /// Sets the value from that tick on, replacing later ones. If there is no place left the longer
    /// one of the last two is kept: longer ticks are slower motion.
    void set(std::uint64_t now, std::uint64_t from_tick, std::int64_t q32) {
      at(now);
      keep(from_tick);
      Step& last = steps_[count_ - 1];
      if (last.q32 == q32) return;
      if (count_ < steps_.size())
        steps_[count_++] = {from_tick, q32};
      else if (q32 > last.q32)
        last.q32 = q32;
    }

   private:
    struct Step {
      std::uint64_t from_tick = 0;
      std::int64_t q32 = 0;
    };
    std::array<Step, places> steps_{};
    std::uint32_t count_ = 1;
  };
  Schedule<4> min_ticks_;  ///< no tick of motion is shorter
  Schedule<12> length_;    ///< as master; the queue of segments may contain as many windows
  std::uint32_t max_tick_q16_ = full_tick_q16;
  /// Start times of the latest beats; an edge is reported up to some beats after its lattice tick
  /// has got its time.
  std::array<ClockQ16, 16> beat_starts_{};
  static std::size_t start_place(std::uint64_t beat) { return static_cast<std::size_t>(beat) % 16; }
};

}  // namespace lamplock::lamp
