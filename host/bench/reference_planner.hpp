// The exact optimum of free planning in double precision, the reference for the fixed-point
// planner.
//
// In:  a sequence of displacements, rest to rest. Out: the fewest beats that any plan needs.
// Who: `lamplock bench` (column "optimum") and the tests.
//
// A label is (beats so far, box of speed intervals). Axes are coupled only by the common beats, so
// propagating intervals is exact. Labels are dropped only by proof:
//
// * dominated: another label has no more beats and contains the box, or contains it after a loop.
//   From (beats b, box B) a machine may leave the point and be back s beats later; B looped for s
//   beats is reach(B, way 0, s beats), and every continuation from there is also one from B. So
//   labels end when the first one that contains rest, looped, contains every speed.
// * too late: short sequences are searched for a total of U beats, U rising from a lower bound
//   until there is a plan. Backwards from the end, the hull per axis over every way to spend n
//   beats contains all speeds from which n beats can be enough; labels are cut to it.
//
// The search is exact, without beam or heuristics; it ignores the work space. Memory: the labels of
// two neighbouring points.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "shared/units.hpp"

namespace lamplock::bench {

/// Interval of speeds of one axis. Units: acceleration limit 1, time in beats.
struct SpeedRange {
  double lo = 0, hi = 0;
};
using SpeedBox = std::array<SpeedRange, max_axes>;

/// Speeds at the end of a displacement `way` in `beats`, |v| <= limit; false if there are none.
/// Used backwards it gives the speeds at the start for those at the end: time can be reversed.
bool reach(const SpeedRange& from, double way, double beats, double limit, SpeedRange& to);

/// A sequence to plan, rest to rest: displacements in units of A beat^2, limits in units of A beat.
struct ReferenceProblem {
  std::size_t axes = 1;
  std::vector<std::array<double, max_axes>> way;
  std::array<double, max_axes> limit{};
};

/// Result and cost of the search.
struct ReferenceResult {
  long beats = 0;              ///< the optimum
  std::size_t labels = 0;      ///< labels kept, all points together
  std::size_t max_labels = 0;  ///< at one point
  std::size_t segments_tried = 0;
};

/// Called now and then with the number of points done.
using PointsDone = std::function<void(std::size_t)>;

/// Fewest beats in total. Any length: short sequences at any lamp, streams where a step takes few
/// beats (time grows with the square of the beats that reach full speed).
ReferenceResult fewest_beats(const ReferenceProblem& problem, const PointsDone& done = {});

/// The two searches from which it chooses; they agree if both end.
ReferenceResult fewest_beats_of_sequence(const ReferenceProblem& problem);
ReferenceResult fewest_beats_of_stream(const ReferenceProblem& problem,
                                       const PointsDone& done = {});

/// Beats of one displacement from rest to rest.
int rest_to_rest(const ReferenceProblem& problem, std::size_t i);
/// The same for all displacements: the beats of start-stop.
long start_stop_beats(const ReferenceProblem& problem);

}  // namespace lamplock::bench
