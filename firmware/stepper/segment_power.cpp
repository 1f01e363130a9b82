#include "firmware/stepper/segment_power.hpp"

namespace lamplock::stepper {
namespace {

constexpr int none = -1;

/// The first axis that moves, or none.
int moving_axis(const Segment& segment) {
  for (int a = 0; a < max_axes; ++a)
    if (!segment.axis[index(a)].is_at_rest()) return a;
  return none;
}

/// Slope from one power to another over `ticks`, rounded towards zero.
std::uint32_t slope_q16(std::uint32_t from, std::uint32_t to, std::uint32_t ticks) {
  if (ticks == 0) return 0;
  return to < from ? 0 - ((from - to) << 16) / ticks : ((to - from) << 16) / ticks;
}

}  // namespace

Segment rest_with_light(const MotionState& at, std::uint32_t ticks, std::uint16_t power) {
  Segment segment;
  segment.ticks = ticks;
  for (AxisProfile& axis : segment.axis) axis.cruise_ticks = ticks;
  segment.end = at;
  segment.shines = true;
  segment.beam_kind = BeamKind::at_rest;
  segment.power = {power, power, 0, 0};
  return segment;
}

bool may_shine(const Segment& segment) {
  return moving_axis(segment) != none || (segment.shines && segment.beam_kind == BeamKind::at_rest);
}

int power_axis(const Segment& segment) {
  if (!segment.shines) return none;
  if (segment.beam_kind == BeamKind::at_rest) return 0;  // all axes have the same phase
  return segment.beam_kind == BeamKind::even ? moving_axis(segment) : int{segment.beam_axis};
}

PowerStretch power_from(const SegmentPower& power, const AxisProfile& phases, std::uint32_t at) {
  const std::uint32_t cruise_q16 = std::uint32_t{power.cruise} << 16, lead = phases.lead_ticks;
  if (at < lead)
    return {(std::uint32_t{power.start} << 16) + power.lead_slope_q16 * at, power.lead_slope_q16,
            lead - at};
  at -= lead;
  if (at < phases.cruise_ticks) return {cruise_q16, 0, phases.cruise_ticks - at};
  at -= phases.cruise_ticks;
  return {cruise_q16 + power.tail_slope_q16 * at, power.tail_slope_q16, phases.tail_ticks - at};
}

void set_power(Segment& segment, const PowerPoints& power) {
  const int axis = moving_axis(segment);
  if (axis == none || (power.start | power.cruise | power.end) == 0) return;
  const AxisProfile& phases = segment.axis[index(axis)];
  segment.shines = true;
  segment.beam_kind = BeamKind::even;
  segment.power = {power.start, power.cruise,
                   slope_q16(power.start, power.cruise, phases.lead_ticks),
                   slope_q16(power.cruise, power.end, phases.tail_ticks)};
}

}  // namespace lamplock::stepper
