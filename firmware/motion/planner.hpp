// The planner: how many beats to each point, and at which speed through it.
//
// In:  a window of targets (up to `window_points`) and the state the machine starts from.
// Out: segments of whole beats that end exactly on the targets, for the first `commit_points` of
//      them.
// Called by the plan of a window (window_plan.hpp; main loop, or the core that plans), slice by
// slice; nothing here runs in an interrupt.
//
//   targets -> window (way.hpp) -> beats (beam.hpp, improve.hpp) -> speeds (quiet.hpp)
//           -> profiles (profile.hpp), checked against the limits and the work space
//
// start-stop mode is the same search with every speed zero; path mode has a planner of its own
// (path_planner.hpp), whose segments are handed out here.
//
// Limits hold by construction: profiles are made for planning limits that leave room for rounding
// and are then checked against the true ones, work space included. Where the quiet profile of an
// axis would leave the work space between two points, the steady one does not: at full acceleration
// to a steady speed and from there, it leaves the way between the points only as far as braking
// needs.
//
// Where jerk is limited phases are pulses (pulse.hpp). The search knows constant acceleration only;
// it works with what pulses of about half a beat are worth (limits.hpp). A way on which the pulses
// of an axis do not fit, or that rounding has spoilt, gets more beats and the window is planned
// again, with rests at last.
//
// Why a stop is always possible: at every point every axis is allowed no more speed than full
// braking takes away before the work space ends, and between the points braking at full
// acceleration stops it no further out than the plan goes.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/beam.hpp"
#include "firmware/motion/improve.hpp"
#include "firmware/motion/limits.hpp"
#include "firmware/motion/path_planner.hpp"
#include "firmware/motion/plan_request.hpp"
#include "firmware/motion/quiet.hpp"
#include "firmware/motion/way.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// Windows of no more points are searched twice, where ways of the plan are detours. There is
/// time for that: such a window is the last of a job, or of what is known, so either the machine
/// stands or runs the `commit_points` points committed before.
inline constexpr std::uint32_t short_window = commit_points / 2;

/// Plans windows. Holds only scratch memory; a plan depends on the request alone.
class Planner {
 public:
  /// Begins a window; the request must stay as it is until the plan has been used.
  void begin(const PlanRequest& request);
  /// Goes on with it; false when there is nothing left to do. Budget: 3 ms, mostly
  /// less than one; the set-up of a window (begin(), the first slice of a path) 8 ms.
  bool advance();
  /// What came of it. Error: unreachable, with the place in the window in failed(); then nothing
  /// may be used.
  Result result() const { return result_; }
  std::uint32_t failed() const { return failed_; }

  /// All of it at once.
  Result plan(const PlanRequest& request, std::uint32_t& failed);

  /// The way to points[i], i < request.commits().
  const Segment& segment(std::uint32_t i) const { return segments_[i]; }
  std::int32_t beats(std::uint32_t i) const { return beats_[i]; }

 private:
  enum class Phase : std::uint8_t { search, improve, speeds, segments, path, over };
  /// What became of detours: a short window is searched without them, if there are any.
  enum class Detours : std::uint8_t { unknown, forbidden, accepted };

  void begin_search(bool run_ups);
  [[gnu::noinline]] bool set_up();
  void give_up(std::uint32_t place);
  void go_on_steadily(std::int32_t beats);
  bool set_up_way(std::uint32_t i);
  SpeedRange allowed_speeds(const AxisLimits& axis, std::int32_t steps) const;
  bool set_beats(Way& way, std::uint32_t i) const;
  static std::uint32_t about_beats(const Way& way);
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
  const Target& target(std::uint32_t i) const { return request_->queue->at(request_->points[i]); }

  const PlanRequest* request_ = nullptr;
  const Limits* limits_ = nullptr;
  Phase phase_ = Phase::over;
  Result result_ = Result::unreachable;
  std::uint32_t failed_ = 0;
  bool run_ups_ = false;       ///< some speeds are allowed for run-ups only
  std::uint32_t at_ = 0;       ///< point or axis to go on with
  std::uint32_t misfits_ = 0;  ///< bit i: no profile of the way to points[i] keeps its limits
  std::int32_t longer_ = 0;    ///< how often such ways were made longer
  Detours detours_ = Detours::unknown;
  std::int32_t first_total_ = 0;  ///< beats of the plan with detours
  /// What the search that made it found, before it was improved.
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
