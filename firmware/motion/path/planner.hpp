// The path planner: straight lines from target to target, one speed along them, whole beats.
//
// In:  a window of targets (up to `window_points`) and the state the machine starts from.
// Out: the beats of every line and segments that end exactly on the targets, the last one at rest.
// Who: the planner (main loop, or the core that plans); no code here runs in an interrupt.
//
// "Abstract of a master's thesis on the flexibility of CNC systems for laser processing" gives the
// task: look ahead backwards for the highest speed at the end of every block, then correct speeds
// so that the time of each block is a whole multiple of the lamp period. Corrected block by block,
// one block in seven has no solution, even on a straight line. Here times and speeds are found
// together:
//
// 1. Backwards: the highest speed at every corner (path/geometry.hpp), from which the rest of the
//    window can still be run in whole beats and stopped at its end.
// 2. Forwards: a label is a number of beats and the interval of speeds the machine can have at the
//    point. Speed along a line without going back is reach.hpp seen from half the speed limit:
//    v -> v - V/2, V -> V/2, d -> d - V t/2. Along one line more beats only move the interval down,
//    so a label is extended from the fewest beats up to the first that can rest. Of all labels of a
//    point those dominated are dropped (no fewer beats, interval inside another), and of the rest
//    `path_labels` kept.
// 3. Backwards: speeds, as near to the mean of both lines as the intervals allow.
//
// Where jerk is limited lines are run in pulses, and pulse_line.hpp replaces reach.hpp: it is
// called once for each way to divide the time. The acceleration is zero at every point.
//
// A segment has the same phases on all axes, with speeds and accelerations in proportion, so the
// machine is on the line at every tick, within rounding to a step. Every axis ends exactly on its
// step: its cruise speed follows from its own distance.
//
// Limits hold at every tick of a segment: along the line by reach.hpp with the least of limit over
// direction, after rounding by a check of every profile. At a corner the speed of an axis jumps, at
// most by the limit of path/geometry.hpp. Between two ends of a line the machine never goes back,
// so it stays inside the work space; a brake from any state stays inside as well, because a corner
// from which an axis could not stop inside is made a full stop.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/path/geometry.hpp"
#include "firmware/motion/path/pulse_line.hpp"
#include "firmware/motion/path/reach.hpp"
#include "firmware/motion/plan_request.hpp"

namespace lamplock::motion {

/// Labels kept per point.
inline constexpr std::size_t path_labels = 4;

/// Plans windows. Holds only scratch memory; a plan depends on the request alone.
class PathPlanner {
 public:
  /// Begins a window; the request must not change while segments are read.
  void begin(const PlanRequest& request);
  /// Plans a part, point by point; false when there is nothing left to do. Budget: the first slice
  /// sets the whole window up, some 7 ms with three axes; the others 3 ms, where jerk is limited 14
  /// ms.
  bool advance();
  /// The result. Error: unreachable, with the index in the window in failed(); then no part of the
  /// plan may be used.
  Result result() const { return result_; }
  std::uint32_t failed() const { return failed_; }
  /// Plans the whole window at once.
  Result plan(const PlanRequest& request, std::uint32_t& failed);

  /// The segment to points[i], made again at every call.
  Segment segment(std::uint32_t i) const;
  std::int32_t beats(std::uint32_t i) const { return stages_[i].chosen.beats; }

 private:
  struct Label {
    SpeedInterval speeds;      ///< at the point, in units of the line before it
    std::uint32_t total : 24;  ///< beats from the start of the window
    std::uint32_t parent : 8;
    std::uint16_t beats : 14;  ///< of the last line
    std::uint16_t split : 2;   ///< how its time is divided (pulse_line.hpp)
    std::uint16_t next;        ///< minimum beats of the next line
  };
  struct Beam {
    std::array<Label, path_labels> labels;
    std::uint32_t count;
  };
  struct Chosen {
    SpeedInterval speeds;           ///< of the label
    std::int64_t speed_q32;         ///< at the point, in units of the line before it
    PerAxis<std::int64_t> off_q64;  ///< exact position there, from the middle of the step
    std::uint32_t total;
    std::int32_t beats;
    int split;
  };
  /// A line and the point at its end.
  struct Stage {
    /// Displacement (0 = none) and limit; the other members only where jerk is limited.
    PulseLine line;
    std::int64_t corner_q32 = 0;  ///< limit at the point, normalised
    std::int64_t end_q32 = 0;     ///< the same after look-ahead
    std::int32_t hint = 1;        ///< fewest beats in the last search
    Real from_previous;           ///< factor for speeds at the start of the line

    bool is_at_rest() const { return line.displacement_q32 == 0; }
    bool has_pulses() const { return line.rise_q32 != 0; }
    int splits() const { return has_pulses() ? pulse_splits : 1; }
    PathWay way() const { return {line.displacement_q32, line.speed_q32}; }
    union {
      Beam beam;      ///< while beats are searched
      Chosen chosen;  ///< afterwards
    };
    constexpr Stage() : beam{} {}
  };

  enum class Phase : std::uint8_t { set_up, ahead, search, check, over };
  /// What a number of beats makes possible.
  enum class Extended : std::uint8_t { no, moving, to_rest };

  Result set_up(std::uint32_t& failed);
  PathLine line(std::uint32_t i) const;
  bool set_start(const PathLine& first);
  void start_over();
  void look_ahead();
  std::int64_t start_bound_q32(std::uint32_t i);
  std::int64_t max_start_q32(std::uint32_t i, const SpeedInterval& end);
  std::int64_t max_start_q32(std::uint32_t i, const SpeedInterval& end, std::int32_t beats) const;
  void search();
  bool extend(std::uint32_t i, bool careful);
  void extend(std::uint32_t i, std::uint32_t parent, bool careful);
  Extended extend(std::uint32_t i, std::uint32_t parent, const SpeedInterval& from,
                  std::int32_t beats, bool careful);
  bool step(std::uint32_t i, const SpeedInterval& from, std::int32_t beats, int split,
            SpeedInterval& to) const;
  bool step_back(std::uint32_t i, const SpeedInterval& end, std::int32_t beats, int split,
                 SpeedInterval& start) const;
  std::int32_t fewest(std::uint32_t i, const SpeedInterval& from, std::int64_t end_q32);
  void keep(std::uint32_t i, Label label, bool careful);
  std::int64_t end_asked_q32(std::uint32_t i) const;
  std::int32_t first_beats(std::uint32_t i, const SpeedInterval& from);
  void choose_beats();
  void choose_speeds();
  void choose_speed(std::uint32_t i);
  std::int64_t wanted_speed_q32(std::uint32_t i) const;
  void check();
  void stop_at(std::uint32_t i, bool inside);
  bool inside(const Segment& s, const MotionState& from) const;
  bool can_stop(const Segment& s) const;
  Segment make_segment(std::uint32_t i, const MotionState& from) const;
  AxisProfile phases(std::uint32_t i, Int128 way_q62, std::int64_t v0_q62, std::int64_t v1_q62,
                     std::int64_t speed_q62) const;
  MotionState state_before(std::uint32_t i) const;
  std::uint32_t shot_window_ticks(std::uint32_t i, const PerAxis<std::int64_t>& speeds_q62) const;

  const wire::Target& target(std::uint32_t i) const {
    return request_->queue->at(request_->points[i]);
  }
  std::int32_t fixed_beats(std::uint32_t i) const;
  std::int32_t min_beats(std::uint32_t i) const;
  bool beats_allowed(std::uint32_t i) const;
  std::int64_t start_speed_q32(std::uint32_t i) const;
  SpeedInterval start_speeds(std::uint32_t i, const SpeedInterval& end_of_previous) const;

  const PlanRequest* request_ = nullptr;
  const Limits* limits_ = nullptr;
  Result result_ = Result::unreachable;
  Phase phase_ = Phase::over;
  bool careful_ = false;      ///< second attempt: labels that can rest come first
  std::uint32_t at_ = 0;      ///< next point in this phase
  std::uint32_t failed_ = 0;  ///< index that cannot be reached
  std::int32_t max_beats_ = 1;
  bool jerk_limited_ = false;   ///< on any axis
  SpeedInterval start_;         ///< at the start of the window, in units of the first line
  std::int64_t start_q32_ = 0;  ///< the speed at the start
  std::array<Stage, window_points> stages_{};
};

}  // namespace lamplock::motion
