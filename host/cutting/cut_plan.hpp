// The plan of a job: which contour is cut when, from which point, along which lines and arcs.
//
// In:  shapes with their operations, the position of the machine. Out: strokes in order.
// Who: the use case of cutting; the writers of programs and pictures.
//
//   engravings -> scores -> cuts, inner contours before outer ones
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/cutting/cut_order.hpp"
#include "host/cutting/cut_path.hpp"
#include "host/cutting/operation.hpp"

namespace lamplock::cutting {

/// A contour of the drawing.
struct Shape {
  Contour contour;
  ContourPlace place;                    ///< among the shapes of its kind of operation
  std::optional<std::size_t> operation;  ///< number of it; none: left out
};

/// Moves from where the beam is switched on to where it is switched off; each begins where the one
/// before ends. Moves with a power of 0 are dark.
using Stroke = std::vector<CutMove>;

/// The drawn contour, beside which the controller leads the beam.
struct ControllerPath {
  Stroke drawn;  ///< begins in the middle of an edge
  bool is_left = false;
};

/// What is cut without another contour between: a contour, or the lines of an engraving.
struct PlannedCut {
  std::size_t operation = 0;
  std::size_t shape = 0;  ///< of an engraving the first one
  std::vector<Stroke> strokes;
  std::optional<ControllerPath> controller{};  ///< with Compensation::controller
  std::size_t number =
      1;  ///< from 1 in the order of the whole plan, also where the first are left out
};

struct CutPlan {
  std::vector<PlannedCut> cuts;  ///< in order
  /// Places that the beam does not fit, crossings; numbers of shapes.
  std::vector<Fault> faults;
  double rapid_mm = 0;  ///< between strokes, in one pass of each
};

/// The places of shapes in the tree of those whose operations are of the same kind; of engravings
/// in that of the same operation.
void place_shapes(std::vector<Shape>& shapes, const std::vector<Operation>& operations);

/// The contour in the direction in which it is cut.
Contour directed(const Shape& shape, Direction direction);

/// Throws Error (bad_input), with the place in the drawing: an open contour that has no inside, a
/// contour that is smaller than the beam, a place where the beam does not fit and the controller
/// compensates, leads and tabs that do not fit, and as cut_path() and hatch().
CutPlan plan_cuts(const std::vector<Shape>& shapes, const std::vector<Operation>& operations,
                  const Vec& position, const OrderOptions& order = {});

}  // namespace lamplock::cutting
