#include "firmware/program/rotary.hpp"

#include <bit>

#include "firmware/program/curves/curve_timing.hpp"
#include "firmware/program/statement.hpp"
#include "shared/fixed_point.hpp"
#include "shared/work_space.hpp"

namespace lamplock::program {

std::uint32_t feed_of_all_axes(std::uint32_t feed_um_min, const Place& from, const Place& to,
                               bool inches) {
  constexpr std::uint32_t highest_feed = 0xffffffff;
  Place linear_end = to;
  linear_end[rotary_axis] = from[rotary_axis];
  const auto linear = static_cast<std::uint64_t>(distance_e7(from, linear_end));
  if (linear == 0) {
    if (!inches) return feed_um_min;
    const auto degrees = static_cast<std::uint32_t>((wide_product(feed_um_min, 5) + 63) / 127);
    return degrees == 0 ? 1 : degrees;
  }
  const auto all = static_cast<std::uint64_t>(distance_e7(from, to));
  const int bits = 64 - std::countl_zero(all);
  const int shift = bits > 31 ? bits - 31 : 0;
  const auto divisor = static_cast<std::uint32_t>(linear >> shift);
  if (divisor == 0) return highest_feed;
  const std::uint64_t feed =
      wide_product(feed_um_min, static_cast<std::uint32_t>(all >> shift)) / divisor;
  return feed > highest_feed ? highest_feed : static_cast<std::uint32_t>(feed);
}

std::int64_t shortest_way_e7(std::int64_t from_e7, std::int64_t to_e7) {
  constexpr std::int64_t turn_e7 = 360 * one_e7;
  std::int64_t way_e7 = (to_e7 - from_e7) % turn_e7;
  if (way_e7 > turn_e7 / 2) way_e7 -= turn_e7;
  if (way_e7 <= -turn_e7 / 2) way_e7 += turn_e7;
  return from_e7 + way_e7;
}

/// The value of an axis word in G20.
std::int64_t Statement::inch_axis_e7(int axis) const {
  return length_e7(block_.axis(axis), (options_.rotary >> axis & 1u) == 0);
}

/// G28, G30: the stored place of an axis, for A the nearest one.
std::int64_t Statement::home_of_axis(int axis, const Place& from, const Place& home) const {
  const std::size_t i = index(axis);
  const bool turns = options_.shortest_way && i == rotary_axis;
  return turns ? shortest_way_e7(from[i], home[i]) : home[i];
}

/// The target of a line with a word of the rotary axis, and the feed of its move.
bool Statement::rotary_target(Place& place, bool in_machine) {
  const Place& start = in_machine ? after_.machine_e7 : after_.programmed_e7;
  std::int64_t& end_e7 = place[rotary_axis];
  const std::int64_t start_e7 = start[rotary_axis];
  if (options_.shortest_way && (in_machine || !after_.modal.relative)) {
    end_e7 = shortest_way_e7(start_e7, end_e7);
    if (!inside(end_e7, max_position_e7, GcodeError::bad_target, block_.axis(rotary_axis).column))
      return false;
  }
  // With G93 and as a rapid a move has no feed, and the feed of a cycle is that of its drill. Moves
  // beside a contour keep the feed along all axes, which is the lower one.
  if (plan_.feed_um_min == 0 || end_e7 == start_e7 || is_cycle(plan_.motion) ||
      after_.modal.cutter != Cutter::off)
    return true;
  if (is_arc(plan_.motion))
    plan_.rotary = true;
  else
    plan_.feed_um_min = feed_of_all_axes(plan_.feed_um_min, start, place, after_.modal.inches);
  return true;
}

}  // namespace lamplock::program
