// Lead-in and lead-out: the way from the pierce point to a closed contour, and away from it.
//
// In:  contours as they are cut, the shape of the lead. Out: lines and arcs through the waste.
// Who: cut_path().
//
// Where the beam goes through the sheet it burns a larger hole than the cut, so it does that in the
// waste and not on the edge of the part.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"
#include "host/cutting/drawn_contours.hpp"
#include "host/error.hpp"

namespace lamplock::cutting {

/// The side of the cut, seen in its direction, that is thrown away. Of a contour that is
/// compensated to the right it is the right one: outside of a part that is cut counter-clockwise,
/// inside of a hole that is cut clockwise.
enum class WasteSide { right, left };

enum class LeadShape {
  none,
  line,  ///< at an angle to the contour
  arc    ///< of a circle that touches the contour
};
struct Lead {
  LeadShape shape = LeadShape::none;
  double length_mm = 0;  ///< of the line
  double radius_mm = 0;  ///< of the arc
  /// Between the line and the contour, 0 < angle < 180; a quarter turn is square to it. Of an arc,
  /// the angle that it turns, 0 < angle <= 270.
  double angle_deg = 90;
};

/// All contours of a sheet as they are cut: no lead may cross them.
class CutSheet {
 public:
  explicit CutSheet(const std::vector<Contour>& contours);

  /// True if the edge has no point in common with a contour, except points this near to `at`.
  bool is_free(const Edge& edge, const Vec& at, double near_mm) const;
  /// Distance from the nearest contour, if it is less than `reach_mm`; otherwise `reach_mm`.
  double room(const Vec& at, double reach_mm) const;

 private:
  std::vector<Edge> edges_;
  BoxTree tree_;
};

/// A lead that does not fit at its point of the contour.
class LeadError : public Error {
 public:
  /// `place`: lead-in or lead-out. `fitting_mm`: the size that fits there; 0 if none does.
  LeadError(const char* place, const std::string& what, double fitting_mm);
  double fitting_mm() const { return fitting_mm_; }

 private:
  double fitting_mm_;
};

struct LeadOptions {
  Lead shape;
  WasteSide waste = WasteSide::right;
  double clearance_mm = 0;  ///< of the pierce point, or the end of a lead-out, from all contours
  Neighbours neighbours{};  ///< into which the lead may not cut
};

/// The way to the begin of a closed contour; nothing for LeadShape::none. It is in the waste all
/// the way, meets no other contour and cuts into none of its neighbours. Throws Error (bad_input)
/// if it does not fit, with a size that does, for an open contour, and for sizes that are not
/// positive.
std::vector<Edge> lead_in(const Contour& contour, const LeadOptions& options,
                          const CutSheet& sheet);

/// The way from a point on a closed contour, at this distance along it, as lead_in().
std::vector<Edge> lead_out(const Contour& contour, double along_mm, const LeadOptions& options,
                           const CutSheet& sheet);

}  // namespace lamplock::cutting
