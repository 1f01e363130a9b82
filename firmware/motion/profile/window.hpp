// The planning problem of a window of points, in normalised units.
//
// In:  displacements from point to point, and the speeds that an axis may have at each point.
// Out: the ways of a window with their guide: at every point the hull of speeds from which the rest
//      of the window can be run.
// Who: the planner (main loop, or the core that plans), once per window.
//
// Units as in scaled_reach.hpp. The work space bounds the speeds at a point in two ways: after the
// point, full braking must stop before the work space ends, v^2 / 2 <= distance left; before the
// point, full acceleration must have produced the speed since the other end, which is the same
// reversed in time. So |v| is at most what the distance to the nearer end allows. Both bounds are
// necessary for any motion inside, and with them a profile inside exists for every way that reach()
// calls possible (profile.hpp, steady profile).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/profile/limits.hpp"
#include "firmware/motion/profile/scaled_reach.hpp"
#include "shared/look_ahead.hpp"
#include "shared/units.hpp"

namespace lamplock::motion {

/// Speeds of all axes at one point.
using Box = PerAxis<SpeedRange>;

/// The way from one point of a window to the next.
struct Leg {
  PerAxis<std::int64_t> displacement_qs{};
  Box allowed{};                 ///< speeds at its end
  std::int32_t first_beats = 1;  ///< minimum at full speed
  std::int32_t last_beats = 1;  ///< from rest to rest and a little more: the maximum tried at first
  std::int32_t fixed_beats = 0;  ///< programmed; 0 = free
};

/// Ways of a window, and where it starts.
struct Window {
  const Limits* limits = nullptr;
  std::uint32_t count = 0;
  std::int32_t max_beats = 1;  ///< so that the ticks of a segment stay in 31 bits
  Box start{};
  std::array<Leg, window_points> ways{};

  int axes() const { return limits->axes; }
  const AxisScale& scale(int a) const { return limits->axis[index(a)].scale; }
};

/// True if a speed of every axis lies in both.
bool overlap(const Box& a, const Box& b, int axes);

/// Speeds at the end of a way, from those at its start; false if there are none.
bool step(const Window& window, const Leg& way, const Box& from, std::int32_t beats, Box& to);

/// The reverse: speeds at the end of way `i` - 1, allowed there, from which those at the end of way
/// `i` can be reached.
bool step_back(const Window& window, std::uint32_t i, const Box& to, std::int32_t beats, Box& from);

/// False if step() from one box certainly misses the other one: without a root or a division.
bool can_join(const Window& window, const Leg& way, const Box& from, const Box& to,
              std::int32_t beats);

/// Fewest beats of a way from rest to rest; 0 if there are more than `most`.
std::int32_t beats_at_rest(const Window& window, const Leg& way, std::int32_t most);

/// Narrows the allowed speeds at every point to those from which the rest of the window can be run
/// in at most `last_beats` a way. Rest stays allowed.
void guide(Window& window);

}  // namespace lamplock::motion
