// The beams along the contours of a sheet: compensated by half their width.
//
// In:  shapes with their operations. Out: contours as the beam runs along them, and where it does
//      not fit or cuts into another contour.
// Who: the plan of a job.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/cutting/cut_plan.hpp"
#include "host/cutting/drawn_contours.hpp"
#include "host/cutting/leads.hpp"

namespace lamplock::cutting {

/// Contours as the beam runs along them.
struct Beams {
  std::vector<Contour> contours;
  std::vector<std::size_t> shapes;  ///< of each
  std::vector<WasteSide> waste;
  std::vector<std::optional<Contour>> drawn;  ///< where the controller compensates
  std::vector<bool> is_moved;                 ///< runs beside the drawn contour
  std::vector<bool> is_directed;              ///< has the direction of its operation

  bool are_moved() const {
    return std::find(is_moved.begin(), is_moved.end(), true) != is_moved.end();
  }
};

/// The beams along all shapes of operations of one kind; places where one does not fit are added to
/// the faults. Throws Error as plan_cuts().
Beams beams_along(const std::vector<Shape>& shapes, const std::vector<Operation>& operations,
                  OperationKind kind, std::vector<Fault>& faults);

/// Which beam has to be cut after each: that along the shape around it in the drawing. A shape that
/// crosses itself may have beams inside of one another.
std::vector<ContourPlace> places_of(const Beams& beams, const std::vector<Shape>& shapes);

/// Beams that cross, and those that cut into one of the drawn contours; numbers of shapes.
std::vector<Fault> beam_faults(const Beams& beams, const DrawnContours& drawn,
                               const std::vector<Shape>& shapes,
                               const std::vector<Operation>& operations);

}  // namespace lamplock::cutting
