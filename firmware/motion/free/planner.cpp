// The course of a plan: search, improvement, speeds; then without detours or with longer ways.
#include "firmware/motion/free/planner.hpp"

#include <bit>

#include "firmware/motion/free/run_up.hpp"

namespace lamplock::motion {
namespace {

/// Maximum number of times that ways too short for their jerk get more beats, and of those without
/// rest at their ends.
constexpr std::int32_t max_longer = 16, longer_moving = 4;
/// A way that takes more than this share of its beats from rest to rest may be a detour.
constexpr std::int32_t detour_eighths = 7;
/// Labels per point when planning again: the board lacks the time for as many as before.
constexpr std::uint32_t again_labels = 2;

}  // namespace

Result Planner::plan(const PlanRequest& request, std::uint32_t& failed) {
  begin(request);
  while (advance()) {
  }
  if (result_ != Result::ok) failed = failed_;
  return result_;
}

void Planner::begin_search(bool run_ups) {
  run_ups_ = false;
  misfits_ = 0;
  longer_ = 0;
  detours_ = Detours::unknown;
  if (!set_up()) return;
  const std::int32_t steady = run_ups ? steady_beats(window_, start_qs_) : 0;
  if (steady != 0) return keep_speed(steady);
  run_ups_ = run_ups && allow_run_ups(*request_, window_);
  begin_beam();
}

void Planner::begin_beam() {
  guide(window_);
  effort_ = find_effort();
  beam_.begin(window_, effort_);
  phase_ = Phase::search;
  at_ = 0;
}

/// In the middle of an even row: keeps the speed.
void Planner::keep_speed(std::int32_t beats) {
  for (std::uint32_t i = 0; i < request_->count; ++i) {
    beats_[i] = beats;
    for (int a = 0; a < limits_->axes; ++a)
      speed_qs_[i][index(a)] = mean_speed(window_.ways[1].displacement_qs[index(a)], beats).down_qs;
  }
  phase_ = Phase::segments;
  at_ = 0;
}

/// A run-up may lack room: without it the window may be feasible.
void Planner::try_simpler(std::uint32_t place) {
  if (detours_ == Detours::forbidden) return restore_first();
  if (run_ups_) return begin_search(false);
  fail(place);
}

void Planner::fail(std::uint32_t place) {
  failed_ = place;
  result_ = Result::unreachable;
  phase_ = Phase::over;
}

/// Estimated beats of a way, between those at full speed and those of two rests: about their
/// geometric mean.
std::uint32_t Planner::about_beats(const Leg& way) {
  if (way.fixed_beats != 0) return static_cast<std::uint32_t>(way.fixed_beats);
  return isqrt(wide_product(static_cast<std::uint32_t>(way.first_beats),
                            static_cast<std::uint32_t>(way.last_beats)));
}

/// Effort from the mean of the ways; but the long time of a reversal or a run-up among dense points
/// is not available to them: it is before or after them.
Effort Planner::find_effort() const {
  if (request_->mode == wire::JoinMode::start_stop) return {};
  std::uint64_t all = 0, cut = 0;
  for (std::uint32_t i = 0; i < request_->count; ++i) all += about_beats(window_.ways[i]);
  constexpr std::uint32_t long_ways = 8;  // times the mean
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): a window has points
  const std::uint64_t most = long_ways * all / request_->count;
  for (std::uint32_t i = 0; i < request_->count; ++i) {
    const Leg& way = window_.ways[i];
    if (static_cast<std::uint32_t>(way.last_beats) <= most) continue;
    const std::uint32_t about = about_beats(way);
    if (about > most) cut += about - most;
  }
  return effort_for((all - cut) * limits_->beat_ticks / request_->count);
}

bool Planner::advance() {
  switch (phase_) {
    case Phase::search:
      search();
      break;
    case Phase::improve:
      improve();
      break;
    case Phase::speeds:
      choose_speeds();
      break;
    case Phase::segments:
      make_segments();
      break;
    case Phase::path:
      plan_path();
      break;
    case Phase::over:
      break;
  }
  return phase_ != Phase::over;
}

void Planner::search() {
  if (!beam_.extend(window_, at_)) return try_simpler(at_);
  if (++at_ < request_->count) return;
  beam_.trace(window_, beats_);
  if (detours_ == Detours::unknown && request_->count <= short_window)
    for (std::uint32_t i = 0; i < request_->count; ++i)
      found_[i] = static_cast<std::uint16_t>(beats_[i]);
  if (!improver_.begin(window_, effort_, beats_)) return try_simpler(0);
  phase_ = Phase::improve;
}

void Planner::improve() {
  if (request_->mode != wire::JoinMode::start_stop &&
      (improver_.advance(window_, beats_) || search_again()))
    return;
  at_ = 0;
  phase_ = Phase::speeds;
}

/// A quick start can lead to a detour: too fast past a near point, and back again. The beam notices
/// that too late. True if a short window needs more work: it is searched again without such
/// detours, and the better plan is kept.
bool Planner::search_again() {
  if (detours_ == Detours::accepted || request_->count > short_window) return false;
  std::int32_t total = 0;
  for (std::uint32_t i = 0; i < request_->count; ++i) total += beats_[i];
  if (detours_ == Detours::forbidden) {
    detours_ = Detours::accepted;
    if (total < first_total_) return false;
    restore_first();
    return true;
  }
  first_total_ = total;
  detours_ = Detours::accepted;
  if (!forbid_detours()) return false;
  detours_ = Detours::forbidden;
  begin_beam();
  return true;
}

/// Where a way takes as long as from rest, or nearly, and where the search was disappointed:
/// restricts the speeds before it to those from which it takes just the time from rest to rest. All
/// axes can do that at once. False if there is no such way.
bool Planner::forbid_detours() {
  bool any = false;
  for (std::uint32_t i = 1; i < request_->count; ++i) {
    const Leg& way = window_.ways[i];
    const std::int32_t at_rest = way.last_beats - beats_beyond_rest;
    if (way.fixed_beats != 0) continue;
    const bool slow_way = 8 * beats_[i] > detour_eighths * at_rest;
    if (!slow_way && (beam_.disappointed() >> i & 1) == 0) continue;
    Box slow;
    if (!step_back(window_, i, way.allowed, at_rest, slow)) continue;
    window_.ways[i - 1].allowed = slow;
    any = true;
  }
  return any;
}

/// Makes the first plan again: the same window, starting with the same beats.
void Planner::restore_first() {
  detours_ = Detours::accepted;
  set_up();
  if (run_ups_) allow_run_ups(*request_, window_);
  guide(window_);
  for (std::uint32_t i = 0; i < request_->count; ++i) beats_[i] = found_[i];
  // It was feasible before.
  if (!improver_.begin(window_, effort_, beats_)) return fail(0);
  phase_ = Phase::improve;
}

void Planner::choose_speeds() {
  choose_smooth_speeds(window_, improver_, beats_, static_cast<int>(at_), start_qs_[at_],
                       speed_qs_);
  if (++at_ < static_cast<std::uint32_t>(limits_->axes)) return;
  at_ = 0;
  phase_ = Phase::segments;
}

void Planner::plan_path() {
  if (at_ == 0 && path_.advance()) return;
  if (path_.result() != Result::ok) return fail(path_.failed());
  segments_[at_] = path_.segment(at_);
  beats_[at_] = path_.beats(at_);
  if (++at_ < request_->commits()) return;
  result_ = Result::ok;
  phase_ = Phase::over;
}

/// Ways without a feasible profile, because of limited jerk or rounding, get more beats; if that
/// does not help the machine rests at both ends: then enough beats always make it feasible.
void Planner::take_longer() {
  const auto first = static_cast<std::uint32_t>(std::countr_zero(misfits_));
  if (++longer_ > max_longer) return try_simpler(first);
  for (std::uint32_t i = first; i < request_->commits(); ++i) {
    if ((misfits_ >> i & 1) == 0) continue;
    Leg& way = window_.ways[i];
    if (way.fixed_beats == 0) {
      way.first_beats = beats_[i] + 1 + beats_[i] * longer_ / 8;
      if (way.first_beats >= window_.max_beats) return try_simpler(i);
      if (way.last_beats <= way.first_beats) way.last_beats = way.first_beats + 1;
    }
    if (longer_ <= longer_moving && way.fixed_beats == 0) continue;
    way.allowed = {};
    if (i > 0) window_.ways[i - 1].allowed = {};
  }
  misfits_ = 0;
  detours_ = Detours::accepted;
  guide(window_);
  effort_ = find_effort();
  if (effort_.labels > again_labels) effort_.labels = again_labels;
  beam_.begin(window_, effort_);
  phase_ = Phase::search;
  at_ = 0;
}

}  // namespace lamplock::motion
