// The next window of a job: the moves that are planned together.
//
// In:  targets in the queue; the next target to hand out, and how the machine reaches it; the state
//      of the beam.
// Out: points, rests and minimum beats of a plan request; whether all targets in reach are known;
//      the beam that must be ready first.
// Who: the job runner, main loop. fill_request() takes some 100 us: unmasked, directly before
//      prepare() (masked), which otherwise calls it. prepare() drops the result at its end, since
//      more points will be known; so does a change of the next target. The rest is short. The
//      request belongs to the planner while a plan is handed out (work_exchange.hpp).
//
// A target with several flashes appears in the window once per flash still to come, and alone if
// there are many: the same position again, at most at the maximum shot rate.
//
// Where shutter or attenuator need time between two points, the first one is a rest: a window ends
// there, and the next one waits until all shots are judged and the beam is ready.
//
// Off target: after a brake the machine does not start at the previous target. Then the first move
// takes as long as it needs, and a dwell begins after the machine has reached its position.
#pragma once

#include <cstdint>

#include "firmware/lamp/beam_path.hpp"
#include "firmware/motion/plan_request.hpp"
#include "firmware/motion/point_queue.hpp"

namespace lamplock::machine {

/// Options of a run.
struct RunOptions {
  wire::JoinMode mode = wire::JoinMode::free;
  bool dry = false;
  std::uint32_t points_total = 0;
  std::int32_t min_beats = 1;                  ///< between shots, from the maximum shot rate
  std::uint32_t min_tick_q16 = full_tick_q16;  ///< JobRunner::lasting_min_tick_q16() at the start
  /// Of a program: the beats of a target are the minimum for its move, at the programmed feed rate.
  bool of_program = false;
  std::uint32_t feed_percent = 100, rapid_percent = 100;  ///< of a program
};

/// Position in the queue: a target and how many of its flashes are handed out.
struct Place {
  std::uint32_t point = 0;      ///< first target that is not completely handed out
  std::uint32_t committed = 0;  ///< flashes of it that are handed out and not judged
};

/// State of the machine at the start of a window.
struct Departure {
  bool from_rest = true;
  bool off_target = true;  ///< not at the previous target
  bool slower = false;     ///< the job is not run at full speed
};

/// Finds one window at a time.
class NextWindow {
 public:
  NextWindow(const motion::PointQueue& queue, const lamp::BeamPath& beam, const RunOptions& options,
             motion::PlanRequest& request)
      : queue_(queue), beam_(beam), options_(options), request_(request) {}

  const Place& place() const { return place_; }
  void continue_at(const Place& place) {
    place_ = place;
    filled_ = false;
  }
  /// A flash of this target was fired.
  void flash_fired(std::uint32_t point);

  /// Fills the request with the next window, unless that has been done.
  void fill_request(const Departure& departure);
  void forget() { filled_ = false; }

  // Results of fill_request().
  bool empty() const { return request_.count == 0; }
  /// Not empty, and all targets in it are known.
  bool ready() const { return ready_; }
  /// The first move only leads to the position of its dwell.
  bool gone_to() const { return gone_to_; }
  /// Beam of the first shot; null if there is none.
  const lamp::Beam* first_beam() const { return has_shot_ ? &first_beam_ : nullptr; }
  /// The place after the first `count` moves, `handed` of which are already counted in place().
  Place place_after(std::uint32_t handed, std::uint32_t count) const;

 private:
  bool find(const Departure& departure);
  bool rows_known();
  bool needs_another_beam(const wire::Target& target, bool from_rest, lamp::Beam& last);
  bool add_target(std::uint32_t point, std::uint32_t flashes, const Departure& departure);
  std::uint32_t min_beats(const wire::Target& target, bool off_target, bool slower) const;
  bool add_way(std::uint32_t point, bool rest, std::uint32_t at_least);

  const motion::PointQueue& queue_;
  const lamp::BeamPath& beam_;
  const RunOptions& options_;
  motion::PlanRequest& request_;
  Place place_;
  lamp::Beam first_beam_;
  bool filled_ = false;  ///< the request is that of the next window
  bool ready_ = false;
  bool has_shot_ = false;
  bool gone_to_ = false;
};

}  // namespace lamplock::machine
