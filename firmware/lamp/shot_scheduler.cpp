#include "firmware/lamp/shot_scheduler.hpp"

namespace lamplock::lamp {

void BeatLedger::reset() { *this = BeatLedger{}; }

void BeatLedger::count(BeatReason reason, std::uint32_t beats) {
  if (reason != BeatReason::fired) {
    if (shots_ == 0) {
      beats_before_ += beats;
      before_[static_cast<std::size_t>(reason)] += beats;
      return;
    }
    pending_beats_ += beats;
    pending_[static_cast<std::size_t>(reason)] += beats;
    return;
  }
  shots_ += beats;
  const bool no_pending = pending_beats_ == 0;
  beats_ += pending_beats_ + beats;
  pending_beats_ = 0;
  total_[static_cast<std::size_t>(BeatReason::fired)] += beats;
  if (no_pending) return;
  for (std::size_t i = 0; i < total_.size(); ++i) {
    total_[i] += pending_[i];
    pending_[i] = 0;
  }
}

void BeatLedger::take_back(BeatReason reason) {
  const auto i = static_cast<std::size_t>(reason);
  if (shots_ == 0 && before_[i] != 0) --before_[i], --beats_before_;
  if (shots_ != 0 && pending_[i] != 0) --pending_[i], --pending_beats_;
}

BeatsByReason BeatLedger::outside() const {
  BeatsByReason sum = before_;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += pending_[i];
  return sum;
}

void ShotScheduler::begin_job(const ShotRules& rules) {
  rules_ = rules;
  check_.pending = failed_ = to_repeat_ = false;
  checks_ = {};
  failures_ = 0;
  beam_.begin_job();
  end_ = begin_;
  outcome_end_ = outcome_begin_;
  blocked_ = token_out_ = false;
  expired_beat_ = ~std::uint64_t{0};
  counted_end_ = 0;
  ledger_.reset();
}

bool ShotScheduler::commit(const stepper::Segment& s, std::uint64_t first_beat,
                           std::uint64_t last_beat) {
  // A plan that was kept only for its token, now spent or withdrawn, is replaced.
  while (end_ != begin_ && at(end_ - 1).last_beat >= first_beat) end_ = end_ - 1;
  if (free() == 0) return false;
  Plan& p = at(end_);
  p = Plan{};
  p.first_beat = first_beat;
  p.last_beat = last_beat;
  p.reason = s.reason;
  p.ends_point = s.ends_point;
  p.point = s.point;
  p.shot = s.shot.present;
  p.half_window_ticks = s.shot.half_window_ticks;
  p.channel = s.shot.channel;
  p.energy = s.shot.energy;
  end_ = end_ + 1;
  return true;
}

void ShotScheduler::cancel_after(std::uint64_t beat) {
  // A token that the board holds may still fire on an early edge: its plan stays until it is spent
  // or withdrawn, otherwise that shot would have no plan and its point would be fired again.
  while (end_ != begin_ && at(end_ - 1).last_beat > beat) {
    const Plan& last = at(end_ - 1);
    if (token_out_ && last.issued && last.last_beat == token_beat_) break;
    end_ = end_ - 1;
  }
}

void ShotScheduler::restart(BeatReason reason) {
  for (std::uint32_t i = begin_; i != end_; ++i) {
    at(i).shot = at(i).ends_point = false;
    at(i).reason = reason;
  }
  blocked_ = false;
}

bool ShotScheduler::point_pending() const {
  if (check_pending()) return true;
  for (std::uint32_t i = begin_; i != end_; ++i)
    if (plans_[i % capacity].shot || plans_[i % capacity].ends_point) return true;
  return false;
}

bool ShotScheduler::outcome(PointOutcome& out) {
  if (outcome_begin_ == outcome_end_) return false;
  out = outcomes_[outcome_begin_ % capacity];
  outcome_begin_ = outcome_begin_ + 1;
  return true;
}

bool ShotScheduler::untaken(std::uint32_t i, PointOutcome& out) const {
  if (i >= outcome_end_ - outcome_begin_) return false;
  out = outcomes_[(outcome_begin_ + i) % capacity];
  return true;
}

void ShotScheduler::report(std::uint32_t point, ShotResult outcome) {
  outcomes_[outcome_end_ % capacity] = {point, outcome};
  outcome_end_ = outcome_end_ + 1;
  if (outcome == ShotResult::missed) blocked_ = true;
}

void ShotScheduler::shot_fired(const Plan& plan) {
  has_shot_ = true;
  last_shot_beat_ = plan.last_beat;
  if (rules_.check != ShotCheck::ignore) {
    if (check_.pending) judge_shot(false);
    if (to_repeat_ && plan.point == failed_point_) ++checks_.repeats;
    check_ = {true, plan.channel, plan.point, edge_clock_ + rules_.answer_clocks};
  }
  if (rules_.check != ShotCheck::repeat) report(plan.point, ShotResult::fired);
}

void ShotScheduler::judge_shot(bool made) {
  check_.pending = false;
  ++(made ? checks_.made : checks_.not_made);
  if (rules_.check != ShotCheck::repeat) return;
  if (made || failed_point_ != check_.point) failures_ = 0;
  failed_point_ = check_.point;
  to_repeat_ = !made;
  if (!made && ++failures_ > rules_.repeats) {
    failed_ = true;
    failures_ = 0;
  }
  report(check_.point, made ? ShotResult::fired : ShotResult::missed);
}

void ShotScheduler::photosensors(std::uint8_t answered, std::uint64_t clock) {
  if (!check_.pending) return;
  if ((answered >> check_.channel & 1) != 0)
    judge_shot(true);
  else if (clock >= check_.end_clock)
    judge_shot(false);
}

void ShotScheduler::end_check() {
  if (check_pending()) report(check_.point, ShotResult::fired);
  check_.pending = false;
}

bool ShotScheduler::take_failed(std::uint32_t& point) {
  point = failed_point_;
  const bool failed = failed_;
  failed_ = false;
  return failed;
}

void ShotScheduler::pass(const Plan& plan, bool fired) {
  if (plan.shot) {
    if (fired)
      shot_fired(plan);
    else
      report(plan.point, ShotResult::missed);
  } else {
    if (fired) ++stray_shots_;
    if (plan.ends_point) report(plan.point, ShotResult::passed);
  }
}

bool ShotScheduler::next_token(FireToken& token, const BeatClock& clock,
                               std::uint64_t present_tick) {
  if (!permitted_ || blocked_ || token_out_ || check_pending()) return false;
  for (std::uint32_t i = begin_; i != end_; ++i) {
    Plan& p = at(i);
    if (!p.shot || p.issued) continue;
    if (p.last_beat > clock.next_beat() + 1) return false;  // as below, faster
    const std::uint64_t tick = clock.tick_of_beat(p.last_beat);
    // The delay may take most of a beat: a token that is kept after its arm window could fire in
    // the window of the next shot. Too late: the beat passes, edge() reports the miss.
    const std::uint64_t window_end =
        tick - clock.delay_ticks() + max_decision_ticks + p.half_window_ticks;
    if (window_end <= present_tick) return false;
    // Its way may not have begun and may still be replanned: a token that is out cannot be changed.
    if (tick >= clock.next_tick() + clock.beat_ticks()) return false;
    // Too early: the beat passes, and so does the point; the machine returns to it.
    if (too_soon(p.last_beat) || !beam_.take({p.channel, p.energy})) return false;
    p.issued = true;
    token_out_ = true;
    token_beat_ = p.last_beat;
    token_beat_reason_ = BeatReason::no_edge;
    token = {p.last_beat, tick - clock.delay_ticks() - clock.beat_ticks() / 2, window_end,
             p.channel, p.energy};
    return true;
  }
  return false;
}

void ShotScheduler::token_expired() {
  if (!token_out_) return;
  token_out_ = false;
  expired_beat_ = token_beat_;
  for (std::uint32_t i = begin_; i != end_; ++i) {
    Plan& p = at(i);
    if (!p.shot || p.last_beat != token_beat_) continue;
    p.shot = p.ends_point = false;
    report(p.point, ShotResult::missed);
  }
}

BeatReason ShotScheduler::judge(std::uint64_t beat, bool fired) {
  // Beats that passed without an edge: a shot that was due there is missed. While its token is out
  // it is undecided: the hardware may fire on an edge that the beat clock takes for a stray.
  while (begin_ != end_ && at(begin_).last_beat < beat && !is_open(at(begin_))) {
    pass(at(begin_), false);
    begin_ = begin_ + 1;
  }
  if (begin_ == end_ || at(begin_).first_beat > beat) {
    if (fired) ++stray_shots_;
    return fired                                 ? BeatReason::fired
           : permitted_ && beat == expired_beat_ ? BeatReason::outside_tolerance
                                                 : idle_reason_;
  }
  const Plan& p = at(begin_);
  if (p.last_beat < beat) return permitted_ ? BeatReason::returning : idle_reason_;
  if (p.last_beat != beat) {
    if (!permitted_) return idle_reason_;
    // The move may take as long: no shot would have been permitted here in any case.
    return p.reason == BeatReason::moving && too_soon(beat) ? BeatReason::protection : p.reason;
  }
  if (!fired && is_open(p))
    return token_beat_reason_ = permitted_ ? BeatReason::outside_tolerance : idle_reason_;
  begin_ = begin_ + 1;
  const bool was_blocked = blocked_;
  pass(p, fired);
  if (fired) return BeatReason::fired;
  if (!permitted_) return idle_reason_;
  if (p.issued) return BeatReason::outside_tolerance;
  if (was_blocked) return BeatReason::returning;
  return p.reason == BeatReason::moving ? BeatReason::no_point_due : p.reason;
}

void ShotScheduler::edge(const EdgeInfo& info, bool fired, bool token_spent, std::uint64_t clock) {
  edge_clock_ = clock;
  const bool was_out = token_out_;
  if (token_spent || fired) token_out_ = false;
  // Flashes count while the clock searches for the rhythm, before beats have numbers. So do those
  // that it took for strays, unless they were counted when one of them fired.
  if (info.unlocked && !fired) {
    const std::uint32_t before = info.missed > stray_beats_ ? info.missed - stray_beats_ : 0;
    ledger_.count(permitted_ ? BeatReason::not_locked : idle_reason_, before + 1);
  }
  if (info.unlocked || info.valid) stray_beats_ = 0;
  if (info.valid) {
    if (!fired && info.beat < counted_end_) return;  // counted when a stray edge fired on it
    const std::uint64_t open = info.beat > counted_end_ ? info.beat - counted_end_ : 0;
    count_missed(open < info.missed ? static_cast<std::uint32_t>(open) : info.missed);
    count(info.beat, fired);
    if (was_out && token_spent && !fired && info.beat < token_beat_) issue_again();
  } else if (fired && token_beat_ < counted_end_) {
    // The same if an earlier edge was taken for that of its beat: counted, but not as a shot.
    ledger_.take_back(token_beat_reason_);
    ledger_.count(judge(token_beat_, true), 1);
  } else if (fired) {
    // The lattice was right and the beat clock was not: the shot was fired.
    if (counted_end_ != 0 && token_beat_ > counted_end_) {
      const auto open = static_cast<std::uint32_t>(token_beat_ - counted_end_);
      count_missed(open);
      stray_beats_ += open;
    }
    count(token_beat_, true);
    ++stray_beats_;
  } else if (token_spent && was_out) {
    issue_again();
  }
}

/// An edge before that of its beat has spent the token.
void ShotScheduler::issue_again() {
  for (std::uint32_t i = begin_; i != end_; ++i)
    if (at(i).shot && at(i).last_beat == token_beat_) at(i).issued = false;
}

void ShotScheduler::count_missed(std::uint32_t beats) {
  if (beats != 0) ledger_.count(BeatReason::no_edge, beats);
}

void ShotScheduler::count(std::uint64_t beat, bool fired) {
  ledger_.count(judge(beat, fired), 1);
  counted_end_ = beat + 1;
}

}  // namespace lamplock::lamp
