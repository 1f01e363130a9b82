// The path of the beam along one contour: lead-in, cut with tabs, overcut, lead-out.
//
// In:  a contour as it is cut (compensated, begun at its start point), leads, tabs. Out: lines and
//      arcs with their kind and power.
// Who: the programs for machines, and pictures of them.
#pragma once

#include <vector>

#include "host/cutting/leads.hpp"
#include "host/cutting/tabs.hpp"

namespace lamplock::cutting {

enum class CutKind { lead_in, cut, tab, overcut, lead_out };

struct CutMove {
  Edge edge;  ///< begins where the one before ends
  CutKind kind = CutKind::cut;
  double power = 1;  ///< in parts of the power of the cut
};

struct CutPathOptions {
  Lead lead_in, lead_out;
  WasteSide waste = WasteSide::right;
  double clearance_mm = 0;  ///< of the pierce point and the end of the lead-out from contours
  Neighbours neighbours{};  ///< as LeadOptions
  /// A closed contour is cut beyond its begin by this, so that nothing remains between begin and
  /// end. Without effect on open ones.
  double overcut_mm = 0;
  TabOptions tabs;
  double dark_begin_mm = 0, dark_end_mm = 0;  ///< without light: the laser on late, off early
};

/// Leads of open contours are an error, as lead_in(). Throws Error (bad_input) as lead_in() and
/// tabs_of(), for an overcut that is negative or longer than the contour, and for dark ends as long
/// as the path.
std::vector<CutMove> cut_path(const Contour& contour, const CutPathOptions& options,
                              const CutSheet& sheet);

/// Z of the passes of a tool, mm: every pass goes `infeed_mm` deeper, the last one to
/// `final_depth_mm` below the surface, which is 0. Throws Error (bad_input) for numbers that are
/// not positive and for more than a million passes.
std::vector<double> tool_passes(double final_depth_mm, double infeed_mm);

/// Z of the focus in the passes of a laser, mm: the first one on the surface, which is 0, each
/// other one at the bottom of the groove that the passes before it cut by the depth model. Throws
/// Error (bad_input) as passes_through().
std::vector<double> focus_passes(double thickness_mm, double depth_of_pass_mm);

}  // namespace lamplock::cutting
