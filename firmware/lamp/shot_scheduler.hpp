// The shot scheduler: the only code that may fire.
//
// In:  from the main loop, which beats belong to which point (commit); from the beat interrupt,
//      every edge and whether the hardware fired on it.
// Out: tokens, each the right to one shot on one beat; outcomes for the main loop; one counter per
//      beat.
// Level: commit, cancel, outcome: main loop. edge, next_token, token_expired: beat interrupt.
//
// A shot needs all of: a token (issued here, one at a time), the arm bit of the lattice (true by
// construction where the machine is in position), the edge itself. The hardware decides on the
// edge; code that is late can only lose a shot, never misplace one. A point that was not fired
// blocks every later shot until the main loop has planned the way back to it, so that points are
// fired in order.
//
// The board asks for a token after each edge and at least every 250 us.
//
//  life of a token:   a beat       half a beat before its lattice tick     arm window closes
//                      | may be taken | may be loaded .................... | withdrawn
#pragma once

#include <array>
#include <cstdint>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::lamp {

/// The right to one shot.
struct FireToken {
  std::uint64_t beat = 0;
  std::uint64_t not_before_tick = 0;  ///< load into the hardware from here on
  std::uint64_t expires_tick = 0;     ///< withdraw here if no edge came
  std::uint8_t channel = 0;
  std::uint16_t energy = 0;
};

/// What became of a point on its beat.
enum class Outcome : std::uint8_t { fired, passed, missed };
struct PointOutcome {
  std::uint32_t point = 0;
  Outcome outcome = Outcome::missed;
};

/// Counters of beats; those after the last shot are kept apart until the next one.
class BeatLedger {
 public:
  void reset();
  void count(BeatReason reason, std::uint32_t beats);

  std::uint32_t shots() const { return shots_; }
  std::uint32_t beats() const { return beats_; }  ///< first to last shot, inclusive
  std::uint32_t beats_before() const { return beats_before_; }
  const BeatsByReason& by_reason() const { return total_; }

 private:
  std::uint32_t shots_ = 0, beats_ = 0, beats_before_ = 0, pending_beats_ = 0;
  BeatsByReason total_{}, pending_{};
};

/// One per controller.
class ShotScheduler {
 public:
  static constexpr std::uint32_t capacity = 128;

  // Main loop.
  /// Forgets everything planned and counted; no shot of an earlier job can follow.
  void begin_job();
  /// A segment was committed that covers beats first..last (the last one may carry its shot).
  bool commit(const stepper::Segment& segment, std::uint64_t first_beat, std::uint64_t last_beat);
  std::uint32_t free() const { return capacity - (end_ - begin_); }
  /// Forgets what is planned after `beat`, but not a shot whose token is out.
  void cancel_after(std::uint64_t beat);
  /// After a miss: what is still planned moves on without shots, `reason` for its beats; shots
  /// are allowed again from the next commit on.
  void restart(BeatReason reason);
  /// Firing permitted or not; when not, beats count with `reason`.
  void permit(bool firing, BeatReason reason) { permitted_ = firing, idle_reason_ = reason; }
  bool permitted() const { return permitted_; }
  /// A shot or the end of a point is planned that no edge has judged yet.
  bool point_pending() const;
  /// The board holds a token, or has fired on one and not yet said so.
  bool token_out() const { return token_out_; }
  /// Takes the oldest outcome.
  bool outcome(PointOutcome& out);
  /// Outcome `i` of those not taken yet; false if there are no more. Also beat interrupt.
  bool untaken(std::uint32_t i, PointOutcome& out) const;
  const BeatLedger& ledger() const { return ledger_; }
  /// Shots that the hardware reported on a beat that had none planned; must stay 0.
  std::uint32_t stray_shots() const { return stray_shots_; }

  // Beat interrupt.
  /// The next right to fire, at most a beat ahead of what has a time; false if there is none now.
  bool next_token(FireToken& token, const BeatClock& clock);
  /// The token was withdrawn without an edge.
  void token_expired();
  /// An edge that the beat clock has judged; `fired` and `token_spent` as the hardware says: it
  /// takes a loaded token on every edge, a stray one too.
  void edge(const EdgeInfo& info, bool fired, bool token_spent);

 private:
  struct Plan {
    std::uint64_t first_beat = 0, last_beat = 0;
    BeatReason reason = BeatReason::moving;
    bool ends_point = false, shot = false, issued = false;
    std::uint32_t point = 0, half_window_ticks = 0;
    std::uint8_t channel = 0;
    std::uint16_t energy = 0;
  };

  Plan& at(std::uint32_t i) { return plans_[i % capacity]; }
  void report(std::uint32_t point, Outcome outcome);
  void pass(const Plan& plan, bool fired);
  BeatReason judge(std::uint64_t beat, bool fired);
  void count_missed(std::uint32_t beats);
  void count(std::uint64_t beat, bool fired);

  std::array<Plan, capacity> plans_{};
  std::uint32_t begin_ = 0, end_ = 0;
  std::array<PointOutcome, capacity> outcomes_{};
  std::uint32_t outcome_begin_ = 0, outcome_end_ = 0;
  bool permitted_ = false;
  bool blocked_ = false;  ///< a point was missed and the main loop has not yet planned the return
  bool token_out_ = false;
  std::uint64_t token_beat_ = 0;
  std::uint64_t expired_beat_ = ~std::uint64_t{0};
  std::uint64_t counted_end_ = 0;  ///< beats before this one have been counted; 0 = none yet
  BeatReason idle_reason_ = BeatReason::no_point_due;
  std::uint32_t stray_shots_ = 0;
  BeatLedger ledger_;
};

}  // namespace lamplock::lamp
