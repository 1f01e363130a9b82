// The speeds that can be reached at the end of a line that is run without going back.
//
// In:  an interval of speeds at the start, the line, a time in whole beats.
// Out: the interval of speeds at the end; or the fewest beats for which it is not empty.
// Who: the path planner (main loop, or the core that plans), some times per point. Units as in
//      reach.hpp.
//
// Along a line 0 <= v <= V. In a frame that moves at V/2 that is |v| <= V/2, the case of reach().
// The times for which some speed of one interval can be joined to some speed of another form one
// interval, so its lower end, rounded up to a whole beat, is the answer, or there is none.
#pragma once

#include <cstdint>

#include "firmware/motion/profile/reach.hpp"

namespace lamplock::motion {

/// A line without its geometry.
struct PathWay {
  std::int64_t displacement_q32 = 0;  ///< normalised, > 0
  std::int64_t speed_q32 = 0;         ///< normalised limit
};

/// Projects `from`, inside 0 and the limit, along the line in `beats`; speeds above `end_q32` are
/// cut off. False if no speed can be reached.
bool path_reach(const PathWay& way, const SpeedInterval& from, std::int32_t beats,
                std::int64_t end_q32, SpeedInterval& to);

/// Fewest beats, `least` to `most`, for which path_reach() finds a speed; 0 = none.
std::int32_t fewest_beats(const PathWay& way, const SpeedInterval& from, std::int64_t end_q32,
                          std::int32_t least, std::int32_t most);

}  // namespace lamplock::motion
