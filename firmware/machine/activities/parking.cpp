#include "firmware/machine/activities/parking.hpp"

#include "firmware/motion/profile/profile.hpp"
#include "firmware/motion/profile/pulse.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {
namespace {

using settings::Id;

constexpr int lift_axis = 2;
/// A move ends within a millionth of a step of its target (motion/profile/profile.hpp): closer than
/// this is there.
constexpr Int128 there_q64{std::int64_t{1} << 50};

/// Steps per tick of a feed rate in um/min, limited to the maximum rate of the axis.
std::int64_t speed_of(Id feed, const settings::Values& values) {
  const std::int64_t most = values.milli(Id::max_rate_z);
  const std::int64_t um_min = values.milli(feed) < most ? values.milli(feed) : most;
  const Int128 micro_steps_min = Int128::product(um_min, values.milli(Id::steps_per_mm_z));
  // Below a step per tick, which the limits of the settings guarantee.
  return (micro_steps_min << 62).divided_by(60 * ticks_per_second).divided_by(1'000'000).to_int64();
}

}  // namespace

void Parking::begin(const settings::Values& values) {
  const bool wanted = values.whole(Id::parking) != 0 && values.whole(Id::axes) > lift_axis;
  stage_ = wanted ? Stage::stopping : Stage::off;
  called_back_ = false;
  const std::int32_t steps_per_mm = values.milli(Id::steps_per_mm_z);
  pull_out_steps_ = steps_from_milli(values.milli(Id::parking_pull_out), steps_per_mm);
  const std::int32_t target = steps_from_milli(values.milli(Id::parking_target), steps_per_mm);
  const std::int32_t highest = work_space(values).max[lift_axis];
  target_q64_ = stepper::middle_of_step(target < highest ? target : highest);
  slow_q62_ = speed_of(Id::parking_slow, values);
  fast_q62_ = speed_of(Id::parking_fast, values);
}

bool Parking::next(const stepper::MotionState& at, const motion::BrakeLimits& limits,
                   stepper::Segment& move) {
  const Int128 z = at.axis[lift_axis].position_q64;
  switch (stage_) {
    case Stage::stopping:
      place_q64_ = z;
      up_q64_ = z + (Int128{std::int64_t{pull_out_steps_}} << 64);
      if (up_q64_ > target_q64_) up_q64_ = target_q64_ > z ? target_q64_ : z;
      stage_ = Stage::pulling_out;
      if (go(at, up_q64_, slow_q62_, limits, move)) return true;
      [[fallthrough]];
    case Stage::pulling_out:
      stage_ = Stage::leaving;
      if (target_q64_ > z && go(at, target_q64_, fast_q62_, limits, move)) return true;
      [[fallthrough]];
    case Stage::leaving:
      stage_ = Stage::parked;
      return false;
    case Stage::parked:
    case Stage::returning:
    case Stage::lowering:
      return come_back(at, limits, move);
    case Stage::off:
      break;
  }
  return false;
}

/// Starts from any position: the previous move may have been interrupted.
bool Parking::come_back(const stepper::MotionState& at, const motion::BrakeLimits& limits,
                        stepper::Segment& move) {
  if (!called_back_) {
    if (stage_ != Stage::parked) stage_ = Stage::pulling_out;
    return false;
  }
  if (at.axis[lift_axis].position_q64 > up_q64_ && go(at, up_q64_, fast_q62_, limits, move)) {
    stage_ = Stage::returning;
    return true;
  }
  stage_ = Stage::lowering;
  if (go(at, place_q64_, slow_q62_, limits, move)) return true;
  end();
  return false;
}

/// Makes a move from rest to rest; false if the axis is there already.
bool Parking::go(const stepper::MotionState& at, Int128 to_q64, std::int64_t speed_q62,
                 const motion::BrakeLimits& limits, stepper::Segment& move) const {
  const Int128 way_q64 = to_q64 - at.axis[lift_axis].position_q64;
  if (way_q64 > -there_q64 && way_q64 < there_q64) return false;
  // A distance of 2^27 steps fits into 32 bits before the point.
  const std::int64_t size_q32 = ((way_q64 < Int128{} ? -way_q64 : way_q64) >> 32).to_int64();
  const std::int64_t speed_q32 = (speed_q62 >> 30) + 1;
  const motion::AxisBrake& axis_limits = limits.axis[lift_axis];
  motion::AxisProfile profile;
  std::uint32_t ramp = motion::braking_ticks(speed_q62, axis_limits.accel_q62) + 1;
  for (;; ramp += ramp / 4 + 1) {
    // Both ramps together cover as much distance as one of them at full speed.
    const std::int64_t left_q32 = size_q32 - speed_q32 * ramp;
    const auto cruise =
        left_q32 > 0 ? static_cast<std::uint32_t>(left_q32 / speed_q32) + 1 : std::uint32_t{0};
    profile = motion::make_phases(way_q64 >> 2, 0, 0, ramp, cruise, ramp);
    if (axis_limits.jerk_q78 == 0 || motion::make_pulses(profile, 0, axis_limits.jerk_q78)) break;
  }
  move = {};
  move.ticks = profile.ticks();
  move.axis[lift_axis] = profile;
  move.end = at;
  move.end.axis[lift_axis].position_q64 =
      at.axis[lift_axis].position_q64 + (stepper::displacement_q62(profile) << 2);
  return true;
}

}  // namespace lamplock::machine
