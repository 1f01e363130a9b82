// The shot scheduler in a random world: missing, late or doubled edges, withdrawn tokens, holds. In
// any case every point is fired once, in order, and every beat is counted once.
#include "firmware/lamp/shot_scheduler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <vector>

#include "tests/scale.hpp"

namespace lamplock::lamp {
namespace {

using stepper::Segment;

constexpr std::uint32_t lamp_hz = 1000;

settings::Values free_beat() {
  settings::Values values;
  values.set_milli(settings::Id::lamp_frequency, lamp_hz * 1000);
  values.set_milli(settings::Id::lamp_mode, 0);
  return values;
}

Segment shot_segment(std::uint32_t point, std::uint32_t half_window, bool shot = true) {
  Segment s;
  s.ends_point = true;
  s.point = point;
  s.shot = {shot, half_window, 0, 0};
  return s;
}

/// Faults of the world: probabilities per beat.
struct Trouble {
  double drop = 0.1;       ///< no edge
  double late = 0.1;       ///< edge outside the window of the shot
  double stray = 0.05;     ///< an edge that the beat clock does not accept
  double unjudged = 0.02;  ///< the true edge is not accepted by the beat clock
  double hold = 0.01;      ///< firing forbidden for a while
  double lazy = 0.3;       ///< the main loop does not run
};

/// Machine, hardware and main loop around a scheduler, beat by beat, as in the board and the job
/// runner.
class World {
 public:
  World(std::uint64_t seed, const Trouble& trouble, std::uint32_t points)
      : random_(seed), trouble_(trouble), total_(points), done_(points), passes_(points) {
    clock_.configure(free_beat());
    ticks_ = clock_.beat_ticks();
    for (std::uint32_t i = 0; i < points; ++i) passes_[i] = chance(0.1);
    fired_.resize(points);
    scheduler_.begin_job();
    scheduler_.permit(true, BeatReason::no_point_due);
    beat_ = 10;
    plan_beat_ = beat_ + 2;
  }

  bool finished() const { return first_open() == total_; }
  std::uint32_t passed_points() const {
    return static_cast<std::uint32_t>(std::count(passes_.begin(), passes_.end(), true));
  }

  void next_beat() {
    const std::uint64_t lattice = clock_.tick_of_beat(beat_);
    hold_or_resume();
    advance_to(lattice - ticks_ / 2 + 1);
    main_loop();
    take_token();
    struct Event {
      std::uint64_t tick;
      bool real;
    };
    std::vector<Event> events;
    if (!chance(trouble_.drop)) {
      const std::uint64_t off = chance(trouble_.late) ? ticks_ / 5 : random_() % (ticks_ / 16);
      events.push_back({chance(0.5) ? lattice + off : lattice - off, true});
    }
    if (chance(trouble_.stray))
      events.push_back({lattice - ticks_ / 3 + random_() % (2 * ticks_ / 3), false});
    std::sort(events.begin(), events.end(),
              [](const Event& a, const Event& b) { return a.tick < b.tick; });
    for (const Event& e : events) {
      expire_before(e.tick);
      if (chance(0.3)) main_loop();
      take_token();
      edge(e.tick, e.real && !chance(trouble_.unjudged));
    }
    expire_before(lattice + ticks_ / 2);
    read_outcomes();
    take_token();
    ++beat_;
  }

  void check() const {
    const std::uint32_t open = first_open();
    for (std::uint32_t i = 0; i < total_; ++i) {
      ASSERT_LE(fired_[i], 1) << "point " << i << " fired twice";
      if (done_[i] && !passes_[i]) {
        ASSERT_EQ(fired_[i], 1) << "point " << i << " done without a shot";
      }
      if (i >= open) {
        ASSERT_FALSE(passes_[i] && fired_[i] != 0);
      }
    }
    ASSERT_TRUE(in_order_) << "points fired out of order";
    ASSERT_EQ(scheduler_.stray_shots(), 0u);
    ASSERT_TRUE(one_token_) << "two tokens at a time";
    ASSERT_FALSE(token_while_blocked_) << "a token before a miss was repaired";
  }

  /// Compares the world's count of beats from the first shot to the last with the scheduler's.
  void check_ledger() const {
    const BeatLedger& ledger = scheduler_.ledger();
    ASSERT_EQ(ledger.shots(), shots_);
    ASSERT_EQ(ledger.beats(), last_shot_beat_ - first_shot_beat_ + 1);
    std::uint64_t sum = 0;
    for (const std::uint32_t beats : ledger.by_reason()) sum += beats;
    ASSERT_EQ(sum, ledger.beats());
    ASSERT_EQ(ledger.by_reason()[static_cast<std::size_t>(BeatReason::fired)], shots_);
    ASSERT_EQ(ledger.beats_before(), first_shot_beat_ - first_judged_beat_);
  }
  std::uint32_t misses() const { return misses_; }
  std::uint32_t shots() const { return shots_; }

 private:
  struct Run {
    Segment segment;
    std::uint64_t first_beat, last_beat;
  };

  bool chance(double p) { return std::uniform_real_distribution<double>(0, 1)(random_) < p; }

  std::uint32_t first_open() const {
    return static_cast<std::uint32_t>(std::find(done_.begin(), done_.end(), false) - done_.begin());
  }

  void advance_to(std::uint64_t tick) {
    while (clock_.next_tick() < tick)
      clock_.next_span(static_cast<std::uint32_t>(tick - clock_.next_tick()));
  }

  // Main loop.
  void hold_or_resume() {
    if (!held_ && chance(trouble_.hold)) {
      held_ = true;
      scheduler_.permit(false, BeatReason::hold);
      withdraw();
      machine_.clear();
      scheduler_.cancel_after(beat_ - 1);
      start_again();
    } else if (held_ && chance(0.3)) {
      held_ = false;
      scheduler_.permit(true, BeatReason::no_point_due);
    }
  }

  void start_again() {
    next_ = first_open();
    plan_beat_ = std::max(plan_beat_at_rest(), beat_ + 1);
  }
  std::uint64_t plan_beat_at_rest() const {
    return machine_.empty() ? beat_ + 1 : machine_.back().last_beat;
  }

  void main_loop() {
    if (chance(trouble_.lazy)) return;
    read_outcomes();
    if (held_) return;
    while (next_ < total_ && machine_.size() < 8 && scheduler_.free() != 0) {
      if (done_[next_]) {
        ++next_;
        continue;
      }
      plan_beat_ = std::max(plan_beat_, beat_ + 1);
      const std::uint64_t beats = 1 + random_() % 3;
      const Segment s = shot_segment(next_, ticks_ / 8, !passes_[next_]);
      ASSERT_TRUE(scheduler_.commit(s, plan_beat_ + 1, plan_beat_ + beats));
      machine_.push_back({s, plan_beat_ + 1, plan_beat_ + beats});
      plan_beat_ += beats;
      ++next_;
    }
  }

  void read_outcomes() {
    PointOutcome o;
    bool missed = false;
    while (scheduler_.outcome(o)) {
      if (o.outcome == ShotResult::missed) {
        missed = true;
        ++misses_;
        continue;
      }
      ASSERT_LT(o.point, total_);
      ASSERT_EQ(o.outcome == ShotResult::passed, passes_[o.point]);
      done_[o.point] = true;
    }
    if (missed) go_back();
  }

  void go_back() {
    // Segments that run are completed, segments that have not begun are cancelled.
    while (!machine_.empty() && machine_.back().first_beat > beat_ + 1) machine_.pop_back();
    scheduler_.restart(BeatReason::returning);
    if (!machine_.empty()) scheduler_.cancel_after(machine_.back().last_beat);
    start_again();
    blocked_ = false;
  }

  // Hardware.
  void take_token() {
    FireToken token;
    if (!scheduler_.next_token(token, clock_, clock_.next_tick())) return;
    one_token_ = one_token_ && !token_held_;
    token_while_blocked_ = token_while_blocked_ || blocked_;
    token_ = token;
    token_held_ = true;
  }

  void withdraw() {
    if (!token_held_) return;
    token_held_ = false;
    scheduler_.token_expired();
  }

  void expire_before(std::uint64_t tick) {
    advance_to(tick);
    while (!machine_.empty() && clock_.tick_of_beat(machine_.front().last_beat) + ticks_ / 4 < tick)
      machine_.pop_front();
    if (token_held_ && token_.expires_tick <= tick) withdraw();
  }

  void edge(std::uint64_t tick, bool judged) {
    const bool loaded =
        token_held_ && !held_ && tick >= token_.not_before_tick && tick < token_.expires_tick;
    const Run* armed = nullptr;
    for (const Run& run : machine_) {
      const std::uint64_t lattice = clock_.tick_of_beat(run.last_beat);
      const std::uint32_t half = run.segment.shot.half_window_ticks;
      if (run.segment.shot.present && lattice - half <= tick && tick < lattice + half) armed = &run;
    }
    const bool fired = loaded && armed != nullptr;
    if (fired) shot(armed->segment.point);
    if (loaded) token_held_ = false;
    EdgeInfo info;
    if (judged) {
      info = {true, beat_, judged_any_ ? static_cast<std::uint32_t>(beat_ - next_judged_) : 0};
      if (!judged_any_) first_judged_beat_ = beat_;
      judged_any_ = true;
      next_judged_ = beat_ + 1;
    }
    scheduler_.edge(info, fired, loaded);
    blocked_ = blocked_ || (loaded && !fired && judged);
  }

  void shot(std::uint32_t point) {
    ++fired_[point];
    ++shots_;
    in_order_ = in_order_ && point >= last_point_;
    last_point_ = point + 1;
    if (first_shot_beat_ == 0) first_shot_beat_ = beat_;
    last_shot_beat_ = beat_;
    if (!judged_any_) {
      judged_any_ = true;
      first_judged_beat_ = next_judged_ = beat_;
    }
  }

  std::mt19937_64 random_;
  Trouble trouble_;
  BeatClock clock_;
  ShotScheduler scheduler_;
  std::uint32_t ticks_ = 0;
  std::uint32_t total_, next_ = 0;
  std::vector<bool> done_, passes_;
  std::vector<int> fired_;
  std::deque<Run> machine_;
  std::uint64_t beat_ = 0, plan_beat_ = 0;
  bool held_ = false, token_held_ = false, blocked_ = false;
  FireToken token_;
  std::uint64_t next_judged_ = 0, first_judged_beat_ = 0;
  bool judged_any_ = false;
  std::uint32_t misses_ = 0, shots_ = 0, last_point_ = 0;
  std::uint64_t first_shot_beat_ = 0, last_shot_beat_ = 0;
  bool in_order_ = true, one_token_ = true, token_while_blocked_ = false;
};

TEST(ShotScheduler, FiresEveryPointOnceInOrderDespiteFaults) {
  std::uint32_t misses = 0;
  for (int i = 0; i < test::scaled(400); ++i) {
    SCOPED_TRACE(testing::Message() << "world " << i);
    World world(static_cast<std::uint64_t>(i) + 8000, Trouble{}, 60);
    for (int beats = 0; !world.finished(); ++beats) {
      ASSERT_LT(beats, 10'000) << "the job does not end";
      ASSERT_NO_FATAL_FAILURE(world.next_beat());
      ASSERT_NO_FATAL_FAILURE(world.check());
    }
    ASSERT_NO_FATAL_FAILURE(world.check_ledger());
    ASSERT_EQ(world.shots() + world.passed_points(), 60u);
    misses += world.misses();
  }
  EXPECT_GT(misses, static_cast<std::uint32_t>(test::scaled(400)) *
                        5);  // the world must have had many faults
}

TEST(ShotScheduler, MissesNothingInAWorldWithoutFaults) {
  World world(1, {0, 0, 0, 0, 0, 0}, 500);
  for (int beats = 0; !world.finished(); ++beats) {
    ASSERT_LT(beats, 2'000);
    ASSERT_NO_FATAL_FAILURE(world.next_beat());
  }
  ASSERT_NO_FATAL_FAILURE(world.check());
  ASSERT_NO_FATAL_FAILURE(world.check_ledger());
  EXPECT_EQ(world.misses(), 0u);
}

/// Scheduler and clock driven by hand, for single rules.
class ByHand : public testing::Test {
 protected:
  ByHand() {
    clock_.configure(free_beat());
    scheduler_.begin_job();
    scheduler_.permit(true, BeatReason::no_point_due);
  }
  bool token(FireToken& out) { return scheduler_.next_token(out, clock_, clock_.next_tick()); }
  /// Sets the lengths of ticks up to the one of this beat.
  void time_up_to(std::uint64_t beat) {
    const std::uint64_t tick = clock_.tick_of_beat(beat);
    while (clock_.next_tick() < tick)
      clock_.next_span(static_cast<std::uint32_t>(tick - clock_.next_tick()));
  }
  std::vector<PointOutcome> outcomes() {
    std::vector<PointOutcome> all;
    PointOutcome o;
    while (scheduler_.outcome(o)) all.push_back(o);
    return all;
  }
  BeatClock clock_;
  ShotScheduler scheduler_;
};

TEST_F(ByHand, TokensComeOneAtATimeAndForOneBeat) {
  scheduler_.commit(shot_segment(0, 50), 3, 4);
  scheduler_.commit(shot_segment(1, 50), 5, 5);
  FireToken first, second;
  time_up_to(3);
  EXPECT_FALSE(token(first)) << "its move may still be planned again";
  time_up_to(4);
  ASSERT_TRUE(token(first));
  EXPECT_EQ(first.beat, 4u);
  EXPECT_EQ(first.expires_tick,
            clock_.tick_of_beat(4) - clock_.delay_ticks() + max_decision_ticks + 50);
  EXPECT_EQ(first.not_before_tick,
            clock_.tick_of_beat(4) - clock_.delay_ticks() - clock_.beat_ticks() / 2);
  EXPECT_FALSE(token(second));
  scheduler_.edge({true, 3, 0}, false, false);
  EXPECT_FALSE(token(second)) << "the beat before the shot does not spend its token";
  scheduler_.edge({true, 4, 0}, true, true);
  time_up_to(5);
  ASSERT_TRUE(token(second));
  EXPECT_EQ(second.beat, 5u);
  const auto done = outcomes();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].outcome, ShotResult::fired);
}

/// A token that outlived its arm window could fire at the next point.
TEST_F(ByHand, ATokenEndsBeforeTheNextArmWindowForAnyDelay) {
  std::mt19937_64 random(3);
  for (int i = 0; i < test::scaled(200); ++i) {
    const std::int32_t milli_hz =
        std::uniform_int_distribution<std::int32_t>(100'000, 8'000'000)(random);
    const auto beat_us = static_cast<std::int32_t>(1'000'000'000 / milli_hz);
    const std::int32_t delay_us =
        std::uniform_int_distribution<std::int32_t>(5, std::min(beat_us - 2, 1000))(random);
    settings::Values values = free_beat();
    values.set_milli(settings::Id::lamp_frequency, milli_hz);
    values.set_milli(settings::Id::q_switch_delay, delay_us * 1000);
    clock_.configure(values);
    scheduler_.begin_job();
    // The widest window is a quarter of a beat to each side.
    const std::uint32_t half_window = clock_.beat_ticks() / 4;
    const std::uint64_t beat = clock_.next_beat() + 1;
    scheduler_.commit(shot_segment(0, half_window), beat, beat);
    time_up_to(beat);
    FireToken shot;
    ASSERT_TRUE(scheduler_.next_token(shot, clock_, clock_.tick_of_beat(beat - 1)));
    const std::uint64_t arm_lead = clock_.delay_ticks() - max_decision_ticks;
    EXPECT_GE(shot.expires_tick, clock_.tick_of_beat(beat) - arm_lead + half_window);
    EXPECT_LT(shot.expires_tick, clock_.tick_of_beat(beat + 1) - arm_lead - half_window)
        << milli_hz << " mHz, delay " << delay_us << " us";
  }
}

TEST_F(ByHand, AMissBlocksUntilTheRestart) {
  for (std::uint32_t i = 0; i < 4; ++i) scheduler_.commit(shot_segment(i, 50), 3 + i, 3 + i);
  FireToken t;
  time_up_to(3);
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 3, 0}, false, true);  // outside the window
  EXPECT_FALSE(token(t));
  scheduler_.edge({true, 4, 0}, false, false);
  EXPECT_FALSE(token(t));
  ASSERT_FALSE(outcomes().empty());
  scheduler_.restart(BeatReason::returning);
  scheduler_.cancel_after(5);
  time_up_to(5);
  EXPECT_FALSE(token(t)) << "a shot planned before the restart must not fire";
  scheduler_.commit(shot_segment(0, 50), 6, 8);
  time_up_to(8);
  ASSERT_TRUE(token(t));
  EXPECT_EQ(t.beat, 8u);
}

TEST_F(ByHand, NothingFiresWithoutAPermit) {
  scheduler_.commit(shot_segment(0, 50), 3, 3);
  time_up_to(3);
  scheduler_.permit(false, BeatReason::door);
  FireToken t;
  EXPECT_FALSE(token(t));
  EXPECT_FALSE(scheduler_.permitted());
  scheduler_.edge({true, 3, 0}, false, false);
  const auto done = outcomes();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].outcome, ShotResult::missed);
}

TEST_F(ByHand, ANewJobDiscardsTheOldOne) {
  scheduler_.commit(shot_segment(7, 50), 3, 3);
  time_up_to(3);
  scheduler_.begin_job();
  FireToken t;
  EXPECT_FALSE(token(t));
  scheduler_.edge({true, 3, 0}, false, false);
  EXPECT_TRUE(outcomes().empty());
}

TEST_F(ByHand, ATokenSpentOnAStrayEdgeIsIssuedAgain) {
  scheduler_.commit(shot_segment(0, 50), 3, 3);
  time_up_to(3);
  FireToken t;
  ASSERT_TRUE(token(t));
  scheduler_.edge({}, false, true);  // a stray edge before the window took it
  ASSERT_TRUE(token(t));
  EXPECT_EQ(t.beat, 3u);
  scheduler_.edge({true, 3, 0}, true, true);
  const auto done = outcomes();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].outcome, ShotResult::fired);
}

TEST_F(ByHand, ALateResultBelongsToItsToken) {
  // An early edge is taken for the edge of the beat; the lamp's own edge fires the token, and that
  // result arrives late.
  scheduler_.commit(shot_segment(0, 50), 3, 3);
  scheduler_.commit(shot_segment(1, 50), 4, 5);
  time_up_to(3);
  FireToken t, other;
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 3, 0}, false, false);
  EXPECT_TRUE(outcomes().empty()) << "the token may still fire";
  EXPECT_TRUE(scheduler_.token_out());
  EXPECT_TRUE(scheduler_.undecided());
  time_up_to(5);
  EXPECT_FALSE(token(other)) << "a second token";
  scheduler_.edge({true, 4, 0}, false, false);
  EXPECT_TRUE(outcomes().empty());
  scheduler_.edge({}, true, true);  // the result of beat 3
  auto done = outcomes();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].point, 0u);
  EXPECT_EQ(done[0].outcome, ShotResult::fired);
  EXPECT_EQ(scheduler_.stray_shots(), 0u);
  EXPECT_EQ(scheduler_.ledger().shots(), 1u);
  ASSERT_TRUE(token(other));
  EXPECT_EQ(other.beat, 5u);
  scheduler_.edge({true, 5, 0}, true, true);
  done = outcomes();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].point, 1u);
  // Beats 3, 4 and 5, each counted once.
  const BeatsByReason outside = scheduler_.ledger().outside();
  std::uint32_t beats = 0;
  for (std::size_t i = 0; i < outside.size(); ++i)
    beats += outside[i] + scheduler_.ledger().by_reason()[i];
  EXPECT_EQ(beats, 3u);
}

TEST_F(ByHand, APassedBeatIsMissedWhenItsTokenIsWithdrawn) {
  scheduler_.commit(shot_segment(0, 50), 3, 3);
  scheduler_.commit(shot_segment(1, 50), 4, 4);
  time_up_to(3);
  FireToken t;
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 4, 1}, false, false);  // beat 3 had no edge
  EXPECT_TRUE(outcomes().empty());
  scheduler_.token_expired();
  scheduler_.edge({true, 5, 0}, false, false);
  const auto done = outcomes();
  ASSERT_EQ(done.size(), 2u);
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_EQ(done[i].point, i);
    EXPECT_EQ(done[i].outcome, ShotResult::missed);
  }
}

TEST_F(ByHand, ATokenSpentOnThePrecedingBeatIsIssuedAgain) {
  scheduler_.commit(shot_segment(0, 50), 3, 4);
  time_up_to(4);
  FireToken t;
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 3, 0}, false, true);  // late: the token for beat 4 was loaded already
  EXPECT_FALSE(scheduler_.token_out());
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 4, 0}, true, true);
  const auto done = outcomes();
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].outcome, ShotResult::fired);
}

TEST_F(ByHand, EveryBeatHasItsReason) {
  Segment s = shot_segment(0, 50);
  scheduler_.commit(s, 3, 4);
  time_up_to(4);
  FireToken t;
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 2, 0}, false, false);  // before the job's first shot: kept apart
  scheduler_.edge({true, 3, 0}, false, false);
  scheduler_.edge({true, 4, 0}, true, true);
  EXPECT_EQ(scheduler_.ledger().beats_before(), 2u);
  scheduler_.commit(shot_segment(1, 50, false), 5, 6);  // a pass
  scheduler_.commit(shot_segment(2, 50), 7, 9);
  time_up_to(9);
  ASSERT_TRUE(token(t));
  scheduler_.edge({true, 6, 1}, false, false);  // no edge on beat 5
  scheduler_.permit(false, BeatReason::hold);
  scheduler_.edge({true, 7, 0}, false, false);
  scheduler_.permit(true, BeatReason::no_point_due);
  scheduler_.edge({true, 8, 0}, false, false);
  EXPECT_EQ(scheduler_.ledger().beats(), 1u) << "beats after the last shot wait for the next one";
  scheduler_.edge({true, 9, 0}, true, true);
  const BeatsByReason& by = scheduler_.ledger().by_reason();
  const auto count = [&](BeatReason r) { return by[static_cast<std::size_t>(r)]; };
  EXPECT_EQ(count(BeatReason::fired), 2u);
  EXPECT_EQ(count(BeatReason::no_edge), 1u);
  EXPECT_EQ(count(BeatReason::hold), 1u);
  EXPECT_EQ(count(BeatReason::moving), 1u);
  EXPECT_EQ(count(BeatReason::no_point_due), 1u);
  EXPECT_EQ(scheduler_.ledger().beats(), 6u);
}

TEST_F(ByHand, RefusesMoreThanItsCapacity) {
  for (std::uint32_t i = 0; i < ShotScheduler::capacity; ++i)
    ASSERT_TRUE(scheduler_.commit(shot_segment(i, 50), 3 + i, 3 + i));
  EXPECT_EQ(scheduler_.free(), 0u);
  EXPECT_FALSE(scheduler_.commit(shot_segment(0, 50), 900, 900));
}

TEST_F(ByHand, AnUnplannedShotIsCounted) {
  scheduler_.edge({true, 3, 0}, true, false);
  EXPECT_EQ(scheduler_.stray_shots(), 1u);
}

}  // namespace
}  // namespace lamplock::lamp
