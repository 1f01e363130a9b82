#include "host/cutting/beams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/cutting/cut_order.hpp"
#include "host/cutting/offset.hpp"
#include "host/error.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::cutting {
namespace {

/// mm to the right of the direction.
double distance_of(const Shape& shape, const Contour& contour, const Operation& operation) {
  const double half = operation.kerf_mm / 2;
  const bool is_ccw = is_counter_clockwise(contour);
  switch (operation.compensation) {
    case Compensation::none:
      return 0;
    case Compensation::left:
      return -half;
    case Compensation::right:
      return half;
    case Compensation::automatic:
    case Compensation::controller:
      if (!contour.closed) return 0;
      return is_part(shape.place) == is_ccw ? half : -half;
    case Compensation::inside:
    case Compensation::outside:
      break;
  }
  const bool is_outside = operation.compensation == Compensation::outside;
  if (!contour.closed)
    throw Error(Exit::bad_input, operation.name,
                fmt::format("the open {} has no {}", contour_text(contour),
                            is_outside ? "outside" : "inside"),
                "close it in the drawing, or use compensation left, right, auto or none");
  return is_outside == is_ccw ? half : -half;
}

/// The side that is thrown away: that of the beam, without compensation by the tree.
WasteSide waste_of(const Shape& shape, const Contour& contour, double distance_mm) {
  const bool is_right =
      distance_mm != 0 ? distance_mm > 0 : is_part(shape.place) == is_counter_clockwise(contour);
  return is_right ? WasteSide::right : WasteSide::left;
}

/// True if the operation fixes the direction of the cut: by its direction, or by a beam to the left
/// or right of it.
bool has_direction(const Operation& operation) {
  return operation.direction == Direction::drawn || operation.direction == Direction::reversed ||
         operation.compensation == Compensation::left ||
         operation.compensation == Compensation::right;
}

/// The beam along one shape.
struct ShapeBeam {
  OffsetContours offset;
  WasteSide waste = WasteSide::right;
  std::optional<Contour> drawn;  ///< where the controller compensates
  bool is_moved = false;         ///< runs beside the drawn contour
};

/// The drawn contour from the middle of an edge, and the beam from beside it: at a corner the
/// controller would neither close the contour nor keep its distance.
Contour begin_alike(const Contour& contour, double distance_mm, const Operation& operation,
                    OffsetContours& result) {
  const bool is_narrow =
      std::any_of(result.faults.begin(), result.faults.end(), [](const Fault& fault) {
        return fault.kind == FaultKind::narrow || fault.kind == FaultKind::vanished;
      });
  constexpr double near_mm = 1e-6;
  if (!is_narrow && result.contours.size() == 1) {
    Contour& beam = result.contours.front();
    for (std::size_t i = 0; i < contour.edges.size(); ++i) {
      const Edge& edge = contour.edges[i];
      const Vec at = point_at(edge, 0.5) + right_of(direction_at(edge, 0.5)) * distance_mm;
      for (std::size_t k = 0; k < beam.edges.size(); ++k) {
        if (distance_to(beam.edges[k], at) > near_mm) continue;
        beam = as_cut(beam, {0, false, k, std::clamp(part_at(beam.edges[k], at), 0.0, 1.0)});
        return as_cut(contour, {0, false, i, 0.5});
      }
    }
  }
  throw Error(Exit::bad_input, operation.name,
              fmt::format("the beam of {:g} mm does not fit everywhere beside the {}, where the "
                          "controller would stop",
                          operation.kerf_mm, contour_text(contour)),
              "use compensation auto");
}

/// True if nothing of a part that is cut outside is larger than what the beam removes around it.
bool fits_in_beam(const Contour& contour, const Operation& operation) {
  if (!contour.closed || operation.compensation == Compensation::none) return false;
  const Box box = box_of(contour);
  return std::max(box.high.x - box.low.x, box.high.y - box.low.y) < operation.kerf_mm;
}

/// The beam along one shape.
ShapeBeam beam_along(const Shape& shape, const Operation& operation) {
  const Contour contour = directed(shape, operation.direction);
  const double distance_mm = distance_of(shape, contour, operation);
  ShapeBeam beam{offset({contour}, {distance_mm}),
                 waste_of(shape, contour, distance_mm),
                 {},
                 distance_mm != 0};
  if (beam.offset.contours.empty() || fits_in_beam(contour, operation))
    throw Error(Exit::bad_input, operation.name,
                fmt::format("the {} is smaller than the beam of {:g} mm", contour_text(contour),
                            operation.kerf_mm),
                "use a smaller kerf, or no compensation for it");
  if (operation.compensation == Compensation::controller && beam.is_moved)
    beam.drawn = begin_alike(contour, distance_mm, operation, beam.offset);
  return beam;
}

void append_beam(ShapeBeam& beam, std::size_t shape, bool is_directed, Beams& beams) {
  for (Contour& contour : beam.offset.contours) {
    beams.contours.push_back(std::move(contour));
    beams.shapes.push_back(shape);
    beams.waste.push_back(beam.waste);
    beams.drawn.push_back(beam.drawn);
    beams.is_moved.push_back(beam.is_moved);
    beams.is_directed.push_back(is_directed);
  }
}

/// One of the beams along a shape, that around all others of it if there is one; none for a shape
/// that is not cut.
std::vector<std::optional<std::size_t>> outermost_beams(const Beams& beams,
                                                        const std::vector<ContourPlace>& tree,
                                                        std::size_t shape_count) {
  std::vector<std::optional<std::size_t>> outermost(shape_count);
  for (std::size_t i = 0; i < beams.shapes.size(); ++i) {
    auto& found = outermost[beams.shapes[i]];
    if (!found || tree[i].depth < tree[*found].depth) found = i;
  }
  return outermost;
}

}  // namespace

std::vector<ContourPlace> places_of(const Beams& beams, const std::vector<Shape>& shapes) {
  std::vector<ContourPlace> places = contour_tree(beams.contours);
  const auto outermost = outermost_beams(beams, places, shapes.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    auto& parent = places[i].parent;
    if (parent && beams.shapes[*parent] == beams.shapes[i]) continue;
    parent.reset();
    // The beam along a shape may cross that of the shape around it: the drawing decides.
    for (auto around = shapes[beams.shapes[i]].place.parent; around && !parent;
         around = shapes[*around].place.parent)
      parent = outermost[*around];
  }
  return places;
}

Beams beams_along(const std::vector<Shape>& shapes, const std::vector<Operation>& operations,
                  OperationKind kind, std::vector<Fault>& faults) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto operation = shapes[i].operation;
    if (operation && operations[*operation].kind == kind) numbers.push_back(i);
  }
  std::vector<ShapeBeam> beams(numbers.size());
  geometry::for_each_index(beams.size(), 0, [&](std::size_t i) {
    const Shape& shape = shapes[numbers[i]];
    beams[i] = beam_along(shape, operations[*shape.operation]);
  });
  Beams all;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    for (Fault& fault : beams[i].offset.faults) {
      // The others are those of the drawing.
      if (fault.kind != FaultKind::narrow && fault.kind != FaultKind::vanished) continue;
      fault.contour = numbers[i];
      faults.push_back(fault);
    }
    append_beam(beams[i], numbers[i], has_direction(operations[*shapes[numbers[i]].operation]),
                all);
  }
  return all;
}

}  // namespace lamplock::cutting
