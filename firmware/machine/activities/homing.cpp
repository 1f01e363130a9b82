#include "firmware/machine/activities/homing.hpp"

#include <bit>

#include "shared/work_space.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

// How far an axis moves to find its switch, as in grbl 1.1: half units of the longest travel, and
// units of the pull-off.
constexpr std::int64_t seek_halves = 3, locate_pull_offs = 5;
// How far one side of a gantry moves alone: DUAL_AXIS_HOMING_FAIL_... of grbl 1.1.
constexpr std::int32_t travels_per_bend = 20;
constexpr std::int32_t min_bend_milli_mm = 2'500, max_bend_milli_mm = 25'000;
/// A contact has released when it has been quiet for 20 ms (boards/rp2040/safety/inputs.hpp).
constexpr std::uint32_t min_wait_ms = 25;
constexpr std::uint32_t clocks_per_ms = 1000 * clocks_per_us;
static_assert(settings::range(Id::homing_debounce).max_milli / 1000 <=
              static_cast<int>(0xffffffff / clocks_per_ms));
constexpr int gang_motor = Kinematics::gang_motor;
/// Speed along the path over that of each axis, for n axes of equal speed: sqrt(n), in 2^-16.
constexpr std::array<std::uint32_t, max_axes + 1> roots_q16{0, 65536, 92682, 113512, 131072};

constexpr AxisSet bit(int axis) { return static_cast<AxisSet>(1u << axis); }
constexpr AxisSet lowest(AxisSet axes) { return static_cast<AxisSet>(axes & (~axes + 1u)); }
constexpr AxisSet without(AxisSet axes, AxisSet gone) {
  return static_cast<AxisSet>(axes & ~unsigned{gone});
}

}  // namespace

bool Homing::begin(const settings::Values& values, InputSet inputs, AxisSet wanted,
                   int ganged_axis) {
  chain_ = (inputs & set_of(Input::limit_chain)) != 0;
  const auto there = static_cast<AxisSet>((1u << values.whole(Id::axes)) - 1);
  const auto axes = static_cast<AxisSet>(wanted & there & engaged_axes(inputs));
  AxisSet any = 0;
  for (int i = 0; i < phases; ++i) {
    const auto mask = static_cast<unsigned>(values.milli(Id::homing_phase_1, i) / 1000);
    phase_masks_[index(i)] = without(static_cast<AxisSet>(mask & axes), any);  // each axis once
    any = static_cast<AxisSet>(any | phase_masks_[index(i)]);
  }
  of_machine_ = !std::has_single_bit(unsigned{wanted});
  if (!of_machine_) {
    phase_masks_ = {axes};
    any = axes;
  }
  downwards_ = static_cast<AxisSet>(values.whole(Id::homing_direction));
  seek_um_min_ = static_cast<std::uint32_t>(values.milli(Id::homing_seek));
  locate_um_min_ = static_cast<std::uint32_t>(values.milli(Id::homing_feed));
  const auto wait_ms = static_cast<std::uint32_t>(values.whole(Id::homing_debounce));
  wait_clocks_ = (wait_ms < min_wait_ms ? min_wait_ms : wait_ms) * clocks_per_ms;
  pull_off_milli_mm_ = values.milli(Id::homing_pull_off);
  passes_ = values.whole(Id::homing_passes);
  for (int a = 0; a < max_axes; ++a) {
    steps_per_mm_milli_[index(a)] = values.milli(Id::steps_per_mm_x, a);
    low_milli_mm_[index(a)] = values.milli(Id::min_corner_x, a);
    high_milli_mm_[index(a)] = low_milli_mm_[index(a)] + values.milli(Id::travel_x, a);
  }
  squared_axis_ = -1;
  sides_ = 0;
  const bool has_switch = (inputs & set_of(limit_of(gang_motor))) != 0;
  if (ganged_axis >= 0 && has_switch && (any & bit(ganged_axis)) != 0) square(ganged_axis);
  phase_ = -1;
  left_ = 0;
  stage_ = Stage::phase;
  alarm_ = 0;
  wait_end_ = 0;
  active_ = any != 0;
  return active_;
}

/// A is the second side of the gantry: it gets all values of the first.
void Homing::square(int ganged_axis) {
  squared_axis_ = static_cast<std::int8_t>(ganged_axis);
  sides_ = static_cast<AxisSet>(bit(ganged_axis) | bit(gang_motor));
  for (AxisSet& mask : phase_masks_)
    if ((mask & bit(ganged_axis)) != 0) mask = static_cast<AxisSet>(mask | bit(gang_motor));
  downwards_ = without(downwards_, bit(gang_motor));
  if (downwards(ganged_axis)) downwards_ = static_cast<AxisSet>(downwards_ | bit(gang_motor));
  for (PerAxis<std::int32_t>* of : {&steps_per_mm_milli_, &low_milli_mm_, &high_milli_mm_})
    (*of)[gang_motor] = (*of)[index(ganged_axis)];
}

std::int32_t Homing::steps(std::int64_t milli_mm, int axis) const {
  return steps_from_milli(milli_mm, steps_per_mm_milli_[index(axis)]);
}

std::uint32_t Homing::path_feed(std::uint32_t axis_feed_um_min, AxisSet axes) const {
  // Both sides of a gantry count as one axis; the first one without the second bends it.
  if ((axes & sides_ & ~unsigned{bit(gang_motor)}) != 0)
    axes = static_cast<AxisSet>(axes ^ bit(gang_motor));
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
  max_travel_milli_mm_ = 0;
  for (int a = 0; a < max_axes; ++a) {
    const std::int32_t travel = high_milli_mm_[index(a)] - low_milli_mm_[index(a)];
    if (in_phase(a) && travel > max_travel_milli_mm_) max_travel_milli_mm_ = travel;
  }
  pass_ = 0;
  placed_ = 0;
  return true;
}

Homing::Next Homing::next(const Rest& rest) {
  if (squared_axis_ < 0) return next_of_sides(rest);
  Rest sides = rest;
  sides.at[gang_motor] += sides.at[index(squared_axis_)];
  const Next next = next_of_sides(sides);
  if (next == Next::move) move_.target[gang_motor] -= move_.target[index(squared_axis_)];
  if (next == Next::set_position) position_[gang_motor] -= position_[index(squared_axis_)];
  return next;
}

Homing::Next Homing::next_of_sides(const Rest& rest) {
  switch (stage_) {
    case Stage::phase:
      if (!next_phase()) return Next::done;
      return begin_phase(rest);
    case Stage::approached:
      return approached(rest);
    case Stage::pulled_off:
      stage_ = Stage::check;
      return Next::wait;
    default:
      return check(rest);
  }
}

Homing::Next Homing::begin_phase(const Rest& rest) {
  found_ = static_cast<AxisSet>(engaged_axes(rest.active) & phase_axes_);
  if (!side_left()) return approach(rest);
  pass_ = -1;
  return pull_off(rest, static_cast<AxisSet>(phase_axes_ & sides_));
}

/// Distance of an approach.
std::int64_t Homing::way_milli_mm() const {
  const std::int64_t way = pass_ != 0 ? std::int64_t{pull_off_milli_mm_} * locate_pull_offs
                                      : std::int64_t{max_travel_milli_mm_} * seek_halves / 2;
  if (!side_left()) return way;
  const std::int32_t travel = high_milli_mm_[gang_motor] - low_milli_mm_[gang_motor];
  const std::int32_t bend = travel / travels_per_bend;
  const std::int32_t most = bend < min_bend_milli_mm   ? min_bend_milli_mm
                            : bend > max_bend_milli_mm ? max_bend_milli_mm
                                                       : bend;
  return way < most ? way : most;
}

/// Axes that have not found their switch move on; one side of a gantry alone.
Homing::Next Homing::approach(const Rest& rest) {
  AxisSet going = without(phase_axes_, found_);
  if (going == 0) return pull_off(rest, phase_axes_);
  if (side_left()) going = static_cast<AxisSet>(going & sides_);
  move_.target = rest.at;
  move_.watch = chain_ ? set_of(Input::limit_chain) : InputSet{0};
  for (int a = 0; a < max_axes; ++a) {
    if ((going & bit(a)) == 0) continue;
    const std::int32_t way = steps(way_milli_mm(), a);
    move_.target[index(a)] += downwards(a) ? -way : way;
    if (!chain_) move_.watch = static_cast<InputSet>(move_.watch | set_of(limit_of(a)));
  }
  move_.feed_um_min = path_feed(pass_ == 0 ? seek_um_min_ : locate_um_min_, going);
  stage_ = Stage::approached;
  return Next::move;
}

Homing::Next Homing::approached(const Rest& rest) {
  const auto met =
      static_cast<AxisSet>(engaged_axes(rest.guard.met()) & without(phase_axes_, found_));
  if (met == 0) return side_left() ? Next::gantry_not_squared : Next::switch_not_found;
  for (int a = 0; a < max_axes; ++a)
    if ((met & bit(a)) != 0) places_[index(a)] = rest.guard.limits_at()[index(a)];
  placed_ = static_cast<AxisSet>(placed_ | met);
  found_ = static_cast<AxisSet>(found_ | met);
  return approach(rest);
}

/// Moves these axes of the phase away from their switches.
Homing::Next Homing::pull_off(const Rest& rest, AxisSet axes) {
  move_.target = rest.at;
  move_.watch = 0;
  for (int a = 0; a < max_axes; ++a) {
    if ((axes & bit(a)) == 0) continue;
    const std::int32_t from = (placed_ & bit(a)) != 0 ? places_[index(a)] : rest.at[index(a)];
    const std::int32_t way = steps(pull_off_milli_mm_, a);
    move_.target[index(a)] = from + (downwards(a) ? way : -way);
  }
  move_.feed_um_min = path_feed(seek_um_min_, axes);
  stage_ = Stage::pulled_off;
  return Next::move;
}

Homing::Next Homing::check(const Rest& rest) {
  const auto engaged = static_cast<AxisSet>(engaged_axes(rest.active) & phase_axes_);
  if ((engaged & (pass_ < 0 ? sides_ : phase_axes_)) != 0) return Next::still_engaged;
  if (pass_ == passes_) {
    find_place(rest.at);
    stage_ = Stage::phase;
    return Next::set_position;
  }
  ++pass_;
  found_ = engaged;
  return approach(rest);
}

/// Position: the axes of the phase are this far inside the ends of the work space.
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
