// Paths of tools other than a laser: a mill that enters along a ramp, a drag knife whose blade
// follows its swivel axis, a turning tool.
//
// In:  a stroke of the plan, the heights of a pass. Out: moves with Z.
// Who: the writer of programs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/cutting/cut_plan.hpp"

namespace lamplock::cutting {

enum class MachineType : std::uint8_t { laser, mill, knife, lathe };
inline constexpr std::array<const char*, 4> machine_type_names{"laser", "mill", "knife", "lathe"};

/// What a tool needs beside the plan.
struct Tooling {
  double surface_mm = 0;    ///< Z of the surface of the sheet
  double clearance_mm = 5;  ///< of rapids from the surface; of a lathe from its contours, radially
  double ramp_deg = 10;     ///< of a mill: slope of its way into the sheet, 0 < angle < 90
  double knife_offset_mm = 0;  ///< from the swivel axis of a drag knife to the tip of its blade
  double away_mm = 0;          ///< of a lathe: added to all radii, to run beside the workpiece
};

/// The heights of one pass, mm.
struct PassHeights {
  double from_mm = 0;   ///< where the pass before it, or the surface, is
  double to_mm = 0;     ///< of this pass
  double final_mm = 0;  ///< of the last pass
};

struct ToolMove {
  Edge edge;  ///< begins where the one before ends
  double z_from_mm = 0, z_to_mm = 0;
};

/// The mill descends back and forth along the begin of the stroke, at most up to its first tab, and
/// then cuts in the height of the pass. In a tab it cuts no deeper than the share of the final
/// depth that is the power of the move; after a tab it descends again along what follows, up to the
/// next tab. Arcs are at most half circles.
std::vector<ToolMove> mill_path(const Stroke& stroke, const PassHeights& pass,
                                const Tooling& tooling);

/// The path of the swivel axis. The blade trails behind the axis by the offset: the axis runs
/// beyond a corner by it and turns about the corner before it continues; on an arc of radius r it
/// is on one of sqrt(r^2 + offset^2). First the blade turns on the surface from `heading`, its unit
/// direction, which becomes that of the end of the stroke.
std::vector<ToolMove> knife_path(const Stroke& stroke, const PassHeights& pass,
                                 const Tooling& tooling, Vec& heading);

/// The stroke is a contour whose x is along the axis of rotation and whose y is the radius. Passes
/// before the last one are farther from the axis by what remains of the depth. Throws
/// Error(bad_input) for a contour beyond the axis or along it, a closed one, and one that goes back
/// in x.
std::vector<ToolMove> lathe_path(const Stroke& stroke, const PassHeights& pass,
                                 const Tooling& tooling);

}  // namespace lamplock::cutting
