#include "firmware/program/extent.hpp"

#include <algorithm>

namespace lamplock::program {
namespace {

/// The box round the corners of a box after a rotation.
Extent turned_box(const Extent& box, const Rotations& rotations) {
  Extent turned(rotations.turned(box.low()));
  constexpr unsigned corners = 1u << max_axes;
  for (unsigned corner = 0; corner < corners; ++corner) {
    Place place = box.low();
    for (std::size_t i = 0; i < place.size(); ++i)
      if ((corner >> i & 1u) != 0) place[i] = box.high()[i];
    turned.add(rotations.turned(place));
  }
  return turned;
}

}  // namespace

void Extent::add(const Place& place) {
  for (std::size_t i = 0; i < place.size(); ++i) {
    low_[i] = std::min(low_[i], place[i]);
    high_[i] = std::max(high_[i], place[i]);
  }
}

Extent extent_of(const ArcRequest& arc, const Rotations& rotations) {
  ArcRequest turned = arc;
  const bool in_plane =
      rotations.active() && rotations.turn_only(arc.plane.first, arc.plane.second);
  if (in_plane) {
    turned.start = rotations.turned(arc.start);
    turned.end = rotations.turned(arc.end);
    turned.centre = rotations.turned(arc.centre);
  }
  const ArcRange range = arc_range(turned);
  // The other axes are between their ends.
  Extent extent(turned.start);
  extent.add(turned.end);
  Extent box = extent;
  for (const std::int64_t first : {range.first.low_e7, range.first.high_e7})
    for (const std::int64_t second : {range.second.low_e7, range.second.high_e7})
      for (Place corner : {extent.low(), extent.high()}) {
        corner[arc.plane.first] = first;
        corner[arc.plane.second] = second;
        box.add(corner);
      }
  if (in_plane || !rotations.active()) return box;
  return turned_box(box, rotations);
}

Extent extent_of(const SplineRequest& spline, const Rotations& rotations) {
  // The other axes move evenly, which is a spline as well; here they do not move.
  SplineRequest turned = spline;
  for (Place* const control : {&turned.first_control, &turned.second_control}) {
    (*control)[spline.plane.normal] = spline.start[spline.plane.normal];
    *control = rotations.turned(*control);
  }
  turned.start = rotations.turned(spline.start);
  turned.end = rotations.turned(spline.end);
  Extent extent(turned.start);
  extent.add(turned.end);
  Place low = extent.low(), high = extent.high();
  for (const std::uint8_t axis : {spline.plane.first, spline.plane.second, spline.plane.normal}) {
    const Range range = spline_range(turned, axis);
    low[axis] = range.low_e7;
    high[axis] = range.high_e7;
  }
  extent.add(low);
  extent.add(high);
  return extent;
}

Extent extent_of(const NurbsRequest& nurbs, const Rotations& rotations) {
  Extent extent(rotations.turned(nurbs.start));
  for (std::uint32_t i = 1; i < nurbs.control->count; ++i) {
    Place place = nurbs.start;
    place[nurbs.plane.first] = nurbs.control->points[i].place.first_e7;
    place[nurbs.plane.second] = nurbs.control->points[i].place.second_e7;
    extent.add(rotations.turned(place));
  }
  return extent;
}

Extent extent_of(const CycleRequest& cycle, const Rotations& rotations) {
  const std::uint8_t normal = cycle.normal;
  Place last = cycle.first;
  for (std::size_t i = 0; i < last.size(); ++i)
    last[i] += cycle.step[i] * std::int64_t{cycle.holes - 1};
  const std::int64_t start = cycle.start[normal];
  const std::int64_t top = std::max({start, cycle.retract_e7, cycle.end_e7});
  Extent extent(rotations.turned(cycle.start));
  const auto add = [&](Place place, std::int64_t level) {
    place[normal] = level;
    extent.add(rotations.turned(place));
  };
  add(cycle.start, std::max(start, cycle.retract_e7));
  for (const Place& hole : {cycle.first, last})
    for (const std::int64_t level : {top, cycle.depth_e7}) add(hole, level);
  return extent;
}

}  // namespace lamplock::program
