// The shot scheduler: only this code may fire.
//
// In:  from the main loop, the beats of each point (commit); from the beat interrupt, every edge
//      and whether the hardware fired on it.
// Out: tokens, each the right to one shot on one beat; outcomes for the main loop; one counter per
//      beat.
// Level: commit, cancel, outcome: main loop. edge, next_token, token_expired, photosensors: beat
//      interrupt.
//
// A shot needs all of: a token (issued here, one at a time), the arm bit of the lattice (true by
// construction where the machine is in position), the edge itself. The hardware decides on the
// edge; code that is late can only lose a shot, never misplace one. A point that was not fired
// blocks every later shot until the main loop has planned the return to it, so that points are
// fired in order. A point whose token is out is decided by what the board reports about the token
// (spent or withdrawn), never because its beat has passed: FIRE may spend it on an edge that the
// beat clock does not count. No other token is issued before.
//
// The board requests a token after each edge and at least every 250 us, and reports as often which
// photosensors have answered.
//
// A shot whose photosensor does not answer in time was not made. Where such shots are repeated the
// outcome waits for the sensor, and so does the next token; a shot not made is a miss like any
// other, until the same point has failed too often: then the main loop must hold.
//
//  life of a token:   a beat       half a beat before its edge             arm window closes
//                      | may be taken | may be loaded .................... | withdrawn
#pragma once

#include <array>
#include <cstdint>

#include "firmware/lamp/beam_path.hpp"
#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/protection.hpp"
#include "firmware/stepper/segment.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::lamp {

/// From an edge to the decision on it, at most (machine::fire_decision_clocks). The arm window is
/// the delay of the shot less this time before the lattice tick.
inline constexpr std::uint32_t max_decision_ticks = 3;

/// The right to one shot.
struct FireToken {
  std::uint64_t beat = 0;
  std::uint64_t not_before_tick = 0;  ///< load into the hardware from this tick on
  std::uint64_t expires_tick = 0;     ///< withdraw at this tick, at the end of the arm window
  std::uint8_t channel = 0;
  std::uint16_t energy = 0;
};

/// ShotResult of a point on its beat.
enum class ShotResult : std::uint8_t { fired, passed, missed };
struct PointOutcome {
  std::uint32_t point = 0;
  ShotResult outcome = ShotResult::missed;
};

/// Rules of the laser for the shots of a job.
struct ShotRules {
  std::uint32_t min_beats = 1;  ///< minimum from one shot to the next
  ShotCheck check = ShotCheck::ignore;
  std::uint32_t answer_clocks = 0;  ///< LAMP SYNC to the end of the sensor's time
  std::uint32_t repeats = 0;        ///< of a shot not made, before the job is held
};

/// Results of the photosensors in a job.
struct CheckCounts {
  std::uint32_t made = 0, not_made = 0;
  std::uint32_t repeats = 0;  ///< shots at a point whose last shot was not made
};

/// Counters of beats; those after the last shot are kept separately until the next one.
class BeatLedger {
 public:
  void reset();
  void count(BeatReason reason, std::uint32_t beats);
  /// The reason of a beat since the last shot was wrong: uncounts it.
  void take_back(BeatReason reason);

  std::uint32_t shots() const { return shots_; }
  std::uint32_t beats() const { return beats_; }  ///< first to last shot, inclusive
  std::uint32_t beats_before() const { return beats_before_; }
  const BeatsByReason& by_reason() const { return total_; }
  /// Beats before the first shot and after the last one: with by_reason() every beat of the job.
  BeatsByReason outside() const;

 private:
  std::uint32_t shots_ = 0, beats_ = 0, beats_before_ = 0, pending_beats_ = 0;
  BeatsByReason total_{}, before_{}, pending_{};
};

/// One per controller.
class ShotScheduler {
 public:
  static constexpr std::uint32_t capacity = 128;

  // Main loop.
  /// Changes the rules within a job, at rest and with no undecided shot: another beat.
  void change_rules(const ShotRules& rules) { rules_ = rules, has_shot_ = false; }
  /// Drops all plans and counts; a shot of an earlier job is impossible afterwards.
  [[gnu::cold]] void begin_job(const ShotRules& rules = {});
  /// A segment was committed that covers beats first..last (the last one may carry its shot).
  bool commit(const stepper::Segment& segment, std::uint64_t first_beat, std::uint64_t last_beat);
  std::uint32_t free() const { return capacity - (end_ - begin_); }
  /// Drops plans after `beat`, but not a shot whose token is out.
  void cancel_after(std::uint64_t beat);
  /// After a miss: the remaining plans move on without shots, `reason` for their beats; shots are
  /// permitted again from the next commit on.
  void restart(BeatReason reason);
  /// Permits firing or not; if not, beats count with `reason`.
  void permit(bool firing, BeatReason reason) {
    permitted_ = firing, idle_reason_ = reason;
    // A shot that the hardware has decided passes first: it cannot be withdrawn.
    if (!firing && !token_out_) beam_.cut();
  }
  bool permitted() const { return permitted_; }
  /// A planned shot or end of a point was not yet judged by an edge, or by a photosensor.
  bool point_pending() const;
  /// Stops waiting for the photosensor: the last shot counts as fired.
  void end_check();
  /// True once after a point, `point`, has failed too often.
  bool take_failed(std::uint32_t& point);
  BeamPath& beam() { return beam_; }
  const BeamPath& beam() const { return beam_; }
  const CheckCounts& checks() const { return checks_; }
  /// The board holds a token, or has fired on one and not yet reported it.
  bool token_out() const { return token_out_; }
  /// photosensors() needs the answers and their time.
  bool wants_answer() const { return check_.pending; }
  /// A fired shot waits for the answer of its photosensor.
  bool check_pending() const { return check_.pending && rules_.check == ShotCheck::repeat; }
  /// A shot may still be counted, or withdrawn.
  bool undecided() const { return token_out_ || check_pending(); }
  /// Removes the oldest outcome.
  bool outcome(PointOutcome& out);
  /// ShotResult `i` of those not removed yet; false if there are no more. Also beat interrupt.
  bool untaken(std::uint32_t i, PointOutcome& out) const;
  const BeatLedger& ledger() const { return ledger_; }
  /// Shots that the hardware reported on a beat that had none planned; must stay 0.
  std::uint32_t stray_shots() const { return stray_shots_; }

  // Beat interrupt.
  /// The next token, at most a beat ahead of the ticks with a time; false if there is none now.
  /// `present_tick` may be slightly late: a token that is too late expires.
  bool next_token(FireToken& token, const BeatClock& clock, std::uint64_t present_tick);
  /// The token was withdrawn without an edge.
  void token_expired();
  /// An edge that the beat clock has judged; `fired` and `token_spent` from the hardware, which
  /// spends a loaded token on every edge, a stray one too; `clock` is that of the edge.
  void edge(const EdgeInfo& info, bool fired, bool token_spent, std::uint64_t clock = 0);
  /// Photosensors (bits, by channel) that have answered since the last call, made at `clock`.
  void photosensors(std::uint8_t answered, std::uint64_t clock);

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
  struct Check {
    bool pending = false;
    std::uint8_t channel = 0;
    std::uint32_t point = 0;
    std::uint64_t end_clock = 0;
  };

  bool too_soon(std::uint64_t beat) const {
    return has_shot_ && beat - last_shot_beat_ < rules_.min_beats;
  }
  /// The board holds the token of this shot: neither spent nor withdrawn, as far as reported.
  bool is_open(const Plan& plan) const {
    return token_out_ && plan.issued && plan.last_beat == token_beat_;
  }
  void issue_again();
  void shot_fired(const Plan& plan);
  void judge_shot(bool made);
  void report(std::uint32_t point, ShotResult outcome);
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
  /// reason under which that beat was counted
  BeatReason token_beat_reason_ = BeatReason::no_edge;
  std::uint64_t expired_beat_ = ~std::uint64_t{0};
  std::uint64_t counted_end_ = 0;  ///< beats before this one have been counted; 0 = none yet
  std::uint32_t stray_beats_ = 0;  ///< counted because a stray edge fired, since the last good one
  BeatReason idle_reason_ = BeatReason::no_point_due;
  std::uint32_t stray_shots_ = 0;
  BeatLedger ledger_;
  BeamPath beam_;
  ShotRules rules_;
  bool has_shot_ = false;  ///< since power-up
  std::uint64_t last_shot_beat_ = 0;
  std::uint64_t edge_clock_ = 0;  ///< of the edge being judged
  Check check_;
  CheckCounts checks_;
  std::uint32_t failures_ = 0;  ///< of failed_point_, in a row
  std::uint32_t failed_point_ = 0;
  bool to_repeat_ = false;  ///< its last shot was not made
  bool failed_ = false;     ///< too often, not yet reported to the main loop
};

}  // namespace lamplock::lamp
