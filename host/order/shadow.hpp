// The shadow rule: a defect shadows the points under it, so no point may be fired after one under
// whose cone it lies. In: a cloud in firing order. Out: the first pair that breaks the rule, or an
// order that keeps it. Called by every ordering and by checks of an order.
//
// The beam comes from +z and is focused under a half angle ("Mechatronic positioning of a pulsed
// laser beam in devices forming 3-D objects in glass": points of the cone under a point come before
// it). Points of equal height never shadow each other. A cone under a point of a cone lies within
// the first one, so "comes before" has no cycles.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/order/cone.hpp"
#include "host/order/remaining_points.hpp"

namespace lamplock::order {

/// Two places in an order: the point at `first` shadows the later point at `second`.
struct Shadowed {
  std::size_t first = 0, second = 0;
  friend bool operator==(const Shadowed&, const Shadowed&) = default;
};

/// The lowest `first` that shadows a later point, with one of those it shadows; empty if the order
/// keeps the rule. Time n log n for usual clouds. Throws Error (bad_input) as cone_tangent() and
/// require_coordinates().
std::optional<Shadowed> first_shadowed(std::span<const geometry::Point> order,
                                       double half_angle_deg);

/// The same by the tangent of the half angle.
std::optional<Shadowed> find_shadowed(std::span<const geometry::Point> order, double tangent);

/// Fires a point of `rest`: first the points it would shadow, lowest first where cones are nested,
/// then itself. Appends to `fired`.
void fire(RestTree& rest, std::span<const geometry::Point> points, std::uint32_t point,
          double tangent, std::vector<std::uint32_t>& fired);

/// Makes an order keep the rule: each point that would come too late is moved to just before the
/// first one that shadows it. An order that keeps the rule is not changed.
void pull_ahead(std::span<geometry::Point> order, double tangent);

}  // namespace lamplock::order
