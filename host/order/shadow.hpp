// The shadow rule: a defect keeps the beam from what lies under it, so no point may be fired after
// one under whose cone it lies. Comes in: a cloud in the order of firing. Goes out: the first pair
// that breaks the rule, or an order that keeps it. Called by every ordering and by whoever proves
// an order.
//
// The beam comes from +z and is focused under a half angle ("Mechatronic positioning of a pulsed
// laser beam in devices forming 3-D objects in glass": points of the cone under a point come before
// it). Points of equal height never shadow each other. A cone under a point of a cone lies within
// the first one, so "comes before" has no circles.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/order/cone.hpp"
#include "host/order/rest_tree.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// Two places in an order: what was fired at `first` shadows what comes later at `second`.
struct Shadowed {
  std::size_t first = 0, second = 0;
  friend bool operator==(const Shadowed&, const Shadowed&) = default;
};

/// The lowest `first` that shadows a later point, with one of those it shadows; nothing if the
/// order keeps the rule. Time n log n for usual clouds. Throws Error (bad_input) for a half
/// angle as cone_tangent() does and for coordinates as require_coordinates() does.
std::optional<Shadowed> first_shadowed(std::span<const points::Point> order, double half_angle_deg);

/// The same by the tangent of the half angle.
std::optional<Shadowed> find_shadowed(std::span<const points::Point> order, double tangent);

/// Fires a point of `rest`: first what it would shadow, lowest first where cones are nested, then
/// itself. Appends to `fired`.
void fire(RestTree& rest, std::span<const points::Point> points, std::uint32_t point,
          double tangent, std::vector<std::uint32_t>& fired);

/// Makes an order keep the rule: each point that would come too late is pulled ahead to just before
/// the first one that shadows it. An order that keeps the rule stays as it is.
void pull_ahead(std::span<points::Point> order, double tangent);

}  // namespace lamplock::order
