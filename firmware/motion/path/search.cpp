// The search of the path planner: beats and reachable speeds, as labels, point by point.
#include "firmware/motion/path/planner.hpp"
#include "firmware/motion/path/reach.hpp"

namespace lamplock::motion {
namespace {

/// Times tried per label; with pulses each is divided in some ways, and more are no better.
constexpr int candidates_per_label = 8, candidates_with_pulses = 3;

std::int64_t min_of(std::int64_t a, std::int64_t b) { return a < b ? a : b; }

std::int32_t larger(std::int32_t a, std::int32_t b) { return a > b ? a : b; }

}  // namespace

void PathPlanner::search() {
  if (!extend(at_, careful_)) {
    failed_ = at_;
    if (careful_) phase_ = Phase::over;
    // From speed the quickest labels may all be dead ends; the slowest never are.
    careful_ = true;
    at_ = 0;
    return;
  }
  if (++at_ < request_->count) return;
  choose_beats();
  choose_speeds();
  at_ = 0;
  phase_ = Phase::check;
}

bool PathPlanner::extend(std::uint32_t i, bool careful) {
  stages_[i].beam.count = 0;
  if (!beats_allowed(i)) return false;
  const std::uint32_t parents = i == 0 ? 1 : stages_[i - 1].beam.count;
  for (std::uint32_t p = 0; p < parents; ++p) extend(i, p, careful);
  return stages_[i].beam.count != 0;
}

bool PathPlanner::beats_allowed(std::uint32_t i) const {
  const std::int32_t fixed = fixed_beats(i);
  if (fixed == 0) return true;
  return fixed <= max_beats_ && (target(i).shots == 0 || fixed >= request_->min_beats);
}

std::int32_t PathPlanner::fixed_beats(std::uint32_t i) const {
  return request_->at_least[i] != 0 ? 0 : target(i).beats;
}

std::int32_t PathPlanner::min_beats(std::uint32_t i) const {
  const std::int32_t least = larger(1, request_->at_least[i]);
  return target(i).shots == 0 ? least : larger(least, request_->min_beats);
}

SpeedInterval PathPlanner::start_speeds(std::uint32_t i, const SpeedInterval& end) const {
  const Stage& stage = stages_[i];
  const std::int64_t lo = scaled(end.lo_q32, stage.from_previous);
  const std::int64_t hi = scaled(end.hi_q32, stage.from_previous);
  return {min_of(lo, stage.line.speed_q32), min_of(hi, stage.line.speed_q32)};
}

bool PathPlanner::step(std::uint32_t i, const SpeedInterval& from, std::int32_t beats, int split,
                       SpeedInterval& to) const {
  const Stage& stage = stages_[i];
  to = {0, 0};
  if (stage.is_at_rest()) return from.lo_q32 == 0;
  const std::int64_t end = end_asked_q32(i);
  if (stage.has_pulses() ? !pulse_reach(stage.line, from, beats, split, end, to)
                         : !path_reach(stage.way(), from, beats, end, to))
    return false;
  to = {min_of(to.lo_q32, stage.end_q32), min_of(to.hi_q32, stage.end_q32)};
  return true;
}

/// Highest speed to search at the end of line i. A plan that follows starts at a speed from which
/// the previous plan could just reach this point in time, within its rounding.
std::int64_t PathPlanner::end_asked_q32(std::uint32_t i) const {
  constexpr std::int64_t rounding = 64;
  const std::int64_t end = stages_[i].end_q32;
  return i == 0 && request_->follows ? end + rounding + (end >> 28) : end;
}

/// The reverse: speeds at the start of a line that has a length, for those at its end.
bool PathPlanner::step_back(std::uint32_t i, const SpeedInterval& end, std::int32_t beats,
                            int split, SpeedInterval& start) const {
  const Stage& stage = stages_[i];
  if (stage.has_pulses())
    return pulse_reach(stage.line, end, beats, mirrored_split(split), stage.line.speed_q32, start);
  return path_reach(stage.way(), end, beats, stage.line.speed_q32, start);
}

/// Fewest beats for a line that has a length, in either direction; 0 = there are none.
std::int32_t PathPlanner::fewest(std::uint32_t i, const SpeedInterval& from, std::int64_t end) {
  Stage& stage = stages_[i];
  if (stage.has_pulses()) {
    const std::int32_t beats =
        fewest_pulse_beats(stage.line, from, end, min_beats(i), max_beats_, stage.hint);
    if (beats != 0) stage.hint = beats;
    return beats;
  }
  return fewest_beats(stage.way(), from, end, min_beats(i), max_beats_);
}

/// Fewest beats from speeds at the start of line i to its end; 0 = it cannot be reached.
std::int32_t PathPlanner::first_beats(std::uint32_t i, const SpeedInterval& from) {
  const Stage& stage = stages_[i];
  const std::int32_t fixed = fixed_beats(i);
  SpeedInterval to;
  for (int split = 0; fixed != 0 && split < stage.splits(); ++split)
    if (step(i, from, fixed, split, to)) return fixed;
  if (fixed != 0) return 0;
  if (stage.is_at_rest()) return from.lo_q32 == 0 ? min_beats(i) : 0;
  return fewest(i, from, end_asked_q32(i));
}

void PathPlanner::extend(std::uint32_t i, std::uint32_t parent, bool careful) {
  const Label* const before = i == 0 ? nullptr : &stages_[i - 1].beam.labels[parent];
  const SpeedInterval from = before == nullptr ? start_ : start_speeds(i, before->speeds);
  std::int32_t beats = before == nullptr ? first_beats(i, from) : before->next;
  const int most = stages_[i].has_pulses() ? candidates_with_pulses : candidates_per_label;
  for (int tries = 0; beats != 0 && tries < most; ++tries, ++beats) {
    const Extended what = extend(i, parent, from, beats, careful);
    // With more beats the interval only moves down, and here it cannot.
    if (fixed_beats(i) != 0 || what == Extended::to_rest) return;
    // Pulses can have gaps.
    if (what == Extended::no && !stages_[i].has_pulses()) return;
  }
  if (!stages_[i].has_pulses() || beats == 0) return;
  if (const std::int32_t rest = fewest(i, from, 0); rest >= beats)
    extend(i, parent, from, rest, careful);
}

/// Adds the labels of some beats.
PathPlanner::Extended PathPlanner::extend(std::uint32_t i, std::uint32_t parent,
                                          const SpeedInterval& from, std::int32_t beats,
                                          bool careful) {
  Extended what = Extended::no;
  if (beats > max_beats_) return what;
  for (int split = 0; split < stages_[i].splits(); ++split) {
    Label label{};
    if (!step(i, from, beats, split, label.speeds)) continue;
    const std::uint32_t total = i == 0 ? 0 : stages_[i - 1].beam.labels[parent].total;
    label.total = (total + static_cast<std::uint32_t>(beats)) & 0xffffffu;
    label.parent = static_cast<std::uint8_t>(parent);
    label.beats = static_cast<std::uint16_t>(beats) & 0x3fffu;
    label.split = static_cast<std::uint16_t>(split) & 3u;
    keep(i, label, careful);
    if (label.speeds.lo_q32 == 0) what = Extended::to_rest;
    if (what == Extended::no) what = Extended::moving;
  }
  return what;
}

void PathPlanner::keep(std::uint32_t i, Label label, bool careful) {
  Beam& beam = stages_[i].beam;
  for (std::uint32_t k = 0; k < beam.count; ++k)
    if (beam.labels[k].total <= label.total && beam.labels[k].speeds.contains(label.speeds)) return;
  if (i + 1 < request_->count) {
    const std::int32_t next = first_beats(i + 1, start_speeds(i + 1, label.speeds));
    if (next == 0) return;
    label.next = static_cast<std::uint16_t>(next);
  }
  std::uint32_t kept = 0;
  for (std::uint32_t k = 0; k < beam.count; ++k) {
    const Label other = beam.labels[k];
    if (label.total <= other.total && label.speeds.contains(other.speeds)) continue;
    beam.labels[kept++] = other;
  }
  beam.count = kept;
  if (kept < path_labels) {
    beam.labels[beam.count++] = label;
    return;
  }
  // Full: the worst label is replaced, but never the quickest of those that can rest, independent
  // of the next line.
  const auto better = [careful](const Label& a, const Label& b) {
    if (careful && a.speeds.lo_q32 != b.speeds.lo_q32) return a.speeds.lo_q32 < b.speeds.lo_q32;
    const std::uint32_t ra = a.total + a.next, rb = b.total + b.next;
    return ra != rb ? ra < rb : a.speeds.hi_q32 > b.speeds.hi_q32;
  };
  const Label* rest = label.speeds.lo_q32 == 0 ? &label : nullptr;
  for (const Label& other : beam.labels)
    if (other.speeds.lo_q32 == 0 && (rest == nullptr || other.total < rest->total)) rest = &other;
  Label* worst = rest == &label ? nullptr : &label;
  for (Label& other : beam.labels)
    if (&other != rest && (worst == nullptr || better(*worst, other))) worst = &other;
  if (worst != &label) *worst = label;
}

}  // namespace lamplock::motion
