// The next window of a job: which ways are planned together.
//
// In:  targets in the queue; where handing out goes on, and how the machine comes from there; the
//      beam as it stands.
// Out: points, rests and least beats of a plan request; whether all is known that it may look at;
//      the beam that has to be made ready before it.
// Who: the job runner, main loop. look() takes some 100 us: unmasked, directly before prepare()
//      (masked), which looks itself otherwise and forgets in the end, for more points will be
//      known. What was found is forgotten, too, when handing out goes on elsewhere. Everything else
//      is short. The request belongs to the planner while a plan is handed out (hand_over.hpp).
//
// A target with several flashes stands in the window as often as flashes are still to come, and on
// its own if there are many: the same place again, no sooner than the highest shot rate permits.
//
// Where shutter or attenuator need time between two points, the first one is a rest: a window ends
// there, and the next one waits until all shots are judged and the beam is ready.
//
// Astray: after a brake the machine does not come from the target before. Then the first way takes
// as long as it has to, and a dwell is gone to before it is begun.
#pragma once

#include <cstdint>

#include "firmware/lamp/beam_path.hpp"
#include "firmware/motion/plan_request.hpp"
#include "firmware/motion/point_queue.hpp"

namespace lamplock::machine {

/// What a job is run with.
struct RunOptions {
  motion::JoinMode mode = motion::JoinMode::free;
  bool dry = false;
  std::uint32_t points_total = 0;
  std::int32_t least_beats = 1;                     ///< between shots, from the highest shot rate
  std::uint32_t shortest_tick_q16 = full_tick_q16;  ///< JobRunner::shortest_tick_q16() at the start
  /// Of a program: the beats of a target are the fewest on its way, at the programmed feed.
  bool of_program = false;
  std::uint32_t feed_percent = 100, rapid_percent = 100;  ///< of a program
};

/// Where handing out goes on: a target and how many of its flashes are on their way.
struct Place {
  std::uint32_t point = 0;      ///< first target not handed out whole
  std::uint32_t committed = 0;  ///< flashes of it that are handed out and not judged
};

/// How the machine sets out.
struct Departure {
  bool from_rest = true;
  bool astray = true;   ///< not from the target before
  bool slower = false;  ///< the job is not run at full speed
};

/// Finds one window at a time.
class NextWindow {
 public:
  NextWindow(const motion::PointQueue& queue, const lamp::BeamPath& beam, const RunOptions& options,
             motion::PlanRequest& request)
      : queue_(queue), beam_(beam), options_(options), request_(request) {}

  const Place& place() const { return place_; }
  void go_on_at(const Place& place) {
    place_ = place;
    looked_ = false;
  }
  /// A flash of this target has been fired.
  void flash_fired(std::uint32_t point);

  /// Fills the request with what comes next, unless that has been done.
  void look(const Departure& departure);
  void forget() { looked_ = false; }

  // What was found.
  bool empty() const { return request_.count == 0; }
  /// Not empty, and all of it is known.
  bool ready() const { return ready_; }
  /// The first way only leads to its dwell.
  bool gone_to() const { return gone_to_; }
  /// Beam of the first shot; null if there is none.
  const lamp::Beam* first_beam() const { return has_shot_ ? &first_beam_ : nullptr; }
  /// Where handing out goes on behind the first `count` ways, `handed` of which are counted in
  /// place().
  Place place_after(std::uint32_t handed, std::uint32_t count) const;

 private:
  bool find(const Departure& departure);
  bool rows_known();
  bool needs_another_beam(const motion::Target& target, bool from_rest, lamp::Beam& last);
  bool add_target(std::uint32_t point, std::uint32_t flashes, const Departure& departure);
  std::uint32_t least_beats(const motion::Target& target, bool gone_astray, bool slower) const;
  bool add_way(std::uint32_t point, bool rest, std::uint32_t at_least);

  const motion::PointQueue& queue_;
  const lamp::BeamPath& beam_;
  const RunOptions& options_;
  motion::PlanRequest& request_;
  Place place_;
  lamp::Beam first_beam_;
  bool looked_ = false;  ///< the request is that of the next window
  bool ready_ = false;
  bool has_shot_ = false;
  bool gone_to_ = false;
};

}  // namespace lamplock::machine
