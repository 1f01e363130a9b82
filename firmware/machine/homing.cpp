#include "firmware/machine/homing.hpp"

#include <bit>

#include "shared/work_space.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

// How far an axis goes to find its switch, as in grbl 1.1: of the longest travel in halves, of the
// pull-off.
constexpr std::int64_t seek_halves = 3, locate_pull_offs = 5;
/// Speed along the path over that of each axis, where so many go equally fast: sqrt(n), in 2^-16.
constexpr std::array<std::uint32_t, max_axes + 1> roots_q16{0, 65536, 92682, 113512, 131072};

constexpr AxisSet bit(int axis) { return static_cast<AxisSet>(1u << axis); }
constexpr AxisSet lowest(AxisSet axes) { return static_cast<AxisSet>(axes & (~axes + 1u)); }
constexpr AxisSet without(AxisSet axes, AxisSet gone) {
  return static_cast<AxisSet>(axes & ~unsigned{gone});
}

}  // namespace

bool Homing::begin(const settings::Values& values, InputSet inputs, AxisSet wanted) {
  chain_ = (inputs & set_of(Input::limit_chain)) != 0;
  const auto there = static_cast<AxisSet>((1u << values.whole(Id::axes)) - 1);
  const auto axes = static_cast<AxisSet>(wanted & there & engaged_axes(inputs));
  AxisSet any = 0;
  for (int i = 0; i < phases; ++i) {
    const auto mask = static_cast<unsigned>(values.milli(Id::homing_phase_1, i) / 1000);
    phase_masks_[index(i)] = without(static_cast<AxisSet>(mask & axes), any);  // each once
    any = static_cast<AxisSet>(any | phase_masks_[index(i)]);
  }
  if (std::has_single_bit(unsigned{wanted})) {
    phase_masks_ = {axes};
    any = axes;
  }
  downwards_ = static_cast<AxisSet>(values.whole(Id::homing_direction));
  seek_um_min_ = static_cast<std::uint32_t>(values.milli(Id::homing_seek));
  locate_um_min_ = static_cast<std::uint32_t>(values.milli(Id::homing_feed));
  wait_ms_ = static_cast<std::uint32_t>(values.whole(Id::homing_debounce));
  pull_off_milli_mm_ = values.milli(Id::homing_pull_off);
  passes_ = values.whole(Id::homing_passes);
  for (int a = 0; a < max_axes; ++a) {
    steps_per_mm_milli_[index(a)] = values.milli(Id::steps_per_mm_x, a);
    low_milli_mm_[index(a)] = values.milli(Id::min_corner_x, a);
    high_milli_mm_[index(a)] = low_milli_mm_[index(a)] + values.milli(Id::travel_x, a);
  }
  phase_ = -1;
  left_ = 0;
  stage_ = Stage::phase;
  active_ = any != 0;
  return active_;
}

std::int32_t Homing::steps(std::int64_t milli_mm, int axis) const {
  return steps_from_milli(milli_mm, steps_per_mm_milli_[index(axis)]);
}

std::uint32_t Homing::path_feed(std::uint32_t axis_feed_um_min, AxisSet axes) const {
  const std::uint64_t product =
      std::uint64_t{axis_feed_um_min} * roots_q16[static_cast<std::size_t>(std::popcount(axes))];
  return static_cast<std::uint32_t>(product >> 16);
}

bool Homing::next_phase() {
  while (left_ == 0) {
    if (++phase_ == phases) return false;
    left_ = phase_masks_[index(phase_)];
  }
  phase_axes_ = chain_ ? lowest(left_) : left_;
  left_ = without(left_, phase_axes_);
  longest_travel_milli_mm_ = 0;
  for (int a = 0; a < max_axes; ++a) {
    const std::int32_t travel = high_milli_mm_[index(a)] - low_milli_mm_[index(a)];
    if (in_phase(a) && travel > longest_travel_milli_mm_) longest_travel_milli_mm_ = travel;
  }
  pass_ = 0;
  placed_ = 0;
  return true;
}

Homing::Next Homing::next(const Rest& rest) {
  switch (stage_) {
    case Stage::phase:
      if (!next_phase()) return Next::done;
      found_ = static_cast<AxisSet>(engaged_axes(rest.active) & phase_axes_);
      return approach(rest);
    case Stage::approached:
      return approached(rest);
    case Stage::pulled_off:
      stage_ = Stage::check;
      return Next::wait;
    default:
      return check(rest);
  }
}

/// Those that have not found their switch yet go on.
Homing::Next Homing::approach(const Rest& rest) {
  const AxisSet going = without(phase_axes_, found_);
  if (going == 0) return pull_off(rest);
  const bool seeks = pass_ == 0;
  const std::int64_t way_milli_mm = seeks ? std::int64_t{longest_travel_milli_mm_} * seek_halves / 2
                                          : std::int64_t{pull_off_milli_mm_} * locate_pull_offs;
  move_.target = rest.at;
  move_.watch = chain_ ? set_of(Input::limit_chain) : InputSet{0};
  for (int a = 0; a < max_axes; ++a) {
    if ((going & bit(a)) == 0) continue;
    const std::int32_t way = steps(way_milli_mm, a);
    move_.target[index(a)] += downwards(a) ? -way : way;
    if (!chain_) move_.watch = static_cast<InputSet>(move_.watch | set_of(limit_of(a)));
  }
  move_.feed_um_min = path_feed(seeks ? seek_um_min_ : locate_um_min_, going);
  stage_ = Stage::approached;
  return Next::move;
}

Homing::Next Homing::approached(const Rest& rest) {
  const auto met =
      static_cast<AxisSet>(engaged_axes(rest.guard.met()) & without(phase_axes_, found_));
  if (met == 0) return Next::switch_not_found;
  for (int a = 0; a < max_axes; ++a)
    if ((met & bit(a)) != 0) places_[index(a)] = rest.guard.limits_at()[index(a)];
  placed_ = static_cast<AxisSet>(placed_ | met);
  found_ = static_cast<AxisSet>(found_ | met);
  return approach(rest);
}

Homing::Next Homing::pull_off(const Rest& rest) {
  move_.target = rest.at;
  move_.watch = 0;
  for (int a = 0; a < max_axes; ++a) {
    if (!in_phase(a)) continue;
    const std::int32_t from = (placed_ & bit(a)) != 0 ? places_[index(a)] : rest.at[index(a)];
    const std::int32_t way = steps(pull_off_milli_mm_, a);
    move_.target[index(a)] = from + (downwards(a) ? way : -way);
  }
  move_.feed_um_min = path_feed(seek_um_min_, phase_axes_);
  stage_ = Stage::pulled_off;
  return Next::move;
}

Homing::Next Homing::check(const Rest& rest) {
  if ((engaged_axes(rest.active) & phase_axes_) != 0) return Next::still_engaged;
  if (pass_ == passes_) {
    find_place(rest.at);
    stage_ = Stage::phase;
    return Next::set_position;
  }
  ++pass_;
  found_ = 0;
  return approach(rest);
}

/// The axes of the phase stand so far inside of the ends of the work space.
void Homing::find_place(const StepPosition& at) {
  position_ = at;
  for (int a = 0; a < max_axes; ++a) {
    if (!in_phase(a)) continue;
    position_[index(a)] =
        downwards(a) ? steps(std::int64_t{low_milli_mm_[index(a)]} + pull_off_milli_mm_, a)
                     : steps(std::int64_t{high_milli_mm_[index(a)]} - pull_off_milli_mm_, a);
  }
}

}  // namespace lamplock::machine
