// The order of engraving. Comes in: a cloud in mm. Goes out: the same points in the order in which
// they are to be fired. Called once per job, before the job is made.
//
// The beam comes from above and a defect shadows what lies under it ("Mechatronic positioning of a
// pulsed laser beam in devices forming 3-D objects in glass"): every order but `given` keeps the
// shadow rule (shadow.hpp) on every cloud. Within that an order is judged by the beats that the
// planner will spend on it; docs/ordering.md compares them.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string_view>

#include "host/order/cone.hpp"
#include "host/order/greedy.hpp"
#include "host/order/motion.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

enum class Ordering {
  given,       // as it came
  layers,      // lowest layer first, a short and even tour in each
  serpentine,  // lowest layer first, to and fro in strips
  nearest,     // lowest layer first, always to the nearest point
  cone,        // to the point cheapest by way and height (ConeWeights)
  best         // as few beats as can be found for a machine (Motion)
};

/// Names of the orderings, as people write them, in the order of the enumeration.
inline constexpr std::array<std::string_view, 6> ordering_names{"given",   "layers", "serpentine",
                                                                "nearest", "cone",   "best"};
/// Nothing for what is no name of an ordering.
std::optional<Ordering> ordering_named(std::string_view name);

struct OrderOptions {
  /// Thickness of a layer of `layers`, `serpentine` and `nearest`; `best` finds its own, `cone` has
  /// none.
  double layer_mm = 0.1;
  /// Where the machine stands before the first point.
  points::Point start{};
  /// Called in the caller's thread now and then with the part done, 0..1; may throw to give up.
  std::function<void(double)> progress{};
  /// 0: as many as the processor has. The result does not depend on it.
  unsigned threads = 0;
  /// Of the beam's cone, 0 (nothing is shadowed) to less than 90 degrees.
  double half_angle_deg = default_half_angle_deg;
  /// Of `cone`; the default is tan(30 deg), in the middle of what the document above found best.
  ConeWeights cone{0.577, 0.577};
  /// Of `best`.
  Motion motion{};
};

/// A permutation of `cloud`, deterministic. Time n log n, memory linear. Throws Error (bad_input)
/// for a thickness or a limit of the machine that is not positive, a half angle outside its range,
/// weights or coordinates that are not finite, or too many points.
points::PointCloud order(points::PointCloud cloud, Ordering ordering,
                         const OrderOptions& options = {});

}  // namespace lamplock::order
