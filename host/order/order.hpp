// The order of engraving. In: a cloud in mm. Out: the same points in firing order. Called once per
// job, before the job is made.
//
// The beam comes from above and a defect shadows the points under it ("Mechatronic positioning of a
// pulsed laser beam in devices forming 3-D objects in glass"): every order but `given` keeps the
// shadow rule (shadow.hpp) on every cloud. Within this rule a good order needs few beats of the
// planner; docs/ordering.md compares the orders.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string_view>

#include "host/geometry/point.hpp"
#include "host/order/cone.hpp"
#include "host/order/greedy.hpp"
#include "host/order/motion.hpp"

namespace lamplock::order {

enum class Ordering {
  given,       // order of the input
  layers,      // lowest layer first, a short and even tour in each
  serpentine,  // lowest layer first, to and fro in strips
  nearest,     // lowest layer first, always to the nearest point
  cone,        // to the point cheapest by distance and height (ConeWeights)
  best         // as few beats as can be found for a machine (Motion)
};

/// Names of the orderings for the user, in the order of the enumeration.
inline constexpr std::array<std::string_view, 6> ordering_names{"given",   "layers", "serpentine",
                                                                "nearest", "cone",   "best"};
/// Empty for other names.
std::optional<Ordering> ordering_named(std::string_view name);

struct OrderOptions {
  /// Thickness of a layer of `layers`, `serpentine` and `nearest`; `best` finds its own, `cone` has
  /// none.
  double layer_mm = 0.1;
  /// Position of the machine before the first point.
  geometry::Point start{};
  /// Called in the caller's thread now and then with the fraction done, 0..1; may throw to cancel.
  std::function<void(double)> progress{};
  /// 0: as many as the processor has. The result does not depend on it.
  unsigned threads = 0;
  /// Of the beam's cone, 0 (no shadows) to less than 90 degrees.
  double half_angle_deg = default_half_angle_deg;
  /// Of `cone`; the default is tan(30 deg), the middle of the best range in the document above.
  ConeWeights cone{0.577, 0.577};
  /// Of `best`.
  Motion motion{};
};

/// A permutation of `cloud`, deterministic. Time n log n, memory linear. Throws Error (bad_input)
/// for a thickness or a limit of the machine that is not positive, a half angle outside its range,
/// weights or coordinates that are not finite, or too many points.
geometry::PointCloud order(geometry::PointCloud cloud, Ordering ordering,
                           const OrderOptions& options = {});

}  // namespace lamplock::order
