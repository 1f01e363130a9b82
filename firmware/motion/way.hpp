// The problem that a window of points is to the planner, in normalised units.
//
// In:  displacements from point to point, and at each point which speeds an axis may have there.
// Out: the ways of a window with their guide: at every point the hull of speeds from which the rest
//      of the window can be done.
// Called by the planner (main loop, or the core that plans), once per window.
//
// Units as in scaled_reach.hpp. The work space bounds the speeds at a point in two ways: ahead,
// full braking must take the speed away before it ends, v^2 / 2 <= way left; behind, full
// acceleration must have made it since, which is the same seen backwards in time. So |v| is no more
// than what the way to the nearer end allows. Both bounds are necessary for any motion inside, and
// with them a profile inside exists for every way that reach() calls possible (profile.hpp, steady
// profile).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/scaled_reach.hpp"
#include "shared/units.hpp"

namespace lamplock::motion {

/// Points planned at once.
inline constexpr std::uint32_t window_points = 36;

/// Speeds of all axes at one point.
using Box = PerAxis<SpeedRange>;

/// The way from one point of a window to the next.
struct Way {
  PerAxis<std::int64_t> displacement_qs{};
  Box allowed{};                 ///< speeds at its end
  std::int32_t first_beats = 1;  ///< no fewer at full speed
  std::int32_t last_beats = 1;  ///< from rest to rest and a little more: no more are tried at first
  std::int32_t fixed_beats = 0;  ///< ordered; 0 = free
};

/// Ways of a window, and where it starts.
struct Window {
  const Limits* limits = nullptr;
  std::uint32_t count = 0;
  std::int32_t most_beats = 1;  ///< so that the ticks of a segment stay in 31 bits
  Box start{};
  std::array<Way, window_points> ways{};

  int axes() const { return limits->axes; }
  const AxisScale& scale(int a) const { return limits->axis[index(a)].scale; }
};

/// True if a speed of every axis lies in both.
bool overlap(const Box& a, const Box& b, int axes);

/// Speeds at the end of a way, from those at its start; false if there are none.
bool step(const Window& window, const Way& way, const Box& from, std::int32_t beats, Box& to);

/// The same the other way round: speeds at the end of way `i` - 1, allowed there, from which those
/// at the end of way `i` can be had.
bool step_back(const Window& window, std::uint32_t i, const Box& to, std::int32_t beats, Box& from);

/// False if step() from one box is sure to miss the other one: without a root or a division.
bool can_join(const Window& window, const Way& way, const Box& from, const Box& to,
              std::int32_t beats);

/// Fewest beats of a way from rest to rest; 0 if there are more than `most`.
std::int32_t beats_at_rest(const Window& window, const Way& way, std::int32_t most);

/// Narrows what is allowed at every point to speeds from which the rest of the window can be done
/// in no more than `last_beats` a way. Rest stays allowed.
void guide(Window& window);

}  // namespace lamplock::motion
