// The planner: how many beats to each point, and at which speed through it.
//
// In:  a window of targets (up to `window_points`) and the state the machine starts from.
// Out: segments of whole beats that end exactly on the targets, for the first `commit_points`
//      targets.
// Who: the plan of a window (window_plan.hpp; main loop, or the core that plans), slice by slice;
//      no code here runs in an interrupt.
//
//   targets -> window (window.hpp) -> beats (beam_search.hpp, beat_reduction.hpp) -> speeds
//   (speed_choice.hpp)
//           -> profiles (profile.hpp), checked against the limits and the work space
//
// start-stop mode is the same search with every speed zero; path mode has a separate planner
// (path/planner.hpp), whose segments are handed out here.
//
// Limits hold by construction: profiles are made for planning limits that leave room for rounding
// and are then checked against the true ones, work space included. Where the quiet profile of an
// axis would leave the work space between two points, the steady one does not: it accelerates fully
// to a steady speed and from there to the end speed, so it exceeds the interval between the points
// only by the braking distance.
//
// Where jerk is limited phases are pulses (pulse.hpp). The search uses constant acceleration only,
// with the mean acceleration of pulses of about half a beat (limits.hpp). A way on which the pulses
// of an axis do not fit, or violate limits after rounding, gets more beats and the window is
// planned again, in the end with rests.
//
// Why a stop is always possible: at every point the speed of every axis is limited so that full
// braking stops it inside the work space, and between the points braking at full acceleration stops
// it within the planned path.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/free/beam_search.hpp"
#include "firmware/motion/free/beat_reduction.hpp"
#include "firmware/motion/free/speed_choice.hpp"
#include "firmware/motion/path/planner.hpp"
#include "firmware/motion/plan_request.hpp"
#include "firmware/motion/profile/limits.hpp"
#include "firmware/motion/profile/window.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// Windows of at most this many points are searched twice if their plan has detours. There is time
/// for that: such a window is the last of a job, or of the known points, so the machine is at rest
/// or runs the `commit_points` points committed before.
inline constexpr std::uint32_t short_window = commit_points / 2;

/// Plans windows. Holds only scratch memory; a plan depends on the request alone.
class Planner {
 public:
  /// Begins a window; the request must not change until the plan has been used.
  void begin(const PlanRequest& request);
  /// Plans a part; false when there is nothing left to do. Budget: 3 ms, mostly less than one; the
  /// set-up of a window (begin(), the first slice of a path) 8 ms.
  bool advance();
  /// The result. Error: unreachable, with the index in the window in failed(); then no part of the
  /// plan may be used.
  Result result() const { return result_; }
  std::uint32_t failed() const { return failed_; }

  /// Plans the whole window at once.
  Result plan(const PlanRequest& request, std::uint32_t& failed);

  /// The segment to points[i], i < request.commits().
  const Segment& segment(std::uint32_t i) const { return segments_[i]; }
  std::int32_t beats(std::uint32_t i) const { return beats_[i]; }

 private:
  enum class Phase : std::uint8_t { search, improve, speeds, segments, path, over };
  /// State of detours: a short window is searched again without them, if there are any.
  enum class Detours : std::uint8_t { unknown, forbidden, accepted };

  /// Additional beats tried after those from rest to rest.
  static constexpr std::int32_t beats_beyond_rest = 2;

  void begin_search(bool run_ups);
  [[gnu::noinline]] bool set_up();
  void try_simpler(std::uint32_t place);
  void keep_speed(std::int32_t beats);
  bool set_up_way(std::uint32_t i);
  SpeedRange allowed_speeds(const AxisLimits& axis, std::int32_t steps) const;
  bool set_beats(Leg& way, std::uint32_t i) const;
  static std::uint32_t about_beats(const Leg& way);
  Effort find_effort() const;
  void search();
  void improve();
  [[gnu::cold]] bool search_again();
  [[gnu::cold]] bool forbid_detours();
  [[gnu::cold]] void restore_first();
  void begin_beam();
  void choose_speeds();
  void make_segments();
  void plan_path();
  std::int64_t end_speed_q62(std::uint32_t i, int a, Int128 way_q62) const;
  bool fit_axis(std::uint32_t i, int a, const MotionState& from);
  [[gnu::cold]] bool fit_pulses(std::uint32_t i, int a, const MotionState& from);
  [[gnu::cold]] void take_longer();
  void make_segment(std::uint32_t i, const MotionState& from);
  Int128 way_q62(std::uint32_t i, int a, const MotionState& from) const;
  void set_profile(std::uint32_t i, int a, const MotionState& from, const AxisProfile& profile);
  void make_steady(std::uint32_t i, int a, const MotionState& from);
  bool axis_inside(std::uint32_t i, int a, const MotionState& from) const;
  void fail(std::uint32_t place);
  std::uint32_t shot_window_ticks(std::uint32_t i) const;
  std::int64_t speed_q32(std::uint32_t i, int a) const {
    return limits_->axis[index(a)].scale.q32(speed_qs_[i][index(a)]);
  }
  std::int64_t start_q32(std::uint32_t i, int a) const {
    return i == 0 ? limits_->axis[index(a)].scale.q32(start_qs_[index(a)]) : speed_q32(i - 1, a);
  }
  const wire::Target& target(std::uint32_t i) const {
    return request_->queue->at(request_->points[i]);
  }

  const PlanRequest* request_ = nullptr;
  const Limits* limits_ = nullptr;
  Phase phase_ = Phase::over;
  Result result_ = Result::unreachable;
  std::uint32_t failed_ = 0;
  bool run_ups_ = false;       ///< some speeds are allowed for run-ups only
  std::uint32_t at_ = 0;       ///< next point or axis
  std::uint32_t misfits_ = 0;  ///< bit i: no profile of the way to points[i] keeps its limits
  std::int32_t longer_ = 0;    ///< how often such ways got more beats
  Detours detours_ = Detours::unknown;
  std::int32_t first_total_ = 0;  ///< beats of the plan with detours
  /// Beats of that plan, before it was improved.
  std::array<std::uint16_t, short_window> found_;
  Window window_;
  Effort effort_;
  PerAxis<std::int32_t> start_qs_{};  ///< speeds at the start, normalised and scaled
  PathPlanner path_;
  Beam beam_;
  Improver improver_;
  std::array<std::int32_t, window_points> beats_{};
  Speeds speed_qs_{};
  std::array<Segment, commit_points> segments_{};
};

}  // namespace lamplock::motion
